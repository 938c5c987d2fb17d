"""An indentation by an annulus up to its threshold."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.experiments.indentation.history import THRESHOLD
from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Values
from tactsim.interfaces.variable import Variable, label
from tactsim.mechanics.outcome.contact_history import WHOLE_RUN

LABELS = {
    "inner_radius": ("m", "radius of the hole, 0 for a body without one"),
    "outer_radius": ("m", "radius of the face"),
    "recess": ("m", "depth of the inner sensor; NaN if there is none"),
    "thickness": ("m", "thickness of the specimen"),
    "shear_modulus": ("Pa", "small-strain shear modulus of the specimen's main material"),
    "friction": ("1", "coefficient of friction; NaN of a law that has none"),
}


class IndentationRecorder(Recorder):
    """Geometry and modulus; force, displacement and pressure at the threshold and at the end."""

    kind: Literal["indentation"] = "indentation"
    quantities: ClassVar = {
        **THRESHOLD,
        "displacement": ("m", "displacement of the body from first touch at the end"),
        "reaction_force": ("N", "force of the tissue on the body at the end"),
        "tissue_rise": ("m", "largest height of the tissue in the hole above the face at the end"),
        **{name: WHOLE_RUN[name] for name in ("max_penetration", "unstable_volume_fraction")},
    }
    optional: ClassVar = (*THRESHOLD, "tissue_rise")

    def labels_of(self, experiment: Experiment) -> list[Variable]:
        """Geometry, modulus and friction."""
        return [label(name, unit, words) for name, (unit, words) in LABELS.items()]

    def labels(self, experiment: Any) -> Values:
        """Values of the same."""
        shape, recess = experiment.body.contact_shape, experiment.recess
        values = (
            shape.hole,
            np.nan if shape.radius is None else shape.radius,
            np.nan if recess is None else recess,
            experiment.specimen.thickness,
            experiment.specimen.material.shear_modulus,
            getattr(experiment.contact, "friction", np.nan),
        )
        return {name: np.array(value) for name, value in zip(LABELS, values, strict=True)}

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A rigid body, in most cases the annulus of a threshold sensor, pressed into soft tissue: finite strain, "
            "axisymmetric finite elements, unilateral contact with Coulomb friction. The threshold is the instant "
            "at which the tissue touches the recessed inner sensor; NaN where it is not reached."
        )
