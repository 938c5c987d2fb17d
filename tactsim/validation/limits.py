"""What a row is held to: tolerances and one-sided limits, of numbers and of intervals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from pydantic import Field, model_validator

from tactsim.model import FrozenModel
from tactsim.units import parse_quantity

ROUND_OFF = 1e-12
"""Largest relative difference between two roundings of the same number."""


@dataclass(frozen=True)
class Interval:
    """What a quantity returns that computes a range instead of a number, in SI; a ValueError if ``low`` is above ``high``."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ValueError(f"an interval begins at {self.low:g} and ends below that, at {self.high:g}")

    def nearest(self, value: float) -> float:
        """The value itself if it lies inside, else the nearer end."""
        return min(max(value, self.low), self.high)


Computed = float | Interval


@dataclass(frozen=True)
class Judgement:
    """Whether a row ended as recorded, and how in words."""

    held: bool
    ended: str


def judged(held: bool, words: str) -> Judgement:
    """The judgement in the words of the record, or that it was that."""
    return Judgement(held, words if held else f"was {words}")


class Tolerance(FrozenModel):
    """How far the computed number may be from the expected one, and why."""

    relative: float | None = Field(default=None, ge=0, lt=1)
    """Part of the expected number."""
    absolute: str | float | None = None
    """In the unit of the number."""
    reason: str = Field(min_length=1)
    """Why this much and not less."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("a tolerance is either relative or absolute")
        return self

    def allowed(self, expected: float, unit: str) -> float:
        """Largest difference in SI.

        Raises
        ------
        ValueError, InvalidQuantity
            If an absolute tolerance is no quantity of this unit.
        """
        if self.relative is not None:
            return self.relative * abs(expected)
        return in_si(self.absolute or 0.0, unit)


class Bound(FrozenModel):
    """A limit on one side, and why it is where it is."""

    label: ClassVar[str]
    above: str | float | None = None
    """What the computed number exceeds, in its unit."""
    below: str | float | None = None
    """What it stays under, in its unit."""
    why: str = Field(min_length=1)
    """What that means, and why the limit is where it is."""
    resolution: str | float | None = None
    """What the sensors of the claim resolve: a computed number that is smaller than this is one that they could not see."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.above is None) == (self.below is None):
            raise ValueError("a limit lies either above or below")
        return self

    @property
    def limit(self) -> str:
        """The limit in words."""
        return f"above {self.above}" if self.above is not None else f"below {self.below}"

    def margin(self, computed: Computed, unit: str) -> float:
        """How far what was computed, in SI, lies on the recorded side; negative on the other one.

        Raises
        ------
        ValueError, InvalidQuantity
            If the limit is no quantity of this unit.
        """
        low, high = (computed.low, computed.high) if isinstance(computed, Interval) else (computed, computed)
        if self.above is not None:
            return low - in_si(self.above, unit)
        return in_si(self.below or 0.0, unit) - high

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether the number lies on the recorded side, and whether sensors could see it there."""
        del expected
        unseen = self.resolution is not None and _size(computed) < in_si(self.resolution, unit)
        words = f"{self.label}, {self.limit}" + (f", unseen at a resolution of {self.resolution}" if unseen else "")
        return judged(self.margin(computed, unit) > 0, words)


def in_si(value: str | float, unit: str) -> float:
    """A number as a table writes it in SI: text with a unit, or a plain number for what has none.

    Raises
    ------
    ValueError
        If a plain number stands for what has a unit.
    InvalidQuantity
        If the text is no quantity of this unit.
    """
    if isinstance(value, str):
        return parse_quantity(value, unit)
    if unit != "1":
        raise ValueError(f"{value:g} has no unit; expected text such as '{value:g} {unit}'")
    return float(value)


def _size(computed: Computed) -> float:
    """Size of a number; of an interval the larger one of its ends."""
    return max(abs(computed.low), abs(computed.high)) if isinstance(computed, Interval) else abs(computed)


def number_of(computed: Computed, expected: float | None) -> float:
    """The number itself; of an interval the end nearer to what is expected."""
    return computed.nearest(expected or 0.0) if isinstance(computed, Interval) else computed


def is_within(tolerance: Tolerance, computed: Computed, expected: float | None, unit: str) -> bool:
    """Whether a number, which no interval is, lies as near to what is expected as a tolerance asks, up to round-off."""
    if isinstance(computed, Interval) or expected is None:
        return False
    return abs(computed - expected) <= tolerance.allowed(expected, unit) + ROUND_OFF * abs(expected)
