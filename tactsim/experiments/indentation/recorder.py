"""An indentation, in the section or in 3D, without time or with it: geometry and tissue, the end, and the way there."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.experiments.indentation.displaced import DisplacedSetup
from tactsim.experiments.indentation.history import THRESHOLD, UNITS
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.experiments.recording import history
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import ComputedSteps, Values
from tactsim.interfaces.variable import Variable, label, reading
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.outcome.contact_history import WHOLE_RUN
from tactsim.mechanics.paths.history_path import smooth_intervals
from tactsim.results.result import Result
from tactsim.sensors.force_reading import READ
from tactsim.units import format_quantity

GEOMETRY = {
    "inner_radius": ("m", "radius of the hole, 0 for a body without one"),
    "outer_radius": ("m", "radius of the face"),
    "recess": ("m", "depth of the inner sensor; NaN if there is none"),
    "thickness": ("m", "thickness of the specimen"),
}
ELASTIC = {"shear_modulus": ("Pa", "small-strain shear modulus of the specimen's main material")}
RELAXING = {
    "instantaneous_shear_modulus": ("Pa", "small-strain shear modulus of the specimen's main material at once"),
    "equilibrium_shear_modulus": ("Pa", "that after a long time"),
}
FRICTION = {"friction": ("1", "coefficient of friction; NaN of a law that has none")}
POSE = {
    "offset": ("m", "distance of the body along x from the axis of the specimen"),
    "tilt_x": ("rad", "rotation of the body about x, before that about y"),
    "tilt_y": ("rad", "rotation of the body about y"),
}
END = {
    "displacement": ("m", "displacement of the body from first touch at the end"),
    "reaction_force": ("N", "force of the tissue on the body at the end"),
    "tissue_rise": ("m", "largest height of the tissue in the hole above the face at the end"),
    **{name: WHOLE_RUN[name] for name in ("max_penetration", "unstable_volume_fraction")},
}
CURVES = {
    "displacement": "displacement of the body from first touch",
    "reaction_force": "force of the tissue on the body, along the axis, without noise",
    "tissue_rise": "largest height of the tissue in the hole above the face; NaN of a body without a hole",
}
"""What is stored on the way to the end, under its name and `_history`."""


class PressedBodyRecorder(Recorder):
    """What the recorders of all indentations share."""

    histories: ClassVar = True
    optional: ClassVar = (*THRESHOLD, "tissue_rise", "time_of_touch")
    along: ClassVar[str] = "displacement"
    """What grows evenly from stored moment to stored moment."""
    dimension: ClassVar[str] = "load_step"
    """Dimension of the curves."""

    def label_words(self) -> dict[str, tuple[str, str]]:
        """Unit and description of the labels."""
        return GEOMETRY | ELASTIC | FRICTION

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """Geometry, moduli and friction."""
        return [label(name, unit, words) for name, (unit, words) in self.label_words().items()]

    def labels(self, experiment: Any) -> Values:
        """Values of these labels."""
        shape, recess, material = experiment.body.contact_shape, experiment.recess, experiment.specimen.material
        relaxation = shear_relaxation(material)
        known = {
            "inner_radius": shape.hole,
            "outer_radius": np.nan if shape.radius is None else shape.radius,
            "recess": np.nan if recess is None else recess,
            "thickness": experiment.specimen.thickness,
            "shear_modulus": material.shear_modulus,
            "instantaneous_shear_modulus": relaxation.instantaneous_modulus,
            "equilibrium_shear_modulus": relaxation.equilibrium_modulus,
            "friction": getattr(experiment.contact, "friction", np.nan),
        }
        known |= {name: getattr(experiment, name) for name in POSE if hasattr(experiment, name)}
        return {name: np.array(known[name]) for name in self.label_words()}

    def readings_of(self, experiment: Any) -> list[Variable]:
        """Curves, if more than the end is stored."""
        if self.settings.times == 1:
            return []
        given, sizes = self.prescribed(experiment), {self.dimension: self.settings.times}
        return [
            reading(f"{name}_history", UNITS[name], words, optional=name == "tissue_rise", prescribed=name == given, **sizes)
            for name, words in CURVES.items()
        ]

    def readings(self, experiment: Any, result: Result, generator: np.random.Generator) -> Values:
        """Linear between the accepted steps, from nothing at first touch."""
        if self.settings.times == 1:
            return {}
        along, columns = history(result, self.along)
        at, nothing = self.settings.stored_times(float(along[-1])), np.full_like(along, np.nan)
        return {f"{name}_history": np.interp(at, along, columns.get(name, nothing)) for name in CURVES}

    def prescribed(self, experiment: Any) -> str:
        """Which of the curves the case prescribes."""
        return "displacement"


class DisplacedRecorder(PressedBodyRecorder):
    """Of an indentation without time: what holds at the threshold and at the end, and curves over the displacement."""

    quantities: ClassVar = THRESHOLD | END
    elements: ClassVar[str] = "axisymmetric finite elements"

    def steps(self, experiment: DisplacedSetup) -> ComputedSteps:
        """Its load steps; where the tissue touches the inner sensor before, there are fewer of them."""
        shortest = format_quantity(experiment.displacement / self.settings.times, "m")
        return ComputedSteps(experiment.control().largest, experiment.displacement, "m", f"steps.largest: {shortest}")

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A rigid body, in most cases the annulus of a threshold sensor, pressed into soft tissue: finite strain, "
            f"{self.elements}, unilateral contact with Coulomb friction. The threshold is the instant "
            "at which the tissue touches the recessed inner sensor; NaN where it is not reached."
        )


class IndentationRecorder(DisplacedRecorder):
    """Geometry and modulus of an indentation along the axis."""

    kind: Literal["indentation"] = "indentation"


class Indentation3dRecorder(DisplacedRecorder):
    """Those of an indentation in the section, and how the body leans."""

    kind: Literal["indentation_3d"] = "indentation_3d"
    elements: ClassVar = "finite elements in 3D, as the body may lean"

    def label_words(self) -> dict[str, tuple[str, str]]:
        """Unit and description of the labels."""
        return super().label_words() | POSE


class TimedIndentationRecorder(PressedBodyRecorder):
    """Geometry and moduli; force and displacement at the end, their curves over time, and what a sensor reads of the force."""

    kind: Literal["timed_indentation"] = "timed_indentation"
    reads_force: ClassVar = True
    quantities: ClassVar = {
        **END,
        "largest_reaction_force": ("N", "largest force at any accepted step"),
        "largest_displacement": ("m", "largest displacement at any accepted step"),
        "time_of_touch": ("s", "time at which the tissue touches the inner sensor, NaN where the run does not look for it"),
    }
    along: ClassVar = "time"
    dimension: ClassVar = "time"

    def label_words(self) -> dict[str, tuple[str, str]]:
        """Unit and description of the labels."""
        return GEOMETRY | RELAXING | FRICTION

    def readings_of(self, experiment: TimedIndentation) -> list[Variable]:
        """Times, curves if more than the end is stored, and what a sensor reads."""
        times = self.settings.times
        read = READ if self.settings.reading is not None else {}
        return [
            reading("time_s", "s", "time since the beginning of the history", time=times),
            *super().readings_of(experiment),
            *(reading(name, unit, words, time=times) for name, (unit, words) in read.items()),
        ]

    def readings(self, experiment: TimedIndentation, result: Result, generator: np.random.Generator) -> Values:
        """Linear between the accepted steps, from nothing at 0 s; voltages at the last sample before."""
        times, columns = history(result)
        at = self.settings.stored_times(float(times[-1]))
        sensor = self.settings.reading
        read = {} if sensor is None else sensor.read(times, columns["reaction_force"], at, generator)
        return {"time_s": at, **super().readings(experiment, result, generator), **read}

    def prescribed(self, experiment: TimedIndentation) -> str:
        """Which of the curves the case prescribes."""
        return "displacement" if experiment.loading.control == "displacement" else "reaction_force"

    def steps(self, experiment: TimedIndentation) -> ComputedSteps | None:
        """Its load steps, and its stops in time where these are closer; None if what is prescribed only jumps."""
        loading, policy = experiment.loading, experiment.drive().policy
        changing = [one for one in smooth_intervals([loading.history()], loading.duration) if one.changes]
        if not changing:
            return None
        gaps = [min(policy.largest(one), float(np.diff([one.start, *policy.stops(one)]).max())) for one in changing]
        apart, piece = loading.duration / self.settings.times, max(one.duration for one in changing)
        per_decade = math.ceil(-1 / math.log10(1 - min(apart / piece, 0.9)))
        return ComputedSteps(max(gaps), loading.duration, "s", f"time.per_decade: {per_decade}")

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A rigid body pressed into soft tissue, which may relax, by a history of force or displacement: finite strain, "
            "axisymmetric finite elements, steps of time with a controlled error, unilateral contact with Coulomb friction."
        )
