"""Where a defect arose: in a kind of the user's own it is not ours to mend, and the user wants its line."""

from __future__ import annotations

import traceback
from pathlib import Path

from tactsim.outside.text import one_line

_PACKAGE = str(Path(__file__).resolve().parents[1])


def unless_own(error: BaseException) -> str:
    """What follows "please report it": the innermost line outside libraries that the error came through, if any."""
    from sysconfig import get_paths  # a command without a defect starts without it

    libraries = ("<frozen", *(str(Path(path).resolve()) for name, path in get_paths().items() if name.endswith("lib")))
    for frame, line in reversed(list(traceback.walk_tb(error.__traceback__))):
        name = frame.f_code.co_filename
        file = name if name.startswith("<") else str(Path(name).resolve())
        if file.startswith(_PACKAGE) or not file.startswith(libraries):
            return f", unless line {line} of {one_line(frame.f_globals.get('__name__', file), 200)} is your own"
    return ""
