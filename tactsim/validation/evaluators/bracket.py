"""The end of a bracket of simulations that lies nearest to a printed number."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.errors import InputError
from tactsim.validation.bracket import readings
from tactsim.validation.evaluator import Evaluator, Inputs


class Bracket(Evaluator):
    """The printed number itself if it lies between the smallest and largest simulated one, else the nearer of the two.

    Only runs that converged count. For ``threshold_pressure`` the bracket spans the pressures over both areas of erratum E16.
    """

    kind: Literal["bracket"] = "bracket"
    studies: Annotated[tuple[str, ...], Field(min_length=1)]
    """Studies of the table that make the bracket."""
    quantity: Literal["threshold_pressure", "threshold_displacement"]
    """Quantity of the runs."""
    area: Literal["annulus", "disc", "both"] = "both"
    """Which area a pressure refers to."""

    @classmethod
    def example(cls) -> Self:
        """The pressures of the soft elastomer."""
        return cls(studies=("icf",), quantity="threshold_pressure")

    @property
    def found_unit(self) -> str:
        """Pa or m."""
        return "Pa" if self.quantity == "threshold_pressure" else "m"

    def found(self, inputs: Inputs) -> float:
        """In Pa or m."""
        if inputs.expected is None:
            raise InputError("a bracket needs a printed number to compare")
        outcomes = [outcome for study in self.studies for outcome in inputs.study(study) if outcome.converged]
        if not outcomes:
            raise InputError(f"no run of {', '.join(self.studies)} converged")
        values = [value for outcome in outcomes for value in readings(outcome, self.quantity, self.area)]
        return min(max(inputs.expected, min(values)), max(values))
