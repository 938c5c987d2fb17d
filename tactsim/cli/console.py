"""The one place that writes to the terminal: what others wrote cannot steer it, and a reader that has gone away (``| head``, a
closed window) never stops a run, nor does a full disk, but output that was lost on one is reported when the command ends."""

from __future__ import annotations

import errno
import os
import shlex
import sys
from contextlib import suppress
from typing import TextIO

from tactsim.outside.text import one_line, printable
from tactsim.progress import notes_are_watched as notes_are_watched

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What the system says where a stream goes to a file that cannot grow."""
_lost: list[str] = []
"""Why an answer was lost, until the end of the command."""


def out(text: str = "") -> None:
    """One or more lines of the answer, to standard output."""
    _write(sys.stdout, text)


def note(text: str) -> None:
    """One or more lines about what is going on, to standard error."""
    _write(sys.stderr, text)


def error(message: str) -> None:
    """The reason why a command ends."""
    note(f"error: {message}")


def command(*words: object) -> str:
    """A command of tactsim as it can be pasted into a shell, whatever its files are called."""
    return one_line(shlex.join(["tactsim", *map(str, words)]))


def flush() -> str:
    """Sends what is still waiting; why a part of the answer of this command was lost, empty if none was."""
    for stream in (sys.stdout, sys.stderr):
        _guarded(stream, "")
    lost = "".join(_lost[:1])
    _lost.clear()
    return lost


def _write(stream: TextIO | None, text: str) -> None:
    encoding = getattr(stream, "encoding", None) or "utf-8"
    _guarded(stream, (printable(text) + "\n").encode(encoding, "backslashreplace").decode(encoding))


def _guarded(stream: TextIO | None, text: str) -> None:
    if stream is None:  # the caller closed it before the start
        return
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        if stream is sys.stdout and isinstance(error, OSError) and error.errno in FULL:
            _lost.append(os.strerror(error.errno))
        _silence(stream)


def _silence(stream: TextIO) -> None:
    """Sends a stream whose reader is gone to nowhere, so that the interpreter does not complain at its end either."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
