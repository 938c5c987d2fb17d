"""How far the surface in the hole of the annulus rises over its face."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.analytic.force_factor import rise_factor
from tactsim.validation.evaluator import Evaluator, Inputs


class AnnulusRiseFactor(Evaluator):
    """Height of the surface on the axis above the face of the annulus over its displacement, on a half-space."""

    kind: Literal["annulus_rise_factor"] = "annulus_rise_factor"
    radius_ratio: Annotated[float, Field(ge=0, le=0.99)]
    """Inner over outer radius."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of chapter 4."""
        return cls(radius_ratio=0.1)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        return float(rise_factor(self.radius_ratio))
