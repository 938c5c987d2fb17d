"""What the six slow Kelvin units add to the static response of section 4.7."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.analytic.histories import step
from tactsim.analytic.response import response
from tactsim.units import Time
from tactsim.validation.atrial_units import units_by_speed
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.evaluators.load_transform import STATIC


class SlowCreep(Evaluator):
    """Static response with all eight units less that with the two fast ones, times 4 ro kappa, in N/Pa."""

    unit: ClassVar[str] = "N/Pa"
    kind: Literal["slow_creep"] = "slow_creep"
    time: Annotated[Time, Field(ge=0)]
    """Time since the static force began."""

    @classmethod
    def example(cls) -> Self:
        """When the harmonic load begins."""
        return cls(time=2.0)

    def found(self, inputs: Inputs) -> float:
        """In N/Pa."""
        whole, fast = (float(response(units_by_speed(chosen), step(STATIC), self.time)) for chosen in ("all", "fast"))
        return whole - fast
