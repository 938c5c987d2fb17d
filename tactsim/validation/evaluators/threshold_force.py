"""The force that belongs to a printed threshold pressure."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.units import Length, Pressure
from tactsim.validation.evaluator import Evaluator, Inputs


class ThresholdForce(Evaluator):
    """Pressure times the annular area, in N."""

    unit: ClassVar[str] = "N"
    kind: Literal["threshold_force"] = "threshold_force"
    pressure: Pressure
    """Threshold pressure."""
    inner_radius: Length
    """Radius of the hole."""
    outer_radius: Length
    """Radius of the face."""

    @classmethod
    def example(cls) -> Self:
        """The hardest elastomer of Table 3.3."""
        return cls(pressure=89.8e3, inner_radius=1.5e-3, outer_radius=3e-3)

    def found(self, inputs: Inputs) -> float:
        """In N."""
        return float(self.pressure * np.pi * (self.outer_radius**2 - self.inner_radius**2))
