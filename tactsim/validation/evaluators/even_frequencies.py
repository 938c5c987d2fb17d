"""A series of tests at even spacing."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.units import Frequency
from tactsim.validation.evaluator import Evaluator, Inputs


class EvenFrequencies(Evaluator):
    """Highest frequency in Hz of a series, or its spacing, or the number of its tests, each from the other two."""

    kind: Literal["even_frequencies"] = "even_frequencies"
    quantity: Literal["highest", "spacing", "count"]
    """What is asked for; its own value below does not matter."""
    lowest: Annotated[Frequency, Field(gt=0)] = 1.0
    """First test."""
    highest: Annotated[Frequency, Field(gt=0)] = 36.0
    """Last test."""
    spacing: Annotated[Frequency, Field(gt=0)] = 5.0
    """Difference of successive tests."""
    count: Annotated[int, Field(ge=2)] = 8
    """Number of tests."""

    @classmethod
    def example(cls) -> Self:
        """The tests of section 4.4."""
        return cls(quantity="count")

    @property
    def found_unit(self) -> str:
        """Hz or 1."""
        return "1" if self.quantity == "count" else "Hz"

    def found(self, inputs: Inputs) -> float:
        """In Hz, or a count."""
        if self.quantity == "count":
            return (self.highest - self.lowest) / self.spacing + 1
        if self.quantity == "spacing":
            return (self.highest - self.lowest) / (self.count - 1)
        return self.lowest + self.spacing * (self.count - 1)
