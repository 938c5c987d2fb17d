"""An indentation by an annulus up to its threshold."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from tactsim.interfaces import Experiment, Recorder
from tactsim.interfaces.recording import Values
from tactsim.interfaces.variable import Variable, label

LABELS = {
    "inner_radius": ("m", "radius of the hole, 0 for a body without one"),
    "outer_radius": ("m", "radius of the face"),
    "recess": ("m", "depth of the inner sensor; NaN if there is none"),
    "thickness": ("m", "thickness of the specimen"),
    "shear_modulus": ("Pa", "small-strain shear modulus of the specimen's main material"),
    "friction": ("1", "coefficient of friction"),
}


class IndentationRecorder(Recorder):
    """Geometry and modulus; force, displacement and pressure at the threshold and at the end."""

    kind: Literal["indentation"] = "indentation"
    quantities: ClassVar = {
        "threshold_force": ("N", "force on the annulus when the tissue touches the inner sensor"),
        "threshold_pressure": ("Pa", "threshold force over the annular area"),
        "threshold_displacement": ("m", "displacement at the threshold"),
        "displacement": ("m", "displacement of the body from first touch at the end"),
        "reaction_force": ("N", "force of the tissue on the body at the end"),
        "tissue_rise": ("m", "largest height of the tissue in the hole above the face at the end"),
        "max_penetration": ("m", "largest penetration at any surface point in any step"),
        "unstable_volume_fraction": ("1", "part of the volume outside strong ellipticity at any accepted step"),
    }
    optional: ClassVar = ("threshold_force", "threshold_pressure", "threshold_displacement", "tissue_rise")

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
            getattr(experiment.contact, "friction", 0.0),
        )
        return {name: np.array(value) for name, value in zip(LABELS, values, strict=True)}

    def describe(self) -> str:
        """What is simulated."""
        return (
            "A rigid body, in most cases the annulus of a threshold sensor, pressed into soft tissue: finite strain, "
            "axisymmetric finite elements, unilateral contact with Coulomb friction. The threshold is the instant "
            "at which the tissue touches the recessed inner sensor; NaN where it is not reached."
        )
