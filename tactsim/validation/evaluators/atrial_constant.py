"""A constant of Table 4.1."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.analytic.atrial import table_4_1
from tactsim.validation.atrial_units import numbered_unit
from tactsim.validation.evaluator import Evaluator, Inputs


class AtrialConstant(Evaluator):
    """E_0 or E_i in Pa, or tau_i in s, taken out of the creep compliance that the library builds from Table 4.1."""

    kind: Literal["atrial_constant"] = "atrial_constant"
    constant: Literal["modulus", "time"]
    """Column of the table."""
    number: Annotated[int, Field(ge=0, le=8)]
    """Row of the table; 0 is the free spring, which has no time."""

    @classmethod
    def example(cls) -> Self:
        """The free spring."""
        return cls(constant="modulus", number=0)

    @property
    def found_unit(self) -> str:
        """Pa or s."""
        return "Pa" if self.constant == "modulus" else "s"

    def found(self, inputs: Inputs) -> float:
        """In Pa or s."""
        if self.constant == "modulus" and self.number == 0:
            return 1 / table_4_1().glassy_compliance
        compliance, time = numbered_unit("retardation_times", self.number)
        return 1 / compliance if self.constant == "modulus" else time
