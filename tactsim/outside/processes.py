"""The one place that starts child processes: isolated from the working folder, bounded in memory and time, ended with the parent.

A child imports tactsim from where its parent has it and everything else from the interpreter's own folders: neither from the
working folder nor from ``PYTHONPATH``, whose files may be anybody's.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any

from tactsim.outside.text import one_line

ROOT = Path(__file__).resolve().parents[2]
"""The folder that holds the package."""
BEGIN = Path(__file__).resolve().with_name("child.py")
ISOLATED = ("-P", "-E")
"""Python's options: no import from the folder of the program or the working folder, no ``PYTHON*`` variables."""
LAST_WORDS = 4096
"""Bytes at the end of what a child wrote that are kept."""
UNSET = -1
"""Exit code of a child that was stopped."""
BROKEN = b"!"
"""How the answer of a worker begins that reports a defect."""


@dataclass(frozen=True)
class Ended:
    """How a child ended: its exit code, what it last wrote to standard error, and whether its time was up."""

    code: int
    error_output: str
    out_of_time: bool = False

    @property
    def last_line(self) -> str:
        """Its last words on one line, empty if there are none."""
        return one_line((self.error_output.strip().splitlines() or [""])[-1], 300)

    @property
    def ending(self) -> str:
        """How it ended in words: the signal or the exit code."""
        return ending(self.code)

    @property
    def out_of_memory(self) -> bool:
        """Whether the limit of its memory ended it."""
        return "MemoryError" in self.error_output or "bad_alloc" in self.error_output or "allocate memory" in self.error_output


class Child:
    """A module of tactsim that runs as a separate program, for which this process waits later."""

    def __init__(
        self,
        module: str,
        arguments: Sequence[str],
        *,
        memory: int | None = None,
        environment: Mapping[str, str] | None = None,
    ):
        self._words = tempfile.TemporaryFile()  # noqa: SIM115  it lives as long as the process
        streams = {"stdin": subprocess.DEVNULL, "stdout": self._words, "stderr": self._words}
        try:
            self._process = _started(module, arguments, memory, environment, **streams)
        except BaseException:
            self._words.close()
            raise

    def wait(self, time_limit: float) -> Ended:
        """Waits for its end, at most ``time_limit`` in s from now; it is killed then."""
        try:
            self._process.wait(time_limit)
        except subprocess.TimeoutExpired:
            return Ended(UNSET, _last_words(self._words), out_of_time=True)
        else:
            return Ended(self._process.returncode, _last_words(self._words))
        finally:
            self.stop()

    def stop(self) -> None:
        """Ends it at once, if it still runs."""
        _killed(self._process)
        self._words.close()


def run_child(
    module: str,
    arguments: Sequence[str],
    *,
    time_limit: float,
    memory: int | None = None,
    environment: Mapping[str, str] | None = None,
) -> Ended:
    """Runs a module of tactsim as a separate program and waits for its end.

    Parameters
    ----------
    arguments : of the program
    time_limit : in s, after which the child is killed
    memory : bytes that the child may write to; by default what the machine has
    environment : variables that the child has beside those of this process
    """
    return Child(module, arguments, memory=memory, environment=environment).wait(time_limit)


class Worker:
    """A child that answers requests until it is closed; both are bytes, through ``connection``."""

    def __init__(self, module: str, arguments: Sequence[str] = (), *, environment: Mapping[str, str] | None = None):
        self.connection, other = Pipe()
        self._words = tempfile.TemporaryFile()  # noqa: SIM115  it lives as long as the process
        streams = {"stdin": subprocess.DEVNULL, "stdout": self._words, "stderr": self._words, "pass_fds": (other.fileno(),)}
        try:
            self._process = _started(module, [str(other.fileno()), *arguments], None, environment, **streams)
        except BaseException:
            self.connection.close()
            self._words.close()
            raise
        finally:
            other.close()

    @property
    def pid(self) -> int:
        """Its number on this machine."""
        return self._process.pid

    def stop(self) -> None:
        """Ends it at once."""
        self.connection.close()
        _killed(self._process)
        self._words.close()

    def ended(self) -> str:
        """How it ended, in words, with the last line that it wrote; waits for the end."""
        self.connection.close()
        how = Ended(self._process.wait(), _last_words(self._words))
        self._words.close()
        return f"{how.ending}: {how.last_line}" if how.last_line else how.ending


def serve(descriptor: str, answer: Callable[[bytes], bytes]) -> None:
    """The life of a worker: it answers what its parent asks until the other end is gone, and leaves signals to the parent.

    A defect is an answer that begins with `BROKEN`: it must reach the parent, not look like a lost worker.
    """
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    connection = Connection(int(descriptor))
    with suppress(EOFError, OSError):
        while True:
            request = connection.recv_bytes()
            try:
                answered = answer(request)
            except Exception as error:  # noqa: BLE001  whatever it is
                answered = BROKEN + f"{type(error).__name__}: {error}".encode()
            connection.send_bytes(answered)


def ending(code: int | None) -> str:
    """An exit code in words."""
    if code is not None and code < 0:
        with suppress(ValueError):
            name = signal.Signals(-code).name
            return f"{name}, perhaps out of memory" if name == "SIGKILL" else name
    return f"exit code {code}"


def machine_memory() -> int:
    """Bytes of memory of this machine, 0 if they are not known."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return 0


def _started(
    module: str, arguments: Sequence[str], memory: int | None, environment: Mapping[str, str] | None, **streams: Any
) -> subprocess.Popen[bytes]:
    most = machine_memory() if memory is None else memory
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    command = [sys.executable, *ISOLATED, str(BEGIN), str(ROOT), str(most), str(os.getpid()), module, *arguments]
    return subprocess.Popen(command, env={**kept, **(environment or {})}, **streams)


def _killed(child: subprocess.Popen[bytes]) -> None:
    if child.poll() is None:
        child.kill()
        child.wait()


def _last_words(words: IO[bytes]) -> str:
    words.seek(max(0, words.seek(0, os.SEEK_END) - LAST_WORDS))
    return words.read().decode("utf-8", "replace")
