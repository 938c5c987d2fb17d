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
from tactsim.validation.comparison import reason_of
from tactsim.validation.endings import (
    Confirmed,
    Contradicted,
    InsideRange,
    Outside,
    Regression,
    RegressionBound,
    Reproduced,
    Transcribed,
)
from tactsim.validation.execution import Task, simulated
from tactsim.validation.figures import validation_figure
from tactsim.validation.inputs import Inputs
from tactsim.validation.table import Row, Table

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


LONG = "objective_forms"
"""A number of ten searches, of which those of ``test_chapter_4.py`` are two."""
SEARCH = "chapter_7"
"""A table that presses the tip of a catheter in thousands of places."""


@pytest.mark.parametrize("name", [*WITHOUT_SIMULATION, *SHORT_SIMULATIONS, pytest.param(SEARCH, marks=pytest.mark.slow)])
def test_every_row_holds_and_none_that_is_made_wrong(name: str) -> None:
    table = shipped_tables("thesis").tables[name]
    assert bool(table.studies) == (name in (*SHORT_SIMULATIONS, SEARCH))
    inputs = inputs_of(table)
    assert misjudged([row for row in table.rows if not _is_long(row)], inputs) == ([], [])
    for drawing in table.figures.values():
        json.dumps(drawing(inputs), allow_nan=False)


@pytest.mark.slow
def test_rows_of_long_searches_hold_and_none_that_is_made_wrong() -> None:
    long = [row for name in WITHOUT_SIMULATION for row in shipped_tables("thesis").tables[name].rows if _is_long(row)]
    assert len(long) == 1
    assert misjudged(long, Inputs()) == ([], [])


def _is_long(row: Row) -> bool:
    return row.evaluate is not None and row.evaluate.kind == LONG


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


def thesis_rows() -> list[tuple[str, Row]]:
    """Every row of the thesis's tables beside the name of its table."""
    return [(name, row) for name, table in shipped_tables("thesis").tables.items() for row in table.rows]


PROVING = (Reproduced, Outside, Confirmed, Contradicted, InsideRange)
"""Endings that say something of the thesis."""
ONE_EQUATION = (
    "annular_area", "atrial_time_group", "band_level", "band_number", "calibrated_resistance", "creep_coefficient",
    "film_constant", "film_strain", "hertz_durometer_modulus", "initial_modulus", "kelvin_unit_compliance", "lump_row",
    "section_value", "slow_creep", "top_view_rows", "view_output",
)  # fmt: skip
"""Numbers that are one equation of the thesis and no more."""


def test_one_equation_with_the_same_inputs_on_both_sides_reproduces_nothing() -> None:
    rows = [(name, row) for name, row in thesis_rows() if row.evaluate and row.evaluate.kind in ONE_EQUATION]
    assert {row.evaluate.kind for _, row in rows if isinstance(row.ends, Transcribed)} == set(ONE_EQUATION)
    assert [(name, row.id) for name, row in rows if isinstance(row.ends, Reproduced)] == []


def test_what_is_reproduced_would_not_be_by_a_number_a_tenth_off() -> None:
    """0.0085 N were accepted for a printed 0.01 N with room for half as much again."""
    wide = [(name, row.id) for name, row in thesis_rows() if isinstance(row.ends, Reproduced) and _accepts_a_tenth(row)]
    assert wide == []


def _accepts_a_tenth(row: Row) -> bool:
    return bool(row.expected_si) and (row.allowed or 0.0) > 0.1 * abs(row.expected_si)


LINEAR = {
    "annulus_creep": ("force", "compliance"),
    "bracket": ("area",),
    "dynamic_coefficient": ("amplitude",),
}
"""What is in proportion to an input: a row with another one is a multiple, and says nothing more."""
ALIKE = {"force_to_touch": "rise", "displacement_over_radius": "displacement"}
"""Numbers that another one gives by a product of inputs."""


def test_no_fact_is_counted_twice() -> None:
    """The same call counts again only against another number that the thesis prints."""
    facts: dict[str, list[Row]] = {}
    for name, row in thesis_rows():
        if row.repeats is None and isinstance(row.ends, PROVING):
            facts.setdefault(_fact(name, row), []).append(row)
    twice = {fact: rows for fact, rows in facts.items() if len({str(row.expected) for row in rows}) < len(rows)}
    assert [[row.id for row in rows] for rows in twice.values()] == []
    assert [
        [row.id for row in rows] for rows in facts.values() if len(rows) > 1 and {row.origin for row in rows} != {"thesis"}
    ] == []


def _fact(table: str, row: Row) -> str:
    """The call of a row without the inputs to which its number is in proportion."""
    assert row.evaluate is not None
    call = row.evaluate.model_dump(mode="json")
    kept = {key: ALIKE.get(str(value), value) for key, value in call.items() if key not in LINEAR.get(call["kind"], ())}
    studied = table if "study" in call or "studies" in call or "run" in call else ""
    return json.dumps([studied, kept], sort_keys=True)


@pytest.mark.parametrize("kind", ["annulus_creep", "dynamic_coefficient"])
def test_multiples_of_a_number_are_not_counted_beside_it(kind: str) -> None:
    calls = [
        _fact(name, row)
        for name, row in thesis_rows()
        if row.repeats is None and isinstance(row.ends, PROVING) and row.evaluate and row.evaluate.kind == kind
    ]
    assert len(set(calls)) == len(calls) > 1


def test_mirror_images_and_two_sides_of_a_bound_count_once() -> None:
    rows = {row.id: row for row in shipped_tables("thesis").tables["section_6_6"].rows}
    again = ("picture.two_lumps.lower", "picture.two_arteries.lower", "picture.equal_mirrored")
    assert [rows[name].repeats for name in again] == ["picture.two_lumps.upper", "picture.two_arteries.upper", "picture.equal"]


def test_every_sign_of_section_6_6_says_whether_sensors_of_a_tenth_of_a_newton_could_see_it() -> None:
    rows = [row for row in shipped_tables("thesis").tables["section_6_6"].rows if isinstance(row.ends, Confirmed | Contradicted)]
    signs = [row for row in rows if row.ends.limit.split()[1] == "0"]
    assert len(signs) >= 40
    assert {row.ends.resolution for row in signs} == {"0.1 N"}


@pytest.mark.parametrize("name", ["chapter_5", "chapter_7"])
def test_what_is_confirmed_on_tissues_of_ours_says_that_they_are_chosen(name: str) -> None:
    confirmed = [row for row in shipped_tables("thesis").tables[name].rows if isinstance(row.ends, Confirmed)]
    assert confirmed
    assert [row.id for row in confirmed if "tissues are chosen" not in reason_of(row)] == []


def test_one_place_that_is_chosen_here_confirms_nothing_of_the_tip() -> None:
    """Section 7.3 claims it of the tip: what holds at the place of the case is watched, what is claimed is held over places."""
    rows = [row for row in shipped_tables("thesis").tables["chapter_7"].rows if isinstance(row.ends, PROVING)]
    assert {row.evaluate.kind for row in rows} == {"catheter_search"}
