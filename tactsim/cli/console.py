"""The one place that writes to the terminal: what others wrote cannot steer it, and a reader that has gone away (``| head``, a
closed window) never stops a run."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TextIO

from tactsim.outside.text import printable
from tactsim.progress import notes_are_watched as notes_are_watched


def out(text: str = "") -> None:
    """One or more lines of the answer, to standard output."""
    _write(sys.stdout, text)


def note(text: str) -> None:
    """One or more lines about what is going on, to standard error."""
    _write(sys.stderr, text)


def error(message: str) -> None:
    """The reason why a command ends."""
    note(f"error: {message}")


def flush() -> None:
    """Sends what is still waiting."""
    for stream in (sys.stdout, sys.stderr):
        _guarded(stream, "")


def _write(stream: TextIO | None, text: str) -> None:
    encoding = getattr(stream, "encoding", None) or "utf-8"
    _guarded(stream, (printable(text) + "\n").encode(encoding, "backslashreplace").decode(encoding))


def _guarded(stream: TextIO | None, text: str) -> None:
    if stream is None:  # the caller closed it before the start
        return
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError):
        _silence(stream)


def _silence(stream: TextIO) -> None:
    """Sends a stream whose reader is gone to nowhere, so that the interpreter does not complain at its end either."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
