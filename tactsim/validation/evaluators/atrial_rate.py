"""Rate of a Kelvin unit of Table 4.1."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.validation.atrial_units import numbered_unit
from tactsim.validation.evaluator import Evaluator, Inputs


class AtrialRate(Evaluator):
    """1 / tau_i in 1/s: E_i / C_i if the column of times holds viscosities (E7)."""

    unit: ClassVar[str] = "1/s"
    kind: Literal["atrial_rate"] = "atrial_rate"
    number: Annotated[int, Field(ge=1, le=8)]
    """Row of Table 4.1."""
    times: Literal["retardation_times", "viscosities"] = "viscosities"
    """Reading of the column of times."""

    @classmethod
    def example(cls) -> Self:
        """The fastest unit."""
        return cls(number=7)

    def found(self, inputs: Inputs) -> float:
        """In 1/s."""
        return 1 / numbered_unit(self.times, self.number)[1]
