"""Area of the sensor's face."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.units import Length
from tactsim.validation.evaluator import Evaluator, Inputs


class AnnularArea(Evaluator):
    """pi (ro^2 - ri^2) in m^2."""

    unit: ClassVar[str] = "m^2"
    kind: Literal["annular_area"] = "annular_area"
    inner_radius: Length = 0.0
    """Radius of the hole; zero for the full disc."""
    outer_radius: Length
    """Radius of the face."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of Fig. 3.7d."""
        return cls(inner_radius=1.5e-3, outer_radius=3e-3)

    def found(self, inputs: Inputs) -> float:
        """In m^2."""
        return float(np.pi * (self.outer_radius**2 - self.inner_radius**2))
