"""Rows keep their recorded state or are reported to have left it."""

from __future__ import annotations

from pathlib import Path

import pytest
from thesis_tables import TABLE, write_tables

from tactsim.errors import CaseError
from tactsim.validation import RowOutcome, compare, load_tables
from tactsim.validation.limits import Interval
from tactsim.validation.report import COUNT_HEADER, Validation, count_rows
from tactsim.validation.study import RunOutcome


def outcomes(folder: Path, text: str = TABLE) -> tuple[RowOutcome, ...]:
    table = load_tables(write_tables(folder, text)).tables["small"]
    return compare("small", table, folder, {}).rows


def test_recorded_states_hold(tmp_path: Path) -> None:
    rows = outcomes(tmp_path)
    assert [row.held for row in rows] == [True, True, True]
    assert [row.ended for row in rows] == ["reproduced", "outside by 0.5", "not testable"]
    assert [row.ratio for row in rows[:2]] == pytest.approx([1.0, 0.5], rel=1e-12)  # a quotient of exact numbers
    assert rows[2].ratio is None


@pytest.mark.parametrize(
    ("old", "new", "left", "message"),
    [
        ("125 N/m", "125.4 N/m", 0, "LEFT: was reproduced"),
        ("250 N/m", "240 N/m", 1, "LEFT: outside by 0.5208, was 0.5"),
        ("250 N/m", "125 N/m", 1, "LEFT: outside by 1, was 0.5"),
    ],
)
def test_a_wrong_number_leaves(tmp_path: Path, old: str, new: str, left: int, message: str) -> None:
    rows = outcomes(tmp_path, TABLE.replace(old, new))
    assert [row.held for row in rows] == [k != left for k in range(3)]
    assert rows[left].ended == message


def test_after_an_erratum(tmp_path: Path) -> None:
    text = TABLE.replace("kind: reproduced,", "kind: reproduced, after: E4,")
    assert outcomes(tmp_path, text)[0].ended == "reproduced after E4"
    assert outcomes(tmp_path, text.replace("125 N/m", "126 N/m"))[0].ended == "LEFT: was reproduced after E4"


BRACKET = """\
schema: tactsim/thesis-table/2
title: A bracket
chapter: 3
source: nowhere
rows:
  - id: pressure
    quantity: threshold pressure
    place: line 1
    numbers: [T053]
    expected: EXPECTED
    from: thesis
    evaluate: {kind: bracket, studies: [icf], quantity: threshold_pressure}
    ends: {kind: outside, by: 30.0, within: 0.1, why: 'known: {computed:1}, {ratio} times, {runs} runs'}
  - id: runs
    quantity: runs
    place: line 2
    expected: 2.0
    from: own
    evaluate: {kind: converged_runs, study: icf}
    ends: {kind: regression, within: {absolute: 0.0, reason: a count}, why: as many as there are}
  - id: ratio
    quantity: second over first
    place: line 3
    expected: 2.0
    from: exact
    evaluate: {kind: run_ratio, run: [icf, b], over: [icf, a]}
    ends: {kind: reproduced, within: {relative: 0.001, reason: exact}}
"""


def run(name: str, pressure: float | None) -> RunOutcome:
    quantities = {} if pressure is None else {"threshold_pressure": pressure}
    status = "failed" if pressure is None else "converged"
    return RunOutcome(
        id=name, case_id=name, status=status, reason="stopped", quantities=quantities, history={}, disc_share=0.75, seconds=1
    )


@pytest.mark.parametrize(
    ("expected", "ratio"),
    [("500 Pa", 30.0), ("16 kPa", 1.0), ("80 kPa", 0.5)],  # below, inside and above 0.75 * 20 kPa to 40 kPa
)
def test_a_bracket_spans_both_areas_of_the_runs_that_converged(tmp_path: Path, expected: str, ratio: float) -> None:
    table = load_tables(write_tables(tmp_path, BRACKET.replace("EXPECTED", expected))).tables["small"]
    studies = {"icf": (run("a", 20e3), run("b", 40e3), run("c", None))}
    rows = compare("small", table, tmp_path, studies).rows
    assert rows[0].ratio == pytest.approx(ratio, rel=1e-12)  # a quotient of exact numbers
    assert [row.held for row in rows] == [ratio == 30.0, True, True]


def test_a_run_that_fails_or_is_absent_lets_its_rows_leave(tmp_path: Path) -> None:
    table = load_tables(write_tables(tmp_path, BRACKET.replace("EXPECTED", "500 Pa"))).tables["small"]
    rows = compare("small", table, tmp_path, {"icf": (run("a", 20e3), run("b", None))}).rows
    assert [row.held for row in rows] == [True, False, False]
    assert "stopped" in rows[2].reason
    assert not any(row.held for row in compare("small", table, tmp_path, {}).rows)


