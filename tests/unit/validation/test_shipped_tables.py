"""Rows of the shipped tables that need no long simulation hold, and none that is made wrong does; every case is valid."""

from __future__ import annotations

import json
from copy import deepcopy
from functools import cache

import pytest
from thesis_tables import assert_cases_valid, shipped_tables
from wrong_rows import misjudged

from tactsim.case import loading
from tactsim.shipped import CASES
from tactsim.validation.endings import Confirmed, Contradicted, Regression, RegressionBound, Reproduced, Transcribed
from tactsim.validation.execution import Task, simulated
from tactsim.validation.figures import validation_figure
from tactsim.validation.inputs import Inputs
from tactsim.validation.table import Table

SHIPPED = CASES / "thesis"
WITHOUT_SIMULATION = (
    "section_2_2", "table_3_1", "table_3_3", "figure_3_8", "equation_4_2_21", "section_4_4", "table_4_1",
    "equation_4_6_4", "equation_4_7_1", "equation_4_7_2", "section_4_7", "section_6_3", "appendix_a",
)  # fmt: skip
SHORT_SIMULATIONS = ("section_2_3", "section_3_1_2")
"""Tables whose studies take a second: film and electronics."""


def inputs_of(table: Table) -> Inputs:
    """The studies of a table, computed here."""
    studies = {
        study.name: tuple(simulated(Task(run.id, str(SHIPPED / study.case), study.overrides(run))) for run in study.runs)
        for study in table.studies
    }
    return Inputs(folder=SHIPPED, studies=studies)


SEARCH = "chapter_7"
"""A table that presses the tip of a catheter in thousands of places."""


@pytest.mark.parametrize("name", [*WITHOUT_SIMULATION, *SHORT_SIMULATIONS, pytest.param(SEARCH, marks=pytest.mark.slow)])
def test_every_row_holds_and_none_that_is_made_wrong(name: str) -> None:
    table = shipped_tables("thesis").tables[name]
    assert bool(table.studies) == (name in (*SHORT_SIMULATIONS, SEARCH))
    inputs = inputs_of(table)
    assert misjudged(table.rows, inputs) == ([], [])
    for drawing in table.figures.values():
        json.dumps(drawing(inputs), allow_nan=False)


def test_bands_and_sections_are_drawn() -> None:
    table = shipped_tables("thesis").tables["appendix_a"]
    for drawing in table.figures.values():
        assert validation_figure(drawing(Inputs())).startswith(b"\x89PNG")


def test_every_shipped_table_is_counted_and_its_cases_are_valid(monkeypatch: pytest.MonkeyPatch) -> None:
    read = cache(loading._read_file)  # most runs change the case of another
    monkeypatch.setattr(loading, "_read_file", lambda path: deepcopy(read(path)))
    assert_cases_valid("thesis")


def test_a_step_towards_a_jaw_is_confirmed_where_the_force_rises_there_and_falls_at_the_other() -> None:
    """Section 6.6: what comes nearer to a surface raises the pressure there "as opposed to the other"."""
    steps = [
        row
        for row in shipped_tables("thesis").tables["section_6_6"].rows
        if isinstance(row.ends, Confirmed | Contradicted) and str(getattr(row.evaluate, "change", "")).endswith("along")
    ]
    assert len(steps) >= 10
    for row in steps:
        as_claimed = "above" if row.evaluate.side == "upper" else "below"
        opposite = {"above": "below", "below": "above"}[as_claimed]
        assert row.ends.limit.split()[0] == (as_claimed if isinstance(row.ends, Confirmed) else opposite), row.id


def test_what_is_found_again_from_data_that_were_made_of_it_is_no_reproduction() -> None:
    """The line of 3.1.2 comes back through divider and fit, the lines of 2.3.1 through creep curves, a rate through switches, and
    numbers of 4.7.2 by rules of rounding: no data are printed, and no rule."""
    tables = ("section_2_2", "section_2_3", "chapter_5", "equation_4_7_2")
    rows = [row for name in tables for row in shipped_tables("thesis").tables[name].rows if row.evaluate]
    found = [row for row in rows if row.evaluate.kind == "recovered_line" or getattr(row.evaluate, "study", "") == "creep"]
    assert len(found) == 5
    rates = [row for row in rows if row.evaluate.kind == "switch_mean_rate" and row.evaluate.formula == "corrected"]
    ruled = [row for row in rows if getattr(row.evaluate, "as_written", False) or getattr(row.evaluate, "truncated_parts", False)]
    assert (len(rates), len(ruled)) == (3, 3)
    found += [*rates, *ruled]
    assert {(row.origin, type(row.ends)) for row in found} == {("own", Regression)}


def test_all_221_numbers_have_a_row_and_all_29_errata_words() -> None:
    manifest = shipped_tables("thesis").manifest
    assert list(manifest.numbers) == [f"T{number:03}" for number in range(1, 222)]
    assert list(manifest.errata) == [f"E{number}" for number in range(1, 30)]


@pytest.mark.parametrize("number", ["T040", "T051", "T139", "T176"])
def test_a_number_that_something_computed_bears_on_has_a_row_that_is_computed(number: str) -> None:
    """Resolution, linear range, objective and times of the switches: each had only words, or an input that came back."""
    rows = [row for table in shipped_tables("thesis").tables.values() for row in table.rows if number in row.numbers]
    assert any(row.evaluate is not None and getattr(row.evaluate, "kind", "") != "switch_mean_rate" for row in rows)


FLATTERING = {
    "quotients of two printed numbers": (lambda row: row.evaluate.kind == "quotient", Transcribed, 3),
    "sums of two inputs": (lambda row: getattr(row.evaluate, "number", "") == "largest", Transcribed, 2),
    "symmetry of a symmetric block": (lambda row: row.evaluate.kind == "taxel_asymmetry", RegressionBound, 6),
    "proportion in a linear theory": (lambda row: row.evaluate.kind == "ratio_effect", RegressionBound, 1),
    "the stable sets of this library": (lambda row: row.id.partition(".")[2] in ("stable_max", "stable_rms"), RegressionBound, 4),
}
"""What cannot fail, or says nothing of the thesis: which rows, how they end, and how many there are."""


@pytest.mark.parametrize("what", FLATTERING)
def test_what_cannot_fail_or_says_nothing_of_the_thesis_is_not_counted_for_it(what: str) -> None:
    chosen, ending, number = FLATTERING[what]
    rows = [row for table in shipped_tables("thesis").tables.values() for row in table.rows if row.evaluate and chosen(row)]
    assert [type(row.ends) for row in rows] == number * [ending]


def test_one_tissue_pressed_faster_confirms_nothing() -> None:
    """Passive tissue hardens with the rate whatever it is (E26): no row that compares one tissue with itself is confirmed."""
    every = shipped_tables("thesis").tables["chapter_5"].rows
    rows = [row for row in every if getattr(row.evaluate, "kind", "") == "probe_force_ratio"]
    same = [row for row in rows if row.evaluate.press.tissue == row.evaluate.over.tissue]
    assert len(same) >= 4
    assert not any(isinstance(row.ends, Confirmed) for row in same)


@pytest.mark.parametrize("name", ["appendix_a", "section_6_3"])
def test_what_is_worked_out_of_equations_is_not_printed(name: str) -> None:
    """Bands, sections and views have equations and no example: all but the ends of the scale of 256 levels."""
    rows = [row for row in shipped_tables("thesis").tables[name].rows if isinstance(row.ends, Reproduced)]
    assert {row.id for row in rows if row.origin == "thesis"} <= {"level_full", "level_beyond"}
