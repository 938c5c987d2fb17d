"""The campaign: cases are functions of seed and number, and what contradicts itself is called wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from campaign.random_cases import all_kinds, random_case
from campaign.trials import Trial, contradictions, judged, tried

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
