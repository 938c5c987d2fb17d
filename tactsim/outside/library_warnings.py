"""Warnings of libraries become warnings of the run: collected while it goes on, each shown once."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import PurePath

from tactsim.outside.text import one_line

MOST_SHOWN = 10
"""Different warnings that are shown; the rest are counted."""


class LibraryWarnings:
    """What libraries said."""

    def __init__(self, caught: list[warnings.WarningMessage]):
        self._caught = caught

    def lines(self) -> list[str]:
        """One line for each different warning: which library, unless it is this program, what it says, how often."""
        counts = Counter(_said_by(_library(one.filename)) + one_line(one.message, 200) for one in self._caught)
        most_common = [line if count == 1 else f"{line} ({count} times)" for line, count in counts.most_common(MOST_SHOWN)]
        left = len(counts) - len(most_common)
        return most_common + ([f"and {left} other warnings of libraries"] if left > 0 else [])


@contextmanager
def collected_warnings() -> Iterator[LibraryWarnings]:
    """A block whose Python warnings are collected instead of printed; those that are made errors stay errors."""
    with warnings.catch_warnings(record=True) as caught:
        yield LibraryWarnings(caught)


def _said_by(library: str) -> str:
    return "" if library == "tactsim" else f"{library}: "


def _library(filename: str) -> str:
    """The package that a warning came from, never a path of the machine."""
    parts = PurePath(filename).parts
    for root in ("site-packages", "dist-packages"):
        if root in parts[:-1]:
            return parts[parts.index(root) + 1].removesuffix(".py")
    return "tactsim" if "tactsim" in parts else PurePath(filename).stem.strip("<>")
