"""Holds each row against what is computed: it keeps its recorded state, or has left it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from tactsim.errors import TactsimError
from tactsim.validation.inputs import Inputs
from tactsim.validation.study import RunOutcome
from tactsim.validation.table import Assumption, Bound, OutsideBy, ReproducedAfter, Row, Table


@dataclass(frozen=True)
class RowOutcome:
    """How a row ended."""

    row: Row
    computed: float | None
    """In SI; None if nothing was evaluated."""
    held: bool
    """Whether the row kept its recorded state."""
    state: str
    """The state in words, or how it was left."""
    reason: str
    """Why the tolerance, the deviation or the assumption is what it is."""

    @property
    def ratio(self) -> float | None:
        """Computed over printed."""
        expected = self.row.expected if self.row.evaluate else None
        return None if self.computed is None or not expected else self.computed / expected


@dataclass(frozen=True)
class TableOutcome:
    """How a table ended."""

    name: str
    table: Table
    rows: tuple[RowOutcome, ...]
    inputs: Inputs

    @property
    def held(self) -> bool:
        """Whether every row kept its recorded state."""
        return all(row.held for row in self.rows)


def compare(name: str, table: Table, folder: Path, studies: Mapping[str, tuple[RunOutcome, ...]]) -> TableOutcome:
    """Every row of a table, evaluated and compared."""
    inputs = Inputs(folder=folder, studies=studies)
    return TableOutcome(name, table, tuple(compare_row(row, inputs) for row in table.rows), inputs)


def compare_row(row: Row, inputs: Inputs) -> RowOutcome:
    """One row, evaluated and compared."""
    computed: float | None = None
    if row.evaluate is not None:
        try:
            computed = float(row.evaluate(replace(inputs, expected=row.expected)))
        except TactsimError as error:
            return RowOutcome(row, None, False, "LEFT: cannot be evaluated", str(error))
        if not math.isfinite(computed):
            return RowOutcome(row, None, False, "LEFT: not a finite number", f"{computed}")
    if isinstance(row.state, Assumption):
        return RowOutcome(row, computed, True, "assumption", row.state.assumption)
    if computed is None:  # the validation of a row lets only an assumption lack it
        return RowOutcome(row, None, False, "LEFT: nothing to evaluate", "")
    if isinstance(row.state, Bound):
        return _finding(row, row.state, computed)
    return _deviation(row, row.state, computed) if isinstance(row.state, OutsideBy) else _reproduction(row, computed)


def _reproduction(row: Row, computed: float) -> RowOutcome:
    expected, allowed = row.expected or 0.0, row.allowed or 0.0
    # Computed and expected may be the same number by two roundings.
    held = abs(computed - expected) <= allowed + 1e-12 * abs(expected)
    after = f" after {row.state.reproduced_after}" if isinstance(row.state, ReproducedAfter) else ""
    text = f"reproduced{after}"
    return RowOutcome(row, computed, held, text if held else f"LEFT: was {text}", row.tolerance.reason if row.tolerance else "")


def _deviation(row: Row, state: OutsideBy, computed: float) -> RowOutcome:
    factor = computed / row.expected if row.expected else math.inf
    held = abs(factor - state.outside_by) <= state.tolerance * state.outside_by
    text = f"outside by {factor:.4g}"
    return RowOutcome(row, computed, held, text if held else f"LEFT: {text}, was {state.outside_by:.4g}", state.reason)


def _finding(row: Row, state: Bound, computed: float) -> RowOutcome:
    side, limit = ("above", state.above) if state.above is not None else ("below", state.below)
    held = state.margin(computed, row.unit) > 0
    text = f"{side} {limit}"
    return RowOutcome(row, computed, held, text if held else f"LEFT: was {text}", state.finding)
