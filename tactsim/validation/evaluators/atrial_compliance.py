"""Compliance of the atrial tissue."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.analytic.atrial import table_4_1
from tactsim.units import Time
from tactsim.validation.atrial_units import numbered_unit
from tactsim.validation.evaluator import Evaluator, Inputs


class AtrialCompliance(Evaluator):
    """Compliance D of Table 4.1 in 1/Pa: of one unit, or its creep after a time, or after infinite time."""

    unit: ClassVar[str] = "1/Pa"
    kind: Literal["atrial_compliance"] = "atrial_compliance"
    number: Annotated[int, Field(ge=1, le=8)] | None = None
    """Unit of the table; null for the whole."""
    time: Annotated[Time, Field(ge=0)] | None = None
    """Time since a step of stress; null for infinite time."""
    times: Literal["retardation_times", "viscosities"] = "viscosities"
    """Reading of the column of times."""

    @classmethod
    def example(cls) -> Self:
        """The creep of section 4.7."""
        return cls(time=0.5)

    def found(self, inputs: Inputs) -> float:
        """In 1/Pa."""
        if self.number is not None:
            return numbered_unit(self.times, self.number)[0]
        model = table_4_1(self.times)
        return model.equilibrium_compliance if self.time is None else float(model.creep(self.time))
