"""Simulations of studies: run once, kept, and computed again when asked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tactsim.case import load_case
from tactsim.errors import InputError, OutOfMemory, StorageError, TactsimError
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.shipped import CASES
from tactsim.validation.execution import StudyRunner, Task, simulated
from tactsim.validation.study import RunOutcome, Study

STUDY = Study.model_validate(
    {
        "name": "icf",
        "case": "annulus_icf.yaml",
        "runs": [{"id": "default"}, {"id": "stick", "set": {"experiment.contact": {"kind": "stick"}}}],
    }
)


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Identities of the cases that would have been computed: none is run, and the one that sticks is interrupted."""
    seen: list[str] = []

    def pretended(self: StudyRunner, waiting: dict[str, Task], progress: object) -> Iterator[tuple[str, RunOutcome]]:
        for case_id, task in waiting.items():
            seen.append(case_id)
            status = "interrupted" if "stick" in task.name else "converged"
            yield (
                case_id,
                RunOutcome(id=task.name, case_id=case_id, status=status, reason="", quantities={}, history={}, seconds=0),
            )

    monkeypatch.setattr(StudyRunner, "_computed", pretended)
    return seen


def run(runner: StudyRunner) -> dict[str, dict[str, tuple[RunOutcome, ...]]]:
    return dict(runner.outcomes({"one": (STUDY,), "two": (STUDY,)}, CASES, lambda line: None))


def test_equal_cases_run_once_and_what_ended_is_kept(tmp_path: Path, computed: list[str]) -> None:
    outcomes = run(StudyRunner(cache=tmp_path))
    assert [outcome.id for outcome in outcomes["one"]["icf"]] == ["default", "stick"]
    assert outcomes["one"] == outcomes["two"]
    assert computed == [load_case(CASES / STUDY.case, STUDY.overrides(one)).case_id for one in STUDY.runs]
    again = StudyRunner(cache=tmp_path)
    assert run(again) == outcomes
    assert computed[2:] == [computed[1]], "only the interrupted run is computed again"
    assert (again.computed, again.from_cache) == ({computed[1]}, {computed[0]})
    fresh = StudyRunner(cache=tmp_path, fresh=True)
    run(fresh)
    assert computed[3:] == computed[:2]
    assert (fresh.computed, fresh.from_cache) == (set(computed[:2]), set())


@pytest.mark.usefixtures("computed")
def test_what_a_validation_computed_for_one_group_is_not_called_kept_in_the_next(tmp_path: Path) -> None:
    runner = StudyRunner(cache=tmp_path)
    run(runner)
    run(runner)
    assert (len(runner.computed), runner.from_cache) == (2, set())


def test_a_broken_cache_is_ignored(tmp_path: Path, computed: list[str]) -> None:
    run(StudyRunner(cache=tmp_path))
    for path in tmp_path.iterdir():
        path.write_text("{", encoding="utf-8")
    run(StudyRunner(cache=tmp_path))
    assert len(computed) == 4


def test_a_change_of_the_code_of_the_simulations_asks_for_new_ones(
    tmp_path: Path, computed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    run(StudyRunner(cache=tmp_path))
    monkeypatch.setattr("tactsim.validation.execution.code_identity", lambda: "changed")
    run(StudyRunner(cache=tmp_path))
    assert len(computed) == 4


def test_a_refusal_on_the_way_is_an_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(self: Indentation) -> None:
        raise InputError("no mesh")

    monkeypatch.setattr(Indentation, "begin", refused)
    outcome = simulated(Task("refused", str(CASES / STUDY.case), ()))
    assert (outcome.status, outcome.reason) == ("failed", "no mesh")


@pytest.mark.parametrize("error", [StorageError("no room left"), OutOfMemory("the memory does not suffice")])
def test_what_the_machine_did_wrong_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: TactsimError) -> None:
    """A run without memory stayed failed in every later validation."""

    def stopped(self: Indentation) -> None:
        raise error

    monkeypatch.setattr(Indentation, "begin", stopped)
    outcome, runner = simulated(Task("stopped", str(CASES / STUDY.case), ())), StudyRunner(cache=tmp_path)
    assert not outcome.converged
    assert outcome.reason == str(error)
    runner._store(outcome)
    assert list(tmp_path.iterdir()) == []


def test_a_whole_number_that_a_study_sets_stays_one() -> None:
    """It was written as 2.0, which a count refuses."""
    text = '{"name": "s", "case": "c.yaml", "common": {"a.steps": 2, "b": 0.5, "c": true}, "runs": [{"id": "r"}]}'
    study = Study.model_validate_json(text, strict=True)
    assert study.overrides(study.runs[0]) == ("a.steps=2", "b=0.5", "c=true")


def test_one_simulation_is_not_reported_in_the_plural() -> None:
    def interrupting(line: str) -> None:
        raise KeyboardInterrupt(line)

    with pytest.raises(KeyboardInterrupt, match=r"^1 simulation in 1 process$"):
        next(StudyRunner(workers=2)._computed({"identity": Task("icf", "annulus_icf.yaml", ())}, interrupting))
