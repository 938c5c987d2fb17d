"""How a row of a table ends: a class for every ending, which judges what was computed."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tactsim.model import FrozenModel
from tactsim.validation.limits import Bound, Computed, Interval, Judgement, Tolerance, is_within, judged, number_of

Origin = Literal["thesis", "erratum", "exact", "published", "other_program", "own"]
"""Where the expected number or the claim comes from: the thesis prints it, the errata derive it, a closed form gives it, another
author published it, another program computed it, or this program did and the row only watches that it does not change."""
READ_BACK = 1e-6
"""Largest relative difference of an input that is read back: some are results of fits, which are known no better."""


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
        return judged(is_within(self.within, computed, expected, unit), words)


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
        return judged(is_within(self.within, computed, expected, unit), "regression")


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
        factor = number_of(computed, expected) / expected if expected else math.inf
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
        return judged(held, "inside a range")


class Transcribed(FrozenModel):
    """An input of the thesis, or one equation of it with the same inputs on both sides, read back: it shows that it was copied
    well, and nothing else."""

    label: ClassVar[str] = "transcribed"
    kind: Literal["transcribed"] = "transcribed"
    """Ending."""
    within: Tolerance | None = None
    """How near it must come if what is expected is given to few digits; by default `READ_BACK`."""
    why: str = Field(min_length=1)
    """Why nothing is found out."""

    @property
    def allowance(self) -> Tolerance:
        """How near it must come."""
        return self.within or Tolerance(relative=READ_BACK, reason="read back")

    def judge(self, computed: Computed, expected: float | None, unit: str) -> Judgement:
        """Whether it comes back."""
        return judged(is_within(self.allowance, computed, expected, unit), "transcribed")


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
REPEATED = "repeated"
"""The class of a row that says again what another one says."""
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
    REPEATED,
)
"""The classes in which rows are counted."""


def label_of(ending: Ending) -> str:
    """The class of an ending, one of `LABELS`."""
    return AFTER if isinstance(ending, Reproduced) and ending.after else ending.label
