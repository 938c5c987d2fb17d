"""How a row of a table ends: a class for every ending, which judges what was computed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tactsim.model import FrozenModel
from tactsim.units import parse_quantity

Origin = Literal["thesis", "erratum", "exact", "published", "other_program", "own"]
"""Where the expected number or the claim comes from: the thesis prints it, the errata derive it, a closed form gives it, another
author published it, another program computed it, or this program did and the row only watches that it does not change."""
ROUND_OFF = 1e-12
"""Largest relative difference between two roundings of the same number."""
READ_BACK = 1e-6
"""Largest relative difference of an input that is read back: some are results of fits, which are known no better."""


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


def _judged(held: bool, words: str) -> Judgement:
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
        """Whether the number lies on the recorded side."""
        del expected
        return _judged(self.margin(computed, unit) > 0, f"{self.label}, {self.limit}")


class Reproduced(FrozenModel):
    """The expected number comes out, as printed or once an erratum is corrected."""

    label: ClassVar[str] = "reproduced"
    kind: Literal["reproduced"] = "reproduced"
    """Ending."""
    after: str | None = Field(default=None, pattern=r"^E[0-9]+(, E[0-9]+)*$")
    """Errata that must be corrected before the number comes out, such as E4."""
    within: Tolerance
    """How near it must come."""

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether the number comes out."""
        words = f"reproduced after {self.after}" if self.after else "reproduced"
        return _judged(_within(self.within, computed, expected, unit), words)


class Regression(FrozenModel):
    """A number that this program computed: it shows that the program has changed, never that it is right."""

    label: ClassVar[str] = "regression"
    kind: Literal["regression"] = "regression"
    """Ending."""
    within: Tolerance
    """How far it may change."""
    why: str = Field(min_length=1)
    """What it watches."""

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether the number is still what it was."""
        return _judged(_within(self.within, computed, expected, unit), "regression")


class RegressionBound(Bound):
    """A bound on a number that this program computed."""

    label: ClassVar[str] = "regression"
    kind: Literal["regression_bound"] = "regression_bound"
    """Ending."""


class Outside(FrozenModel):
    """The expected number does not come out: it is missed by a known factor, with a presumed cause."""

    label: ClassVar[str] = "outside"
    kind: Literal["outside"] = "outside"
    """Ending."""
    by: float = Field(gt=0)
    """Computed over expected; of an interval, its nearer end."""
    within: float = Field(gt=0, lt=1)
    """Relative change of the factor beyond which the row has left its class."""
    why: str = Field(min_length=1)
    """Presumed cause."""

    @model_validator(mode="after")
    def _outside(self) -> Self:
        if abs(self.by - 1) <= self.within * self.by:
            words = f"a factor of {self.by:g} that may change by {self.within:g} of itself may be 1"
            raise ValueError(f"{words}, which is no deviation")
        return self

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether the deviation is the known one."""
        del unit
        factor = _number(computed, expected) / expected if expected else math.inf
        held = abs(factor - self.by) <= self.within * self.by
        return Judgement(held, f"outside by {factor:.4g}" + ("" if held else f", was {self.by:.4g}"))


class Confirmed(Bound):
    """A claim that is no number holds: the computed number lies on the claimed side of a limit."""

    label: ClassVar[str] = "confirmed"
    kind: Literal["confirmed"] = "confirmed"
    """Ending."""


class Contradicted(Bound):
    """A claim does not hold: the computed number lies on the other side of the limit that the claim sets."""

    label: ClassVar[str] = "contradicted"
    kind: Literal["contradicted"] = "contradicted"
    """Ending."""


class InsideRange(FrozenModel):
    """The expected number lies inside the interval that was computed without it; that is weaker than coming out."""

    label: ClassVar[str] = "inside a range"
    kind: Literal["inside_range"] = "inside_range"
    """Ending."""
    why: str = Field(min_length=1)
    """What spans the interval."""

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether it lies inside."""
        del unit
        held = isinstance(computed, Interval) and expected is not None and computed.low <= expected <= computed.high
        return _judged(held, "inside a range")


class Transcribed(FrozenModel):
    """An input of the thesis read back: it shows that it was copied well, and nothing else."""

    label: ClassVar[str] = "transcribed"
    kind: Literal["transcribed"] = "transcribed"
    """Ending."""
    why: str = Field(min_length=1)
    """Why nothing is computed."""

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether it comes back."""
        return _judged(_within(Tolerance(relative=READ_BACK, reason="read back"), computed, expected, unit), "transcribed")


class NotTestable(FrozenModel):
    """Nothing to compare: an experiment, a number that is left out, or one that contradicts another."""

    label: ClassVar[str] = "not testable"
    kind: Literal["not_testable"] = "not_testable"
    """Ending."""
    why: str = Field(min_length=1)
    """Why, and what is assumed in its place."""


Ending = Annotated[
    Reproduced | Regression | RegressionBound | Outside | Confirmed | Contradicted | InsideRange | Transcribed | NotTestable,
    Field(discriminator="kind"),
]
AFTER = "reproduced after an erratum"
LABELS = (
    Reproduced.label,
    AFTER,
    Confirmed.label,
    InsideRange.label,
    Outside.label,
    Contradicted.label,
    Transcribed.label,
    Regression.label,
    NotTestable.label,
)
"""The classes in which rows are counted."""


def label_of(ending: Ending) -> str:
    """The class of an ending, one of `LABELS`."""
    return AFTER if isinstance(ending, Reproduced) and ending.after else ending.label


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


def _number(computed: Computed, expected: float | None) -> float:
    """The number itself; of an interval the end nearer to what is expected."""
    return computed.nearest(expected or 0.0) if isinstance(computed, Interval) else computed


def _within(tolerance: Tolerance, computed: Computed, expected: float | None, unit: str) -> bool:
    if isinstance(computed, Interval) or expected is None:
        return False
    return abs(computed - expected) <= tolerance.allowed(expected, unit) + ROUND_OFF * abs(expected)
