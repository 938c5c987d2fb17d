"""A dimension of the switch probe, measured on its model."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.contact.trapezoid import Trapezoid
from tactsim.sensors.switch_array import SwitchArray
from tactsim.validation.evaluator import Evaluator, Inputs

UNITS = {"switches": "1", "left": "1", "right": "1", "pitch": "m", "travel": "m", "lean": "rad"}


class ProbeDimension(Evaluator):
    """Number or place of the switches, or the lean of a side from the normal of its surface 3 mm above the face."""

    unit: ClassVar[str] = "1"
    kind: Literal["probe_dimension"] = "probe_dimension"
    dimension: Literal["switches", "left", "right", "pitch", "travel", "lean"]
    """Which."""

    @property
    def found_unit(self) -> str:
        """SI unit of the dimension."""
        return UNITS[self.dimension]

    @classmethod
    def example(cls) -> Self:
        """The lean of the sides."""
        return cls(dimension="lean")

    def found(self, inputs: Inputs) -> float:
        """In SI."""
        array = SwitchArray()
        if self.dimension == "lean":
            probe, height = Trapezoid(), 3e-3
            _, normal, _ = probe.signed_distance(np.array([[float(probe.half_width(height))], [height]]))
            return float(np.arctan2(-normal[1, 0], normal[0, 0]))
        if self.dimension == "pitch":
            return float(np.diff(array.heights).mean())
        if self.dimension == "travel":
            return float(array.heights[-1])
        return float(array.count if self.dimension == "switches" else array.sides.count(self.dimension))
