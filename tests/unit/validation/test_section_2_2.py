"""The rows of the signal chain hold, and a number wrong by three tolerances does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tactsim.errors import InvalidQuantity
from tactsim.validation import compare, load_tables
from tactsim.validation.comparison import compare_row
from tactsim.validation.evaluator import Inputs
from tactsim.validation.evaluators.filter_transfer import FilterTransfer
from tactsim.validation.table import Bound, Row

SHIPPED = Path(__file__).parents[3] / "cases" / "thesis"
TABLE = load_tables(SHIPPED, ["section_2_2"]).tables["section_2_2"]


def test_every_row_holds() -> None:
    assert [row.row.id for row in compare("section_2_2", TABLE, SHIPPED, {}).rows if not row.held] == []


@pytest.mark.parametrize("row", [row for row in TABLE.rows if row.tolerance is not None], ids=lambda row: row.id)
def test_a_number_wrong_by_three_tolerances_is_noticed(row: Row) -> None:
    assert row.expected is not None
    wrong = row.expected + 3 * (row.allowed or 0)
    printed: Any = wrong if row.unit == "1" else f"{wrong!r} {row.unit}"
    assert not compare_row(row.model_copy(update={"printed": printed}), Inputs()).held


@pytest.mark.parametrize("row", [row for row in TABLE.rows if isinstance(row.state, Bound)], ids=lambda row: row.id)
def test_a_finding_on_the_wrong_side_is_noticed(row: Row) -> None:
    assert isinstance(row.state, Bound)
    turned = row.state.model_copy(update={"above": row.state.below, "below": row.state.above})
    assert not compare_row(row.model_copy(update={"state": turned}), Inputs()).held


def test_a_filter_that_cannot_be_sampled_is_refused() -> None:
    with pytest.raises((InvalidQuantity, ValueError), match="half the sampling_rate"):
        FilterTransfer(cutoff=40.0, sampling_rate=80.0)
