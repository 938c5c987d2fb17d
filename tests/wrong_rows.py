"""Rows of tables made wrong: each must leave its class."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from tactsim.validation.comparison import compare_row, judged_row
from tactsim.validation.endings import InsideRange, Outside
from tactsim.validation.inputs import Inputs
from tactsim.validation.limits import Bound
from tactsim.validation.table import Row


def wrong(row: Row) -> Row:
    """The row with its limit on the other side, or with an expected number that is wrong by three tolerances."""
    if isinstance(row.ends, Bound):
        turned = row.ends.model_copy(update={"above": row.ends.below, "below": row.ends.above})
        return row.model_copy(update={"ends": turned})
    expected = row.expected_si or 0.0
    if isinstance(row.ends, Outside):
        other = expected * (1 + 3 * row.ends.within)
    elif isinstance(row.ends, InsideRange):
        other = expected * 1e6
    else:
        other = expected + 3 * (row.allowed or 1.0)
    text: Any = other if row.unit == "1" else f"{other!r} {row.unit}"
    return row.model_copy(update={"expected": text})


def misjudged(rows: Iterable[Row], inputs: Inputs) -> tuple[list[str], list[str]]:
    """Names of those rows that do not end as recorded, and of those that do although they are made wrong.

    Each is evaluated once: to make it wrong changes what is expected, not what is computed.
    """
    outcomes = [compare_row(row, inputs) for row in rows]
    left = [outcome.row.id for outcome in outcomes if not outcome.held]
    evaluated = [outcome for outcome in outcomes if outcome.computed is not None]
    return left, [outcome.row.id for outcome in evaluated if judged_row(wrong(outcome.row), outcome.computed).held]
