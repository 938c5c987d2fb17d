"""A grasp: what lies in the block, and what the taxels feel and read."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.lumen_pressure import lumen_history
from tactsim.experiments.recording import history
from tactsim.interfaces import Experiment, Inclusion, Recorder
from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, TAXEL_PRESSURE, VOLTAGE, jaws_at_end, jaws_over_time
from tactsim.interfaces.recording import ComputedSteps, Values
from tactsim.interfaces.variable import Variable, label, reading
from tactsim.mechanics.outcome.contact_history import WHOLE_RUN
from tactsim.registry import kinds
from tactsim.results.result import Result
from tactsim.sensors.force_reading import CLEAN, latest, read_variables

PER_INCLUSION = {
    "inclusion_radius": ("m", "radius of a sphere, outer radius of a tube, that of a ball of equal volume of others"),
    "inclusion_wall": ("m", "wall of a tube"),
    "inclusion_lumen_pressure": ("Pa", "pressure in the empty space of a tube at the end, 0 without"),
    "inclusion_depth": ("m", "distance of the highest point from the upper face"),
    "inclusion_shear_modulus": ("Pa", "small-strain shear modulus"),
    "inclusion_contrast": ("1", "shear modulus over that of the tissue, both at rest"),
}
CENTER = "centre (x, y, z): x grows with the column, y with the row, z is the height above the lower face"
PER_SAMPLE = {
    "tissue_shear_modulus": ("Pa", "small-strain shear modulus of the tissue"),
    "friction": ("1", "coefficient of friction at the jaws; NaN of a law that has none"),
    "closing": ("m", "largest closing of each jaw from first touch; NaN if a force is prescribed"),
}
TAXELS = {
    TAXEL_FORCE: ("N", "force pressing on each taxel, without noise"),
    TAXEL_PRESSURE: ("Pa", "force over area of each taxel, without noise"),
}
BESIDE = {
    "gap_force": ("N", "force between the taxels of each jaw, at the end"),
    "outside_force": (
        "N",
        "force beside the matrix of each jaw, at the end; taxels, gaps and outside add up to the force of the jaw",
    ),
}
READ = read_variables("voltage of each taxel after the low pass", "force of each taxel by the calibration")
MOTION = {"displacement": ("m", "closing of each jaw"), "reaction_force": ("N", "force pressing into the face of the upper jaw")}


class GraspRecorder(Recorder):
    """Inclusions, closing and tissue; forces, pressures, voltages and read forces of all taxels over time."""

    kind: Literal["grasp"] = "grasp"
    noise_seed: ClassVar = ("readout", "seed")
    histories: ClassVar = True
    quantities: ClassVar = WHOLE_RUN

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """Inclusions padded to the largest number of the sweep."""
        count = self.most_inclusions
        variables = [Variable("inclusion_count", "1", "number of inclusions", "label", dtype="int64")]
        variables += [label(name, unit, words) for name, (unit, words) in PER_SAMPLE.items()]
        if count:
            variables.append(
                Variable("inclusion_kind", "1", "kind", "label", ("inclusion",), (count,), "uint8", inclusion_kinds())
            )
            variables += [label(name, unit, words, inclusion=count) for name, (unit, words) in PER_INCLUSION.items()]
            variables.append(label("inclusion_center", "m", CENTER, inclusion=count, axis=3))
            variables.append(label("inclusion_direction", "1", "unit vector along a tube", inclusion=count, axis=3))
        return variables

    def labels(self, experiment: Grasp) -> Values:
        """Values of these labels; what a kind of inclusion does not have is NaN, and a lump of the tissue's own material is none.

        Raises
        ------
        InvalidQuantity
            If there are more inclusions than the store has places for.
        """
        end = experiment.duration
        size, tissue = np.array(experiment.block.size), experiment.block.tissue.shear_modulus
        closing = experiment.loading.least_and_most()[1] if experiment.loading.control == "displacement" else np.nan
        there = experiment.unlike_tissue
        if len(there) > self.most_inclusions:
            raise InvalidQuantity(f"{len(there)} inclusions; the store has place for {self.most_inclusions}")
        labels = {"inclusion_count": len(there), "tissue_shear_modulus": tissue, "closing": closing}
        labels["friction"] = getattr(experiment.contact, "friction", np.nan)
        padded = {v.name: v.empty(1)[0] for v in self.labels_of(experiment) if "inclusion" in v.dimensions}
        for number, embedded in enumerate(there):
            modulus = embedded.material.shear_modulus
            values = _geometry(embedded.shape, size)
            if embedded.shape.hollow:
                lumen = embedded.lumen
                values["inclusion_lumen_pressure"] = float(lumen_history(lumen, end).value(end)) if lumen else 0.0
            values |= {"inclusion_shear_modulus": modulus, "inclusion_contrast": modulus / tissue}
            for name, value in values.items():
                padded[name][number] = value
        return {name: np.asarray(value) for name, value in (labels | padded).items()}

    def readings_of(self, experiment: Any) -> list[Variable]:
        """Histories at the stored times."""
        layout, times = experiment.matrix, self.settings.times
        variables = [reading("time_s", "s", "time since first touch", time=times)]
        given = "displacement" if experiment.loading.control == "displacement" else "reaction_force"
        variables += [reading(name, unit, words, prescribed=name == given, time=times) for name, (unit, words) in MOTION.items()]
        sizes = {"time": times, "jaw": 2, "row": layout.rows, "column": layout.columns}
        taxels = TAXELS | (READ if experiment.readout is not None else {})
        variables += [reading(name, unit, f"{words}; jaw 0 is the upper", **sizes) for name, (unit, words) in taxels.items()]
        return [*variables, *(reading(name, unit, words, jaw=2) for name, (unit, words) in BESIDE.items())]

    def steps(self, experiment: Grasp) -> ComputedSteps | None:
        """Its load steps; None if nothing prescribed changes but by jumps."""
        from tactsim.experiments.grasp.path import grasp_intervals  # loads the solver

        policy = experiment.time.policy(experiment.materials)
        changing = [interval for interval in grasp_intervals(experiment) if interval.changes]
        if not changing:
            return None
        longest = max(policy.largest(interval) for interval in changing)
        return ComputedSteps(longest, experiment.duration, "s", f"time.steps: {self.settings.times}")

    def readings(self, experiment: Grasp, result: Result, generator: np.random.Generator) -> Values:
        """Linear between the accepted steps, from nothing at 0 s; voltages at the last sample before."""
        times, columns = history(result)
        at = self.settings.stored_times(float(times[-1]))
        force = jaws_over_time(result, TAXEL_FORCE)
        if len(force) < len(times):
            force = np.concatenate([np.zeros_like(force[:1]), force])
        taxels = _interpolated(at, times, force)
        readings = {"time_s": at, TAXEL_FORCE: taxels, TAXEL_PRESSURE: taxels / experiment.matrix.area}
        readings |= {name: np.interp(at, times, columns[name]) for name in MOTION}
        readings |= {name: jaws_at_end(result, name) for name in BESIDE}
        if experiment.readout is not None:
            sample = latest(result.quantities["readout_time"].numbers, at)
            readings |= {name: jaws_over_time(result, name)[sample] for name in (VOLTAGE, READ_FORCE)}
            clean = experiment.readout.quiet.read(times, force, experiment.matrix.area)
            readings |= {f"{VOLTAGE}{CLEAN}": clean.filtered[sample], f"{READ_FORCE}{CLEAN}": clean.force[sample]}
        return readings

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A block of soft tissue with lumps or arteries, grasped between two jaws with matrices of force sensors: finite "
            "strain, nearly or exactly incompressible tissue, unilateral contact with Coulomb friction, by finite elements. "
            "The first row is nearest the front (smallest y), the first column has the smallest x, jaw 0 is the upper one."
        )


def _interpolated(at: Array, times: Array, values: Array) -> Array:
    if len(times) == 1:
        return np.repeat(values, len(at), axis=0)
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    share = np.clip((at - times[after - 1]) / (times[after] - times[after - 1]), 0, 1).reshape(-1, *[1] * (values.ndim - 1))
    return (1 - share) * values[after - 1] + share * values[after]


def inclusion_kinds() -> tuple[str, ...]:
    """What the numbers of `inclusion_kind` stand for: nothing, the kinds with a number of their own, then all others."""
    known: dict[str, type[Inclusion]] = kinds(Inclusion)
    numbers = {kind: cls.data_set_number for kind, cls in known.items()}
    return ("none", *sorted(known, key=lambda kind: (numbers[kind] is None, numbers[kind] or 0, kind)))


def _geometry(shape: Inclusion, size: Array) -> dict[str, Any]:
    """Labels of an inclusion in a block of size (3,) in m."""
    measured = shape.measures(size)
    geometry: dict[str, Any] = {
        "inclusion_kind": inclusion_kinds().index(shape.kind),
        "inclusion_center": measured.center,
        "inclusion_radius": measured.radius,
        "inclusion_depth": size[2] - measured.top,
    }
    optional = {"inclusion_direction": measured.direction, "inclusion_wall": measured.wall}
    return geometry | {name: value for name, value in optional.items() if value is not None}
