"""Where a defect arose: in a kind of the user's own it is not ours to mend, and the user wants its line."""

from __future__ import annotations

import traceback
from pathlib import Path

from tactsim.outside.text import one_line

_PACKAGE = str(Path(__file__).resolve().parents[1])


def unless_own(error: BaseException) -> str:
    """What follows "please report it": where the error arose, if that is known."""
    place = place_of(error)
    return f", unless {place} is your own" if place else ""


def place_of(error: BaseException) -> str:
    """The innermost line outside libraries that an error came through: ``line 3 of my_law``; empty if it was never raised."""
    from sysconfig import get_paths  # a command without a defect starts without it

    libraries = ("<frozen", *(str(Path(path).resolve()) for name, path in get_paths().items() if name.endswith("lib")))
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        name = frame.f_code.co_filename
        file = name if name.startswith("<") else str(Path(name).resolve())
        if file.startswith(_PACKAGE) or not file.startswith(libraries):
            return f"line {line} of {one_line(frame.f_globals.get('__name__', file), 200)}"
    return ""
