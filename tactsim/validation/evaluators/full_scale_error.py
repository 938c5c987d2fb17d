"""The force that an accuracy in parts of the full scale stands for."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.units import Force
from tactsim.validation.evaluator import Evaluator, Inputs


class FullScaleError(Evaluator):
    """Part of the full scale, in N."""

    unit: ClassVar[str] = "N"
    kind: Literal["full_scale_error"] = "full_scale_error"
    part: Annotated[float, Field(gt=-1, lt=1)]
    """Part of the full scale, dimensionless."""
    full_scale: Annotated[Force, Field(gt=0)]
    """End of the range of force."""

    @classmethod
    def example(cls) -> Self:
        """The accuracy of 3.1.2."""
        return cls(part=0.025, full_scale=25.0)

    def found(self, inputs: Inputs) -> float:
        """In N."""
        return self.part * self.full_scale
