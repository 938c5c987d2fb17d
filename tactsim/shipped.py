"""Where the cases, tables and meshes that come with tactsim lie: beside the modules of a wheel, or in the checkout."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from tactsim.errors import UnknownName

_PACKAGE = Path(__file__).resolve().parent
PROGRAM = _PACKAGE / "_shipped" if (_PACKAGE / "_shipped").is_dir() else _PACKAGE.parent
"""The folder that holds ``cases`` and ``meshes``."""
CASES = PROGRAM / "cases"
LONGEST_CASE_NAME = 60
"""Characters of a text that may be the name of a shipped case; a file name has 255 bytes, a character up to 4."""


def case_path(named: str | Path) -> Path:
    """The case file of a path or of the name of a shipped case, such as ``annulus_icf``; a file of that path comes first.

    A folder does not: it is the result of an earlier run, more likely than not.

    Raises
    ------
    UnknownName
        If it is a bare name, and no shipped case has it.
    """
    path = Path(named)
    if not re.fullmatch(rf"\w{{1,{LONGEST_CASE_NAME}}}", str(named)) or (path.exists() and not path.is_dir()):
        return path
    known = {place.stem: place for place in shipped_cases()}
    if path.name not in known:
        if path.exists():
            return path
        raise UnknownName("case", path.name, known, listed_by="tactsim list")
    return known[path.name]


def shipped_name(path: str | Path) -> str:
    """The name of the shipped case that a file is called after, empty if none is."""
    name = Path(path).stem
    return name if Path(path).suffix == ".yaml" and os.path.isfile(CASES / f"{name}.yaml") else ""


def shipped_cases() -> Iterator[Path]:
    """The files of the shipped cases and sweeps, by name."""
    return iter(sorted(CASES.glob("*.yaml")))
