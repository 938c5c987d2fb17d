"""Runs that may take so long only: what they accepted is kept, and the reason says so."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from pretence import CASE_TEXT, Pretence, pretended_result

from tactsim.cli import main
from tactsim.deadline import check_time, seconds_left, time_limit
from tactsim.errors import OutOfMemory, OutOfTime
from tactsim.experiments.collecting import ended_early, run_within
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.tetrahedra import block_mesh
from tactsim.results.result import Result, Status, StepRecord

CASES = Path(__file__).parents[2] / "cases"


class Kept:
    """Collects steps."""

    def __init__(self) -> None:
        self.steps: list[StepRecord] = []

    def path(self, end: Exception) -> Iterator[StepRecord]:
        """Two steps, then an error."""
        for number in (1, 2):
            self.steps.append(StepRecord(number, 3, 1e-11, {"displacement": 1e-4 * number}))
            yield self.steps[-1]
        raise end

    def result(self, status: Status, reason: str) -> Result:
        """What was collected."""
        return pretended_result(status, reason, tuple(self.steps))


@pytest.mark.parametrize(
    ("end", "reason"),
    [
        (
            OutOfTime("took longer than the 5 s that it was given"),
            "took longer than the 5 s that it was given",
        ),
        (MemoryError(), "the memory does not suffice: take larger elements"),
        (OutOfMemory("the memory does not suffice for a factor"), "the memory does not suffice for a factor"),
    ],
)
def test_a_run_out_of_time_or_memory_keeps_what_it_accepted(end: Exception, reason: str):
    kept = Kept()
    result = ended_early(kept, kept.path(end), lambda step: None)
    assert result is not None
    assert result.status is Status.FAILED
    assert result.status.exit_code == 3
    assert result.reason.startswith(reason)
    assert len(result.steps) == 2


def test_every_step_heeds_the_limit():
    slow = Pretence.example().model_copy(update={"steps": 100, "pause": 0.01})
    with pytest.raises(OutOfTime, match=r"took longer than the 0\.05 s"):
        run_within(0.05, slow, lambda step: None)
    assert run_within(60.0, slow.model_copy(update={"steps": 2}), lambda step: None).status is Status.CONVERGED
    assert run_within(None, slow.model_copy(update={"steps": 2}), lambda step: None).status is Status.CONVERGED


def test_a_run_without_memory_is_no_internal_error():
    def exhausted(step: StepRecord) -> None:
        np.empty((1_000_000_000, 1_000_000_000))

    with pytest.raises(OutOfMemory, match="the memory does not suffice: take larger elements"):
        run_within(None, Pretence.example(), exhausted)


def test_the_time_left():
    assert seconds_left() == np.inf
    with time_limit(60.0):
        assert 50 < seconds_left() <= 60
        check_time()
    with time_limit(0.0), pytest.raises(OutOfTime):
        check_time()


def test_the_mesher_ends_with_the_run():
    pytest.importorskip("pytetwild")
    with time_limit(0.05), pytest.raises(OutOfTime, match="took longer than"):
        block_mesh((40e-3, 40e-3, 20e-3), settings=BlockMeshSettings())


def test_the_command_writes_a_failed_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "out"
    assert main(["run", str(CASES / "annulus_icf.yaml"), "--time-limit", "1s", "--out", str(out), "--quiet"]) == 3
    found = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert found["status"] == "failed"
    assert found["reason"].startswith("took longer than the 1 s that it was given")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("text", "message"),
    [("5", "has no unit"), ("5 m", "wrong dimension"), ("0 s", "must be above 0 s"), ("soon", "not a quantity")],
)
def test_limits_that_are_no_time(start: Callable[..., subprocess.Popen[str]], tmp_path: Path, text: str, message: str):
    (tmp_path / "case.yaml").write_text(CASE_TEXT, encoding="utf-8")
    process = start("run", "case.yaml", "--time-limit", text)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert err.startswith("error: --time-limit")
    assert message in err
