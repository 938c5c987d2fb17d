"""Stopping a run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from argparse import Namespace
from contextlib import suppress
from pathlib import Path

import pytest

import tactsim
from tactsim.cli import entry, interruption
from tactsim.cli.interruption import SIGNALS, interruptible


@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_the_first_signal_interrupts(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(number)
    assert signal.getsignal(number) == before


@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_a_command_that_a_signal_ends_says_so(
    number: signal.Signals, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stopped = Namespace(debug=False, run=lambda parsed: signal.raise_signal(number))
    monkeypatch.setattr(entry, "_parsed", lambda parser, words: stopped)
    assert entry.main(["list"]) == 130
    assert capsys.readouterr().err == "error: interrupted\n"


def test_a_deferred_signal_is_remembered() -> None:
    with interruptible() as stop:
        with stop.deferred():
            signal.raise_signal(signal.SIGTERM)
        assert stop.requested


def test_the_second_signal_ends_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    codes: list[int] = []
    monkeypatch.setattr(interruption.os, "_exit", codes.append)
    with interruptible() as stop, stop.deferred():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
    assert codes == [130]


def test_a_stop_that_a_library_swallowed_is_heeded_by_the_next_block() -> None:
    """As libraries do while they are imported: a sweep went on to its end, and its exit code was 0."""
    with interruptible():
        with suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        with pytest.raises(KeyboardInterrupt), interruptible():
            pytest.fail("it went on")


def test_a_stop_while_a_dataclass_is_made_has_the_exit_code_of_any_other(tmp_path: Path) -> None:
    """Its methods are made by exec, and an interrupt within exec had ``python -m`` end by SIGINT whatever code was returned."""
    stopped = "command_list.run = lambda parsed: exec('raise KeyboardInterrupt')"
    program = f"import sys\nfrom tactsim.cli import command_list, entry\n{stopped}\nsys.exit(entry.main(['list']))"
    (tmp_path / "stopped.py").write_text(program)
    paths = os.pathsep.join([str(tmp_path), str(Path(tactsim.__file__).parents[1])])
    done = subprocess.run(
        [sys.executable, "-m", "stopped"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths}
    )
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


def test_a_signal_that_the_caller_ignores_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with interruptible() as stop:
            os.kill(os.getpid(), signal.SIGHUP)
        assert not stop.requested
    finally:
        signal.signal(signal.SIGHUP, before)


def test_other_threads_run_without_handlers() -> None:
    def body() -> None:
        with interruptible() as stop:
            seen.append(stop.requested)

    seen: list[bool] = []
    thread = threading.Thread(target=body)
    thread.start()
    thread.join()
    assert seen == [False]
