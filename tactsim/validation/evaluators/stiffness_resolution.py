"""The stiffness that a force resolution stands for."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.units import Force, Length
from tactsim.validation.evaluator import Evaluator, Inputs


class StiffnessResolution(Evaluator):
    """Force over displacement, in N/m."""

    unit: ClassVar[str] = "N/m"
    kind: Literal["stiffness_resolution"] = "stiffness_resolution"
    force: Force
    """Smallest force that is told apart."""
    displacement: Length
    """Displacement of the tissue."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of 3.1.2."""
        return cls(force=0.1, displacement=0.8e-3)

    def found(self, inputs: Inputs) -> float:
        """In N/m."""
        return self.force / self.displacement
