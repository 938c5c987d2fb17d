"""The rows of Appendix A and section 6.3 hold, and a number wrong by three tolerances does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tactsim.errors import InputError
from tactsim.validation import compare, load_tables
from tactsim.validation.comparison import compare_row
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.views import section_value
from tactsim.validation.table import Bound, OutsideBy, Row

SHIPPED = Path(__file__).parents[3] / "cases" / "thesis"
NAMES = ("appendix_a", "section_6_3")
TABLES = load_tables(SHIPPED, NAMES).tables
ROWS = [row for table in TABLES.values() for row in table.rows]


@pytest.mark.parametrize("name", NAMES)
def test_every_row_holds(name: str) -> None:
    assert [row.row.id for row in compare(name, TABLES[name], SHIPPED, {}).rows if not row.held] == []


@pytest.mark.parametrize("row", [row for row in ROWS if row.tolerance is not None], ids=lambda row: row.id)
def test_a_number_wrong_by_three_tolerances_is_noticed(row: Row) -> None:
    assert row.expected is not None
    wrong: Any = row.expected + 3 * (row.allowed or 0)
    assert not compare_row(row.model_copy(update={"printed": wrong}), Inputs()).held


@pytest.mark.parametrize("row", [row for row in ROWS if isinstance(row.state, Bound)], ids=lambda row: row.id)
def test_a_finding_on_the_wrong_side_is_noticed(row: Row) -> None:
    assert isinstance(row.state, Bound)
    turned = row.state.model_copy(update={"above": row.state.below, "below": row.state.above})
    assert not compare_row(row.model_copy(update={"state": turned}), Inputs()).held


@pytest.mark.parametrize("row", [row for row in ROWS if isinstance(row.state, OutsideBy)], ids=lambda row: row.id)
def test_another_deviation_is_noticed(row: Row) -> None:
    assert isinstance(row.state, OutsideBy)
    other = row.state.model_copy(update={"outside_by": row.state.outside_by * (1 + 3 * row.state.tolerance)})
    assert not compare_row(row.model_copy(update={"state": other}), Inputs()).held


def test_a_pixel_beyond_the_picture_is_refused() -> None:
    with pytest.raises(InputError, match="pixel"):
        section_value(pixel=(6, 1))
