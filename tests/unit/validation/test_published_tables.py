"""The tables of published problems: complete, their cases valid, their rows end as recorded and none that is made wrong does."""

from __future__ import annotations

import json

import pytest
from thesis_tables import assert_cases_valid, shipped_tables
from wrong_rows import misjudged

from tactsim.errors import InputError
from tactsim.shipped import CASES
from tactsim.validation.execution import Task, simulated
from tactsim.validation.figures import validation_figure
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.published import (
    PrintedNumber,
    bonded_disc_ratios,
    printed_beside_course,
    printed_beside_quantities,
)
from tactsim.validation.study import RunOutcome
from tactsim.validation.table import Table

PUBLISHED = CASES / "published"
SHORT = {"code_aster": ("tube",), "closed_forms": ("inflated_tube", "creep")}
"""Studies of a few seconds."""
PRINTED = (PrintedNumber(at="1 s", quantity="number", value="2 m"),)


def inputs_of(table: Table, names: tuple[str, ...]) -> Inputs:
    """Some studies of a table, computed here."""
    studies = {
        study.name: tuple(simulated(Task(run.id, str(PUBLISHED / study.case), study.overrides(run))) for run in study.runs)
        for study in table.studies
        if study.name in names
    }
    return Inputs(folder=PUBLISHED, studies=studies)


def test_every_table_is_counted_and_its_cases_are_valid() -> None:
    assert_cases_valid("published")


@pytest.mark.parametrize("name", SHORT)
def test_rows_of_short_studies_hold_and_none_that_is_made_wrong(name: str) -> None:
    table = shipped_tables("published").tables[name]
    rows = [row for row in table.rows if getattr(row.evaluate, "study", None) in SHORT[name]]
    assert len(rows) >= 4
    inputs = inputs_of(table, SHORT[name])
    assert misjudged(rows, inputs) == ([], [])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["code_aster", "closed_forms", "ansys"])
def test_every_row_holds_and_none_that_is_made_wrong(name: str) -> None:
    table = shipped_tables("published").tables[name]
    inputs = inputs_of(table, tuple(study.name for study in table.studies))
    assert misjudged(table.rows, inputs) == ([], [])
    for drawing in table.figures.values():
        data = drawing(inputs)
        json.dumps(data, allow_nan=False)
        assert validation_figure(data).startswith(b"\x89PNG")


def outcome(name: str = "default", **quantities: float) -> RunOutcome:
    history = {"time": (0.0, 1.0, 10.0), "number": (0.0, 1.0, 3.0)}
    return RunOutcome(id=name, case_id="x", status="converged", reason="", quantities=quantities, history=history, seconds=0.0)


def test_figures_show_what_was_computed_beside_what_was_printed() -> None:
    inputs = Inputs(studies={"one": (outcome(number=2.5),)})
    common = {"title": "t", "study": "one", "run": "default", "y_axis": "y", "unit": "m"}
    (drawn,) = printed_beside_quantities(inputs, x_axis="x", x_unit="s", printed=PRINTED, **common)["panels"]
    assert [(curve["x"], curve["y"]) for curve in drawn["curves"]] == [([1.0], [2.5]), ([1.0], [2.0])]
    (drawn,) = printed_beside_course(inputs, recorded="number", printed=PRINTED, **common)["panels"]
    assert [(curve["x"], curve["y"]) for curve in drawn["curves"]] == [([1.0, 10.0], [1.0, 3.0]), ([1.0], [2.0])]
    with pytest.raises(InputError, match="has recorded no other"):
        printed_beside_course(inputs, recorded="other", printed=PRINTED, **common)
    without = Inputs(studies={"one": (outcome(),)})
    with pytest.raises(InputError, match="has no number"):
        printed_beside_quantities(without, x_axis="x", x_unit="s", printed=PRINTED, **common)


def test_the_discs_are_drawn_beside_the_exact_curve() -> None:
    studies = {"bonded": (outcome("0.0", force=1.1),), "smooth": (outcome("0.0", force=1.0),)}
    (drawn,) = bonded_disc_ratios(Inputs(studies=studies), "t", "bonded", "smooth")["panels"]
    exact, computed = drawn["curves"]
    assert (exact["y"][0], exact["y"][-1]) == (pytest.approx(1.09861, abs=5e-6), pytest.approx(1.0, abs=1e-3))
    assert (computed["x"], computed["y"]) == ([0.0], [1.1])
