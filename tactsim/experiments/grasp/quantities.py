"""The quantities of a grasp: at the last accepted step, and over all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.experiments.grasp.readings import JawReading
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.both_jaws import TAXEL_FORCE, TAXEL_PRESSURE
from tactsim.mechanics.outcome.contact_history import LAST
from tactsim.results.quantity import Quantity

Values = Sequence[dict[str, float]]

BY_TAXEL = "[row][column], row 1 nearest the front (smallest y), column 1 the smallest x"


def final_quantities(values: Values, readings: dict[str, JawReading], experiment: GraspSetup) -> dict[str, Quantity]:
    """Quantities at the last accepted step, and the extremes of all steps."""
    last, area = values[-1], experiment.matrix.area
    quantities = {
        "time": Quantity(last["time"], "s", "time of the last accepted step"),
        "displacement": Quantity(last["displacement"], "m", "closing of each jaw from first touch" + LAST),
        "reaction_force": Quantity(last["reaction_force"], "N", "force pressing into the face of the upper jaw" + LAST),
    }
    for side, reading in readings.items():
        x, y, normal = reading.taxels.taxels
        of = f"of the {side} jaw{LAST}"
        quantities |= {
            f"jaw_force_{side}": Quantity(reading.force.tolist(), "N", f"force (x, y, z) of the tissue on the {side} jaw" + LAST),
            f"{TAXEL_FORCE}_{side}": Quantity(normal.tolist(), "N", f"force pressing on each taxel {of}; {BY_TAXEL}"),
            f"taxel_shear_{side}": Quantity(
                np.stack([x, y], axis=-1).tolist(), "N", f"force (x, y) along the face on each taxel {of}; {BY_TAXEL}"
            ),
            f"{TAXEL_PRESSURE}_{side}": Quantity(
                (normal / area).tolist(), "Pa", f"force over area of each taxel {of}; {BY_TAXEL}"
            ),
            f"gap_force_{side}": Quantity(float(reading.taxels.gaps[2]), "N", f"force pressing between the taxels {of}"),
            f"outside_force_{side}": Quantity(float(reading.taxels.outside[2]), "N", f"force pressing beside the matrix {of}"),
        }
    if experiment.lumens:
        pressures = [last[f"lumen_pressure_{number}"] for number in experiment.lumens]
        quantities["lumen_pressure"] = Quantity(
            pressures, "Pa", "pressure in each [lumen], by the order of the inclusions" + LAST
        )
    return quantities


def history_quantities(values: Values, readings: Sequence[dict[str, JawReading]], experiment: GraspSetup) -> dict[str, Quantity]:
    """What every accepted step had, if there are more than one."""
    if len(values) < 2:
        return {}
    descriptions = {
        "time": "time",
        "displacement": "closing of each jaw",
        "reaction_force": "force pressing into the upper jaw's face",
    }
    units = {"time": "s", "displacement": "m", "reaction_force": "N"}
    histories = {
        f"{name}_history": Quantity([step[name] for step in values], units[name], f"{text}, at each accepted step [time]")
        for name, text in descriptions.items()
    }
    for side in readings[0]:
        forces = [reading[side].taxels.taxels[2].tolist() for reading in readings]
        text = f"force pressing on each taxel of the {side} jaw, [time]{BY_TAXEL}"
        histories[f"{TAXEL_FORCE}_{side}_history"] = Quantity(forces, "N", text)
    if experiment.lumens:
        pressures = [[step[f"lumen_pressure_{number}"] for number in experiment.lumens] for step in values]
        histories["lumen_pressure_history"] = Quantity(pressures, "Pa", "pressure in each lumen, [time][lumen]")
    return histories
