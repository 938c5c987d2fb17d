"""Warnings of libraries, and those of the program itself."""

from __future__ import annotations

import warnings
from pathlib import Path

import tactsim
from tactsim.outside.library_warnings import collected_warnings


def test_a_library_is_named_and_the_program_is_not() -> None:
    own = str(Path(tactsim.__file__).parent / "units.py")
    with collected_warnings() as collected:
        warnings.simplefilter("always")
        warnings.warn_explicit("what the user should know", UserWarning, own, 1)
        for line in (1, 2):
            warnings.warn_explicit("it is old", UserWarning, "/somewhere/site-packages/scipy/sparse.py", line)
    assert collected.lines() == ["scipy: it is old (2 times)", "what the user should know"]
