"""The shipped tables that need no simulation hold, and every case of a study is valid."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tactsim.case import load_case
from tactsim.validation import compare, load_tables

SHIPPED = Path(__file__).parents[3] / "cases" / "thesis"
WITHOUT_SIMULATION = ("table_3_1", "table_3_3", "figure_3_8", "section_2_2", "section_2_3")


@pytest.mark.parametrize("name", WITHOUT_SIMULATION)
def test_shipped_tables_hold(name: str) -> None:
    loaded = load_tables(SHIPPED, [name])
    outcome = compare(name, loaded.tables[name], SHIPPED, {})
    assert loaded.faults == ()
    assert [row.row.id for row in outcome.rows if not row.held] == []
    for drawing in outcome.table.figures.values():
        json.dumps(drawing(outcome.inputs))


def test_every_shipped_table_is_counted_and_its_cases_are_valid() -> None:
    loaded = load_tables(SHIPPED)
    assert loaded.faults == ()
    for table in loaded.tables.values():
        for study in table.studies:
            cases = [load_case(SHIPPED / study.case, study.overrides(run)) for run in study.runs]
            assert len({case.case_id for case in cases}) == len(study.runs)
