"""A taxel against others of the same jaw."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.taxel_readings import Side, taxel, taxels_at


class TaxelContrast(Evaluator):
    """Greatest difference of the force on a taxel from that on any of some others: negative if it reads less than each."""

    unit: ClassVar[str] = "N"
    kind: Literal["taxel_contrast"] = "taxel_contrast"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    side: Side = "lower"
    """Jaw."""
    taxel: tuple[int, int]
    """Row and column, counted from 1."""
    others: Annotated[tuple[tuple[int, int], ...], Field(min_length=1)]
    """Rows and columns of those that it is compared with."""

    @classmethod
    def example(cls) -> Self:
        """Fig. 6.7c: an artery over L1,2 and L1,3 and half of L1,1."""
        return cls(study="half", run="hard tube", taxel=(1, 1), others=((1, 2), (1, 3)))

    def found(self, inputs: Inputs) -> float:
        """In N."""
        forces = taxels_at(inputs, (self.study, self.run), self.side)
        return max(taxel(forces, self.taxel) - taxel(forces, other) for other in self.others)
