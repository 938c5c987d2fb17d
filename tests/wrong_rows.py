"""Rows of tables made wrong: each must leave its class."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from tactsim.validation.comparison import compare_row
from tactsim.validation.endings import READ_BACK, Bound, InsideRange, NotTestable, Outside, Transcribed
from tactsim.validation.inputs import Inputs
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
    elif isinstance(row.ends, Transcribed):
        other = expected * (1 + 3 * READ_BACK) or 1.0
    else:
        other = expected + 3 * (row.allowed or 1.0)
    text: Any = other if row.unit == "1" else f"{other!r} {row.unit}"
    return row.model_copy(update={"expected": text})


def left(rows: Iterable[Row], inputs: Inputs) -> list[str]:
    """Names of those rows that do not end as recorded."""
    return [row.id for row in rows if not compare_row(row, inputs).held]


def unmoved(rows: Iterable[Row], inputs: Inputs) -> list[str]:
    """Names of those rows that end as recorded although they are made wrong."""
    return [row.id for row in rows if not isinstance(row.ends, NotTestable) and compare_row(wrong(row), inputs).held]