def test_an_interval_is_computed_without_what_it_is_compared_with(tmp_path: Path) -> None:
    text = BRACKET.replace("kind: outside, by: 30.0, within: 0.1,", "kind: inside_range,")
    studies = {"icf": (run("a", 20e3), run("b", 40e3))}
    for expected, held in (("14.9 kPa", False), ("15.1 kPa", True), ("39.9 kPa", True), ("40.1 kPa", False)):
        table = load_tables(write_tables(tmp_path, text.replace("EXPECTED", expected))).tables["small"]
        row = compare("small", table, tmp_path, studies).rows[0]
        assert (row.held, row.computed) == (held, Interval(15e3, 40e3))
        assert row.shown == pytest.approx((15.0, 40.0), rel=1e-12)  # in kPa, as what is expected


def test_the_run_fills_in_the_figures_of_a_reason(tmp_path: Path) -> None:
    table = load_tables(write_tables(tmp_path, BRACKET.replace("EXPECTED", "500 Pa"))).tables["small"]
    (row, *_) = compare("small", table, tmp_path, {"icf": (run("a", 20e3), run("b", 40e3))}).rows
    assert row.reason == "known: 2e+04 to 4e+04 Pa, 30 times, 2 runs"


def test_a_figure_that_no_row_has_is_a_fault(tmp_path: Path) -> None:
    loaded = load_tables(write_tables(tmp_path, BRACKET.replace("EXPECTED", "500 Pa").replace("{runs} runs", "{rnus} runs")))
    assert loaded.faults == ("small: the reason of pressure has a figure {rnus}, which is no row of the table",)
    studies = {"icf": (run("a", 20e3), run("b", 40e3))}
    assert "{rnus} runs" in compare("small", loaded.tables["small"], tmp_path, studies).rows[0].reason


def test_a_row_that_repeats_another_is_held_and_shown_but_not_counted_beside_it(tmp_path: Path) -> None:
    text = TABLE.replace("meant}\n", "meant}\n    repeats: stiffness\n")
    loaded = load_tables(write_tables(tmp_path, text))
    outcome = compare("small", loaded.tables["small"], tmp_path, {})
    first, again, _ = outcome.rows
    assert (first.label, again.label, again.ended) == ("reproduced", "repeated", "outside by 0.5, repeated")
    assert again.reason == "half the displacement was meant; repeats row stiffness"
    whole = dict(zip(COUNT_HEADER, count_rows(Validation(loaded, (outcome,)))[-1], strict=True))
    assert (whole["reproduced"], whole["outside"], whole["repeated"]) == (1, 0, 1)
    (left,) = [row for row in outcomes(tmp_path, text.replace("250 N/m", "240 N/m")) if not row.held]
    assert (left.row.id, left.label) == ("known", "left")


@pytest.mark.parametrize("of", ["stifness", "known"])
def test_a_row_repeats_one_that_counts(tmp_path: Path, of: str) -> None:
    text = TABLE.replace("meant}\n", f"meant}}\n    repeats: {of}\n")
    with pytest.raises(CaseError, match=f"known repeats {of}, which is no row that counts"):
        load_tables(write_tables(tmp_path, text))


@pytest.mark.parametrize(
    ("resolution", "ended"),
    [
        ("", "confirmed, above 0 N/m"),
        ("resolution: 120 N/m, ", "confirmed, above 0 N/m"),
        ("resolution: 130 N/m, ", "confirmed, above 0 N/m, unseen at a resolution of 130 N/m"),
    ],
)
def test_a_sign_says_whether_sensors_could_see_it(tmp_path: Path, resolution: str, ended: str) -> None:
    text = TABLE.replace("{kind: outside, by: 0.5, within: 0.01,", f"{{kind: confirmed, above: 0 N/m, {resolution}")
    assert outcomes(tmp_path, text)[1].ended == ended


def test_a_resolution_has_the_unit_of_the_number(tmp_path: Path) -> None:
    text = TABLE.replace("{kind: outside, by: 0.5, within: 0.01,", "{kind: confirmed, above: 0 N/m, resolution: 1 mm,")
    with pytest.raises(CaseError, match="1 mm"):
        load_tables(write_tables(tmp_path, text))


def test_what_is_transcribed_comes_back_to_round_off_or_to_the_digits_given(tmp_path: Path) -> None:
    ends = "{kind: reproduced, within: {relative: 0.001, reason: a quotient}}"
    given = "{kind: transcribed, within: {absolute: 0.5 N/m, reason: given to three digits}, why: on both sides}"
    exact = "{kind: transcribed, why: on both sides}"
    for expected, new, held in (("125.4", given, True), ("125.6", given, False), ("125.4", exact, False), ("125", exact, True)):
        row = outcomes(tmp_path, TABLE.replace("125 N/m", f"{expected} N/m").replace(ends, new))[0]
        assert (row.held, row.label) == (held, "transcribed" if held else "left")
    assert outcomes(tmp_path, TABLE.replace(ends, given))[0].reason == "on both sides; given to three digits"
