"""The rows of the signal chain hold, and a number wrong by three tolerances does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from thesis_tables import TABLE as TABLE_OF_ROWS
from thesis_tables import write_tables

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.validation import compare, load_tables
from tactsim.validation.comparison import compare_row
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.film import filter_transfer
from tactsim.validation.table import Bound, Row

FILTER = "{kind: filter_transfer, cutoff: 40 Hz, sampling_rate: 80 Hz}"
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


def test_a_filter_that_cannot_be_sampled_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidQuantity, match="half the sampling_rate"):
        filter_transfer(cutoff=40.0, sampling_rate=80.0)
    text = TABLE_OF_ROWS.replace("{kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}", FILTER).replace(
        "125 N/m", "0.5"
    )
    with pytest.raises(CaseError, match=r"small\.yaml:10: rows\.0\.evaluate: cutoff 40 Hz of the low pass must be below half"):
        load_tables(write_tables(tmp_path, text))
