"""Force factor of the annulus, and how far a formula of it is off."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.force_factor import force_factor
from tactsim.validation.evaluator import Evaluator, Inputs


class AnnulusForceFactor(Evaluator):
    """kappa = (1 - nu) p / (4 G ro eps0) at a radius ratio, or what a formula of it is off by, or what its powers would need."""

    kind: Literal["annulus_force_factor"] = "annulus_force_factor"
    radius_ratio: Annotated[float, Field(ge=0, le=0.99)]
    """Inner over outer radius."""
    formula: Literal["exact", "thesis_4_2_21", "small_hole_series", "smythe"] = "exact"
    """Formula of the force factor."""
    measure: Literal["value", "relative_error", "third_power", "fourth_power"] = "value"
    """The number; its relative error; (1 - kappa) / beta^3; (1 - kappa - 4 beta^3 / (3 pi^2)) / beta^4."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of chapter 4."""
        return cls(radius_ratio=0.1)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        beta = self.radius_ratio
        factor = float(force_factor(beta, self.formula))
        if self.measure == "relative_error":
            return factor / float(force_factor(beta)) - 1
        if self.measure == "third_power":
            return (1 - factor) / beta**3
        return factor if self.measure == "value" else (1 - factor - 4 * beta**3 / (3 * np.pi**2)) / beta**4
