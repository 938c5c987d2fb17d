"""Runs that may take so long only: what they accepted is kept, and the reason says so."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pretence import CASE_TEXT, Pretence

from tactsim.cli import main
from tactsim.deadline import check_time, seconds_left, time_limit
from tactsim.errors import OutOfTime
from tactsim.experiments.indentation.indentation_3d import Indentation3D
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.tetrahedra import block_mesh
from tactsim.results.result import Status, StepRecord
from tactsim.shipped import CASES
from tactsim.units import format_quantity


def test_every_step_heeds_the_limit():
    slow = Pretence.example().model_copy(update={"steps": 100, "pause": 0.01})
    stopped = slow.run(time_limit=0.05)
    assert (stopped.status, stopped.status.exit_code) == (Status.FAILED, 3)
    assert stopped.reason == "took longer than the 0.05 s that it was given"
    in_space = Indentation3D.example().run(None, time_limit=0.01)
    assert in_space.reason.startswith("took longer than the 0.01 s that it was given; with a larger penetration_tolerance than ")
    assert format_quantity(Indentation3D.example().tolerance, "m") in in_space.reason
    assert 1 <= len(stopped.steps) < 100
    few = slow.model_copy(update={"steps": 2})
    assert few.run(time_limit=60.0).status is Status.CONVERGED
    assert few.run().status is Status.CONVERGED


def test_a_run_without_memory_is_no_internal_error():
    def exhausted(step: StepRecord) -> None:
        np.empty((1_000_000_000, 1_000_000_000))

    result = Pretence.example().run(exhausted)
    assert (result.status, len(result.steps)) == (Status.FAILED, 1)
    assert result.reason.startswith("the memory does not suffice: take larger elements")


def test_the_time_left():
    assert seconds_left() == np.inf
    with time_limit(60.0):
        assert 50 < seconds_left() <= 60
        check_time()
        with time_limit(None):
            assert 50 < seconds_left() <= 60
    with time_limit(0.0), pytest.raises(OutOfTime):
        check_time()


def test_the_mesher_ends_with_the_run():
    pytest.importorskip("pytetwild")
    with time_limit(0.05), pytest.raises(OutOfTime, match="took longer than"):
        block_mesh((40e-3, 40e-3, 20e-3), settings=BlockMeshSettings())


def test_the_command_writes_a_failed_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "out"
    assert main(["run", str(CASES / "annulus_icf.yaml"), "--time-limit", "1s", "--out", str(out), "--quiet"]) == 3
    written = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert written["status"] == "failed"
    assert written["reason"].startswith("took longer than the 1 s that it was given")
    reported = capsys.readouterr().err
    assert "annulus_icf.yaml: failed: took longer than the 1 s that it was given" in reported
    assert reported.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [("5", "has no unit"), ("5 m", "wrong dimension"), ("0 s", "must be above 0 s"), ("soon", "not a quantity")],
)
def test_limits_that_are_no_time(start: Callable[..., subprocess.Popen[str]], tmp_path: Path, text: str, message: str):
    (tmp_path / "case.yaml").write_text(CASE_TEXT, encoding="utf-8")
    process = start("run", "case.yaml", "--time-limit", text, forked=True)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert err.startswith("error: --time-limit")
    assert message in err
