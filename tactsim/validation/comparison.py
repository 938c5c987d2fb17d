"""Holds each row against what is computed: it ends as recorded, or has left its class."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from tactsim.errors import TactsimError
from tactsim.validation.endings import REPEATED, NotTestable, Regression, Reproduced, Transcribed, label_of
from tactsim.validation.inputs import Inputs
from tactsim.validation.limits import Computed, Interval
from tactsim.validation.study import RunOutcome
from tactsim.validation.table import Row, Table

LEFT = "left"
FIGURE = re.compile(r"\{([a-z0-9_.]+)(?::([1-9]))?\}")
"""A figure of a reason that the run fills in, to three digits: ``{computed}`` and ``{ratio}`` of the row itself, ``{ID}`` of
another one, ``{ID:5}`` to five."""


@dataclass(frozen=True)
class RowOutcome:
    """How a row ended."""

    row: Row
    computed: Computed | None
    """A number or an interval in SI; None if nothing was evaluated."""
    held: bool
    """Whether the row stayed in its class."""
    ended: str
    """How it ended in words, or how it left."""
    reason: str
    """Why the tolerance, the limit or the deviation is what it is, with the figures of this run."""

    @property
    def label(self) -> str:
        """The class that it ended in."""
        return self.row.label if self.held else LEFT

    @property
    def shown(self) -> float | tuple[float, float] | None:
        """What was computed, in the unit of what is expected."""
        if isinstance(self.computed, Interval):
            return self.row.shown(self.computed.low), self.row.shown(self.computed.high)
        return None if self.computed is None else self.row.shown(self.computed)

    @property
    def ratio(self) -> float | None:
        """Computed over expected; of an interval its nearer end."""
        expected = self.row.expected_si
        if self.computed is None or not expected:
            return None
        value = self.computed.nearest(expected) if isinstance(self.computed, Interval) else self.computed
        return value / expected


@dataclass(frozen=True)
class TableOutcome:
    """How a table ended."""

    name: str
    table: Table
    rows: tuple[RowOutcome, ...]
    inputs: Inputs

    @property
    def held(self) -> bool:
        """Whether every row stayed in its class."""
        return all(row.held for row in self.rows)


def compare(name: str, table: Table, folder: Path, studies: Mapping[str, tuple[RunOutcome, ...]]) -> TableOutcome:
    """Every row of a table, evaluated and compared."""
    inputs = Inputs(folder=folder, studies=studies)
    rows = [compare_row(row, inputs) for row in table.rows]
    computed = {row.row.id: row for row in rows}
    return TableOutcome(name, table, tuple(replace(row, reason=_filled(row, computed)) for row in rows), inputs)


def compare_row(row: Row, inputs: Inputs) -> RowOutcome:
    """One row, evaluated and compared; its reason as the table writes it."""
    try:
        computed = None if row.evaluate is None else row.evaluate(inputs)
    except TactsimError as error:
        return RowOutcome(row, None, False, "LEFT: cannot be evaluated", str(error))
    return judged_row(row, computed)


def judged_row(row: Row, computed: Computed | None) -> RowOutcome:
    """One row compared with what was computed for it, None if nothing was."""
    if isinstance(row.ends, NotTestable) or computed is None:
        return RowOutcome(row, None, True, label_of(row.ends), reason_of(row))
    value = computed if isinstance(computed, Interval) else float(computed)
    ends = (value.low, value.high) if isinstance(value, Interval) else (value,)
    if not all(math.isfinite(end) for end in ends):
        return RowOutcome(row, None, False, "LEFT: not a finite number", f"{computed}")
    judgement = row.ends.judge(value, row.expected_si, row.unit)
    ended = f"{judgement.ended}, {REPEATED}" if row.repeats else judgement.ended
    words = ended if judgement.held else f"LEFT: {ended}"
    return RowOutcome(row, value, judgement.held, words, reason_of(row))


def figures_of(row: Row) -> set[str]:
    """What the reason of a row lets the run fill in."""
    return {match[1] for match in FIGURE.finditer(reason_of(row))}


def reason_of(row: Row) -> str:
    """The reason of a row as its table writes it, and which row it repeats."""
    again = f"; repeats row {row.repeats}" if row.repeats else ""
    if isinstance(row.ends, Reproduced):
        return row.ends.within.reason + again
    within = row.ends.within if isinstance(row.ends, Regression | Transcribed) else None
    return row.ends.why + (f"; {within.reason}" if within else "") + again


def _filled(outcome: RowOutcome, computed: Mapping[str, RowOutcome]) -> str:
    def figure(match: re.Match[str]) -> str:
        digits = int(match[2] or 3)
        if match[1] == "ratio":
            return "?" if outcome.ratio is None else f"{outcome.ratio:.{digits}g}"
        other = outcome if match[1] == "computed" else computed.get(match[1])
        return match[0] if other is None else figure_text(other, digits)  # loading reports a name that no row has

    return FIGURE.sub(figure, outcome.reason) if outcome.held or outcome.computed is not None else outcome.reason


def figure_text(outcome: RowOutcome, digits: int = 5) -> str:
    """What was computed in words, in the unit of what is expected: ``1.4 mm`` or ``0.55 to 2.2 mm``."""
    shown, unit = outcome.shown, "" if outcome.row.unit == "1" else f" {outcome.row.shown_unit}"
    if shown is None:
        return "-"
    ends = shown if isinstance(shown, tuple) else (shown,)
    return " to ".join(f"{end:.{digits}g}" for end in ends) + unit
