"""The campaign: cases are functions of seed and number, and what contradicts itself is called wrong."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest
from campaign.random_cases import all_kinds, random_case
from campaign.record import as_line, first_runs, last_runs, read_record
from campaign.report import page
from campaign.trials import PATIENCE, Ended, Trial, contradictions, judged, tried

from tactsim.case import load_case
from tactsim.case.writing import yaml_text

GOOD = {"status": "converged", "reason": "done", "quantities": {"force": {"value": 1.0}}}


@pytest.mark.parametrize("kind", ["grasp", "indentation", "film_test", "sensor_response"])
def test_a_case_is_a_function_of_seed_and_number_and_is_accepted(tmp_path: Path, kind: str) -> None:
    assert random_case(kind, 1, 5) == random_case(kind, 1, 5)
    assert len({yaml_text(random_case(kind, 1, number)) for number in range(8)}) == 8
    for number in range(8):
        path = tmp_path / f"{number}.yaml"
        path.write_text(yaml_text(random_case(kind, 2, number)), encoding="utf-8")
        assert load_case(path).experiment.kind == kind


def test_every_kind_that_needs_no_file_is_tried() -> None:
    assert {"grasp", "indentation", "indentation_3d", "timed_indentation", "boundary_value_problem"} <= set(all_kinds())


def place(folder: Path, result: dict | None, words: str = "") -> Path:
    (folder / "result").mkdir(exist_ok=True)
    (folder / "stderr").write_text(words, encoding="utf-8")
    if result is not None:
        (folder / "result" / "result.json").write_text(json.dumps(result), encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("code", "result", "words", "outcome"),
    [
        (0, GOOD, "", "converged"),
        (3, GOOD | {"status": "failed", "reason": "gave up"}, "", "failed with reason"),
        (3, GOOD | {"status": "failed", "reason": "took longer than the 60 s that it was given"}, "", "stopped by time"),
        (3, GOOD | {"status": "failed", "reason": "the threshold was not reached within 1 mm"}, "", "no threshold"),
        (2, None, "error: a word", "refused"),
        (2, None, "", "wrong"),
        (1, None, "error: internal error", "wrong"),
        (0, GOOD | {"status": "failed"}, "", "wrong"),
        (0, None, "", "wrong"),
        (0, GOOD, "Traceback (most recent call last):", "wrong"),
        (0, GOOD | {"quantities": {"force": {"value": float("inf")}}}, "", "wrong"),
    ],
)
def test_what_contradicts_itself_is_wrong(tmp_path: Path, code: int, result: dict | None, words: str, outcome: str) -> None:
    assert judged(code, place(tmp_path, result, words))[0] == outcome


def test_forces_that_do_not_add_up_are_wrong() -> None:
    forces = {"taxel_force_upper": [[1.0, 2.0]], "gap_force_upper": 0.5, "outside_force_upper": 0.25, "reaction_force": 3.75}
    assert contradictions(forces) == []
    (fault,) = contradictions(forces | {"reaction_force": 3.76})
    assert "taxels, gaps and outside of the upper jaw are 3.75 N, the reaction 3.76 N" in fault


def test_a_trial_runs_the_command_and_keeps_its_case(tmp_path: Path) -> None:
    ended = tried(Trial("film_test", 1, 0, 60.0), tmp_path)
    assert (ended.outcome, ended.number) == ("converged", 0)
    assert (tmp_path / "film_test_0" / "case.yaml").is_file()


def ended(number: int, outcome: str, kind: str = "grasp", program: str = "a") -> Ended:
    return Ended(kind, 1, number, outcome, f"because of | {number}", 2.0, 1.5, program)


def test_a_record_is_read_back_and_a_line_cut_short_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "trials.jsonl"
    assert read_record(path) == []
    path.write_text(as_line(ended(0, "converged")) + as_line(ended(1, "wrong")) + '{"kind": "gra', encoding="utf-8")
    assert read_record(path) == [ended(0, "converged"), ended(1, "wrong")]
    assert len(path.read_text(encoding="utf-8").splitlines()) == 2


def test_first_and_last_runs_of_a_case_are_kept_apart() -> None:
    record = [ended(0, "failed with reason"), ended(1, "converged"), ended(0, "converged", program="b")]
    assert first_runs(record) == record[:2]
    assert last_runs(record)["grasp", 0] == record[2]


def test_the_page_shows_shares_with_intervals_reasons_and_what_came_of_the_failed_ones() -> None:
    record = [ended(number, "converged") for number in range(9)] + [ended(9, "failed with reason"), ended(10, "refused")]
    text = page(record, asked=1000, limit=900.0, patience=30.0)
    assert "11 of 1000 asked of the kind `grasp`" in text
    assert "| grasp | 11 | 9 | 0 | 1 | 1 | 0 | 0 | 0 | 90.0 % [59.6 %, 98.2 %] |" in text  # Wilson's by hand for 9 of 10
    assert "| grasp 9 | failed with reason | 2 | because of \\| 9 |  |" in text
    assert "run again\n" not in text
    again = page([*record, ended(9, "converged", program="b")], asked=1000, limit=900.0, patience=30.0)
    assert "| grasp 9 | failed with reason | 2 | because of \\| 9 | converged |" in again
    assert "| grasp | 1 | 1 | 0 | 0 | 0 | 0 | 0 | 0 | 100.0 % [20.7 %, 100.0 %] |" in again
    assert "`b` (1 cases)" in again


def test_the_stored_page_is_that_of_the_stored_record() -> None:
    folder = Path(__file__).parents[3] / "docs" / "verification"
    text = (folder / "campaign.md").read_text(encoding="utf-8")
    assert text == page(read_record(folder / "campaign.jsonl"), asked=1000, limit=900.0, patience=PATIENCE)


def test_a_child_that_does_not_end_is_killed_and_counts_as_hung(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("campaign.trials.PATIENCE", 0.1)
    monkeypatch.setattr("campaign.trials._command", lambda *_: time.sleep(60))
    hung = tried(Trial("film_test", 1, 0, 0.1), tmp_path)
    assert hung.outcome == "hung"
    assert hung.seconds < 30
