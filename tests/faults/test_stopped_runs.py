"""Signals, closed pipes, kills and runs that meet.

What the interpreter has a part in, from its start to its end, is tried with processes of their own; the others are forked.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from fork_server import forked_pretended_command
from pretence import CASE_TEXT

import tactsim
from tactsim.results import read_result

Start = Callable[..., subprocess.Popen[str]]
SLOW = ("--progress", "--set", "experiment.steps=2000", "--set", "experiment.pause=20 ms")


@pytest.fixture(autouse=True)
def case(tmp_path: Path) -> None:
    (tmp_path / "case.yaml").write_text(CASE_TEXT, encoding="utf-8")


def completed(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """The command line with the pretended experiment, forked from a process that has loaded it."""
    command = [*forked_pretended_command(), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)


def wait_for_a_step(process: subprocess.Popen[str]) -> None:
    assert process.stderr is not None
    assert process.stderr.readline().startswith("step")


def status(folder: Path) -> str:
    return str(json.loads((folder / "result.json").read_text(encoding="utf-8"))["status"])


@pytest.mark.parametrize(("number", "forked"), [(signal.SIGINT, False), (signal.SIGTERM, True), (signal.SIGHUP, True)])
def test_a_signal_writes_what_was_accepted(start: Start, tmp_path: Path, number: signal.Signals, forked: bool) -> None:
    process = start("run", "case.yaml", *SLOW, forked=forked)
    wait_for_a_step(process)
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert out.splitlines()[-1].startswith("interrupted; the steps counted before are kept; ")
    assert status(tmp_path / "results/case") == "interrupted"
    assert len(read_result(tmp_path / "results/case").result.steps) >= 1
    assert os.listdir(tmp_path / "results") == ["case"]


def test_a_second_signal_stops_at_once(start: Start, tmp_path: Path) -> None:
    process = start("run", "case.yaml", *SLOW, "--set", "experiment.stubborn=true", forked=True)
    wait_for_a_step(process)
    process.send_signal(signal.SIGINT)
    time.sleep(0.5)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode == 130
    assert not (tmp_path / "results/case").exists()


def test_an_interrupted_run_does_not_lose_the_earlier_result(start: Start, tmp_path: Path) -> None:
    completed(tmp_path, "run", "case.yaml")
    assert status(tmp_path / "results/case") == "converged"
    process = start("run", "case.yaml", *SLOW, forked=True)
    wait_for_a_step(process)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert status(tmp_path / "results/case") == "interrupted"
    assert status(tmp_path / "results/case.earlier") == "converged"


def test_a_kill_leaves_nothing_that_stops_the_next_run(start: Start, tmp_path: Path) -> None:
    process = start("run", "case.yaml", *SLOW, forked=True)
    wait_for_a_step(process)
    process.kill()
    process.communicate(timeout=60)
    assert not (tmp_path / "results/case").exists()
    done = completed(tmp_path, "run", "case.yaml")
    assert done.stderr == ""
    assert done.returncode == 0
    assert os.listdir(tmp_path / "results") == ["case"]


def test_two_runs_in_one_folder(start: Start, tmp_path: Path) -> None:
    first = start("run", "case.yaml", *SLOW, forked=True)
    wait_for_a_step(first)
    second = completed(tmp_path, "run", "case.yaml")
    assert second.returncode == 5
    assert second.stderr.startswith("error: the output folder results/case is in use by another run")
    first.send_signal(signal.SIGTERM)
    first.communicate(timeout=60)
    assert status(tmp_path / "results/case") == "interrupted"


@pytest.mark.parametrize(("stream", "forked"), [("stdout", False), ("stderr", True)])
def test_a_reader_that_goes_away_does_not_stop_the_run(start: Start, tmp_path: Path, stream: str, forked: bool) -> None:
    process = start("run", "case.yaml", "--progress", "--set", "experiment.steps=500", forked=forked)
    getattr(process, stream).close()
    setattr(process, stream, None)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "Broken" not in (err or "")
    assert status(tmp_path / "results/case") == "converged"


@pytest.mark.parametrize(("closed", "forked"), [(1, False), (2, True)])
def test_a_stream_closed_before_the_start_is_no_error(start: Start, tmp_path: Path, closed: int, forked: bool) -> None:
    process = start("run", "case.yaml", "--progress", forked=forked, preexec_fn=lambda: os.close(closed))
    process.communicate(timeout=60)
    assert process.returncode == 0
    assert status(tmp_path / "results/case") == "converged"


def test_the_head_of_a_long_answer(start: Start) -> None:
    process = start("schema", forked=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "{\n"
    process.stdout.close()
    assert process.wait(60) == 0
    assert process.stderr is not None
    assert process.stderr.read() == ""
    process.stderr.close()


def test_a_closed_terminal_does_not_lose_the_result(start: Start, tmp_path: Path) -> None:
    pty = pytest.importorskip("pty")
    master, slave = pty.openpty()
    process = start("run", "case.yaml", *SLOW, stdout=slave, stderr=slave, stdin=slave, start_new_session=True)
    os.close(slave)
    assert os.read(master, 4).startswith(b"step")  # a terminal gets the steps without being asked
    os.close(master)
    process.send_signal(signal.SIGHUP)
    assert process.wait(60) == 130
    assert status(tmp_path / "results/case") == "interrupted"


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["run", "case.yaml"], 0),
        (["run", "case.yaml", "--set", "experiment.friction=9"], 2),
        (["run", "case.yaml", "--set", "experiment.fail_at=1"], 3),
        (["run", "missing.yaml"], 5),
        (["run", "case.yaml", "--out", "case.yaml"], 5),
        (["unknown"], 2),
    ],
)
def test_the_table_of_exit_codes(tmp_path: Path, arguments: list[str], code: int) -> None:
    assert completed(tmp_path, *arguments).returncode == code


def test_an_answer_lost_on_a_full_disk_is_told() -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        told = subprocess.run(
            [sys.executable, "-P", "-m", "tactsim", "list", "tables"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert told.stderr.startswith("error: cannot write all of the answer to standard output: No space left on device")
    assert told.returncode == 5


@pytest.mark.parametrize("safe", [True, False])
def test_a_working_folder_that_is_gone_is_told(tmp_path: Path, safe: bool) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    command = [sys.executable, *(["-P"] if safe else []), "-m", "tactsim", "list", "tables"]
    environment = {**os.environ, "PYTHONPATH": str(Path(tactsim.__file__).parents[1])}
    told = subprocess.run(
        ["sh", "-c", 'rmdir "$PWD"; exec "$@"', "sh", *command],
        cwd=gone,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.stderr.splitlines()[-1] == "error: the working folder is gone; change to another folder"
    assert "Traceback" not in told.stderr
    assert told.returncode == 5
