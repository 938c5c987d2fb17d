"""What the matrices of a grasp deliver: voltages over time and the forces read from them, as quantities of a result."""

from __future__ import annotations

import numpy as np

from tactsim.interfaces import SensorFilm
from tactsim.interfaces.both_jaws import READ_FORCE, SATURATED, VOLTAGE
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.results.quantity import Quantity
from tactsim.sensors.matrix_readout import MatrixReading, MatrixReadout
from tactsim.sensors.response_errors import root_mean_square
from tactsim.units import format_quantity

AT_END = "at the end; [row][column], row 1 nearest the front (smallest y), column 1 the smallest x"
OVER_TIME = "at each of readout_time, [time][row][column]"
ENOUGH_STEPS = 5
"""Steps of time with which the forces read are nearly those of many steps. A grasp of ICF closed by 1 mm, composite film: with
one step they are 3.7 % above those of twenty, with two 1.1 %, with five 0.3 %, as forces rise ever faster."""
MISSED = 0.01
"""Part of the largest force by which a force may change after the last sample."""
REMEMBERED = 0.01
"""A film counts as remembering its history if its signal under a force that rises in the second half only differs by more than
this part from that under one that rises evenly."""


def readout_quantities(reading: MatrixReading) -> dict[str, Quantity]:
    """Readings with the channels (jaw, row, column), upper jaw first."""
    quantities = {"readout_time": Quantity(reading.time.tolist(), "s", "times of the samples of all taxels [time]")}
    for k, side in enumerate(JAWS):
        of = f"of each taxel of the {side} jaw"
        voltage, force = reading.filtered[:, k], reading.force[:, k]
        quantities |= {
            f"{VOLTAGE}_{side}": Quantity(voltage[-1].tolist(), "V", f"voltage after the low pass {of} {AT_END}"),
            f"{READ_FORCE}_{side}": Quantity(force[-1].tolist(), "N", f"force by the calibration {of} {AT_END}"),
            f"{VOLTAGE}_{side}_history": Quantity(voltage.tolist(), "V", f"voltage after the low pass {of} {OVER_TIME}"),
            f"{READ_FORCE}_{side}_history": Quantity(force.tolist(), "N", f"force by the calibration {of} {OVER_TIME}"),
            f"{SATURATED}_{side}": Quantity(
                reading.saturated[:, k].mean(axis=0).tolist(),
                "1",
                f"part of the samples {of} outside the range of the converter, [row][column]",
            ),
            f"{SATURATED}_{side}_history": Quantity(
                reading.saturated[:, k].astype(int).tolist(), "1", f"1 for a sample {of} outside that range, else 0, {OVER_TIME}"
            ),
        }
    error = reading.force - reading.applied
    words = "read minus applied force, over all taxels and times"
    quantities[f"{READ_FORCE}_rms_error"] = Quantity(root_mean_square(error), "N", f"root mean square of {words}")
    quantities[f"{READ_FORCE}_largest_error"] = Quantity(float(np.abs(error).max()), "N", f"largest absolute value of {words}")
    return quantities


def readout_assumptions(readout: MatrixReadout, area: float) -> tuple[str, ...]:
    """What is assumed of sensors and electronics; ``area`` in m^2 is that of a taxel."""
    line = readout.line(area)
    assumptions = [*readout.film.assumptions(), "force linear between the accepted steps, from zero at 0 s"]
    if readout.calibration is None:
        low, high = (format_quantity(value, "N") for value in readout.calibration_forces)
        assumptions.append(
            f"calibration by the film's own line from {low} to {high} after 1 s: "
            f"C = {line.slope * 1e3:.4g} mS/N F {line.intercept * 1e3:+.3g} mS"
        )
    if readout.scatter is not None:
        assumptions.append(
            f"channels differ by {readout.scatter.repeatability:.3g} of a full scale of "
            f"{format_quantity(readout.scatter.full_scale, 'N')} (one standard deviation)"
        )
    return tuple(assumptions)


def single_step(readout: MatrixReadout, reading: MatrixReading, area: float) -> tuple[str, ...]:
    """A warning if the film's signal depends on the past of a force that was computed in a single step."""
    if not _remembers(readout.film_of(area), float(reading.time[-1]), float(reading.applied[-1].max())):
        return ()
    return (
        "the film creeps, and the force is taken to rise evenly in the one step: read forces may be 5 % too high; in "
        f"the grasp, take time.steps: {ENOUGH_STEPS}",
    )


def readout_warnings(readout: MatrixReadout, reading: MatrixReading, area: float) -> tuple[str, ...]:
    """What a user must know of the readings; ``area`` in m^2 is that of a taxel."""
    warnings = list(readout.film_of(area).warnings(float(reading.applied.max())))
    warnings += _line_for_other_forces(reading)
    if reading.strongest_pull > 0:
        pull = format_quantity(reading.strongest_pull, "N")
        warnings.append(f"a taxel is pulled by up to {pull} in the solution; the sensor reads it as no force")
    if reading.missed > MISSED * float(reading.applied.max()):
        missed, last = format_quantity(reading.missed, "N"), format_quantity(float(reading.time[-1]), "s")
        warnings.append(
            f"the last sample, at {last}, stands for the end, until which the force on a taxel still changes by {missed}; raise "
            "sampling_rate"
        )
    if reading.saturated.any():
        count = int(reading.saturated.sum())
        where = "" if (reading.saturated & (reading.applied > 0)).any() else ", all of them without a force"
        warnings.append(
            f"{count} of {reading.saturated.size} samples of taxels are outside the range of the converter or not below the "
            f"supply{where}: saturated_*"
        )
    return tuple(warnings)


def _line_for_other_forces(reading: MatrixReading) -> list[str]:
    """A warning if the calibration reads what is no force at all: the line of 0 to 2 N on small taxels gave -0.3 N at 0.04 N."""
    off = np.abs(reading.force[-1] - reading.applied[-1])[~reading.saturated[-1]]
    worst, largest = float(off.max(initial=0.0)), float(reading.applied.max())
    if not worst > largest > 0:
        return []
    return [
        f"read forces are off by {format_quantity(worst, 'N')} at the end, more than the largest force, "
        f"{format_quantity(largest, 'N')}: the line of the calibration is for other forces; end calibration_forces near that "
        "one, or give the calibration"
    ]


def _remembers(film: SensorFilm, end: float, force: float) -> bool:
    """Whether the signal of a film under a force in N at ``end`` in s depends on when the force began to rise."""
    if not (end > 0 and force > 0):
        return False
    late, evenly = (float(film.read([0.0, end / 2, end], [0.0, before, force])[-1]) for before in (0.0, force / 2))
    return abs(late / evenly - 1) >= REMEMBERED
