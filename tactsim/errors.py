"""Every error that tactsim raises on purpose, with the exit code of its branch.

::

    TactsimError
    |-- InputError            2   what the user wrote cannot be used
    |   |-- CaseError             a case file, with file, line and key
    |   |   `-- Refused                 a part of a case made in Python
    |   |-- InvalidQuantity       a number out of its range, or without its unit
    |   |-- UnknownName           a name that is not registered
    |   |-- AmbiguousKind         a name that is registered twice
    |   |-- IncompleteKind        a kind whose class lacks methods
    |   `-- IncompleteInstallation   a name whose module needs one that is not there
    |-- Unfinished            3   a computation ended before its end
    |   |-- ConvergenceError      the solver gave up; carries its history
    |   |-- Collapsed             an element is nearly inside out
    |   |-- OutOfTime             the time allowed has passed
    |   `-- OutOfMemory           the memory does not suffice
    `-- StorageError          5   a file or folder cannot be read or written

Two outcomes of a command are no errors and have an exit code of their own: ``NOT_AS_RECORDED`` and ``INTERRUPTED``.
"""

from __future__ import annotations

import difflib
import math
import re
import reprlib
from collections.abc import Iterable
from typing import Any, ClassVar

NOT_AS_RECORDED = 4
"""Exit code of a check whose findings differ from what is recorded: a row of a table, a sample of a data set."""
INTERRUPTED = 130
"""Exit code of a command stopped by the user or the system."""


class TactsimError(Exception):
    """Base class; ``exit_code`` is what the command line returns.

    >>> import tactsim as ts
    >>> try:
    ...     ts.load_result("no_such_folder")
    ... except ts.TactsimError as error:
    ...     print(error.exit_code)
    5
    """

    exit_code: ClassVar[int] = 1

    def __reduce__(self) -> tuple[Any, ...]:
        return _raised_again, (type(self), self.args), vars(self)


def _raised_again(error: type[TactsimError], given: Iterable[Any]) -> TactsimError:
    """The error of another process with its message, which its class may make of more than the message."""
    again = error.__new__(error, *given)
    again.args = tuple(given)
    return again


class InputError(TactsimError):
    """What the user wrote cannot be used.

    >>> import tactsim as ts
    >>> try:
    ...     ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius="4 kPa")
    ... except ts.InputError as error:
    ...     print(error)
    Sphere: radius: '4 kPa' has the wrong dimension; expected a length with its unit, such as '1 mm'
    """

    exit_code = 2


class CaseError(InputError):
    """A case, in a file or from Python, is wrong at a place that the message names."""


class Refused(CaseError, ValueError):
    """A part of a case that was made in Python is wrong; ``reasons`` holds what its model refused."""

    def __init__(self, message: str, reasons: Any):
        super().__init__(message)
        self.reasons = reasons


class InvalidQuantity(InputError, ValueError):
    """A number is out of its range or lacks its unit."""


class UnknownName(InputError, LookupError):
    """A name that is not registered; the message names the nearest one, and lists all or says what lists them."""

    def __init__(self, what: str, name: object, allowed: Iterable[str], listed_by: str = ""):
        choices = sorted(allowed)
        all_of_them = f"{listed_by} lists all" if listed_by else f"known: {', '.join(choices)}"
        super().__init__(f"unknown {what} {shown(name)}{suggestion(str(name), choices)}; {all_of_them}")


class AmbiguousKind(InputError):
    """Two classes are registered by one name."""


class IncompleteKind(InputError, ValueError):
    """The class that states a kind lacks what its extension point demands; the message names it."""

    def __init__(self, what: str, kind: str, cls: Any, missing: Iterable[str]):
        super().__init__(f"{what} {shown(kind)}: its class {cls.__qualname__} lacks {', '.join(missing)}")


class IncompleteInstallation(InputError):
    """The module that states a name needs one of this program that is not there, such as a family of experiments removed."""


class Unfinished(TactsimError):
    """A computation ended before its end; what it had accepted stands."""

    exit_code = 3


class ConvergenceError(Unfinished):
    """The solver gave up; ``history`` holds the residual norms of its last iterations, ``solutions`` counts the linear systems
    that were solved in vain (by default those of the history)."""

    def __init__(self, reason: str, history: Iterable[float] = (), solutions: int | None = None):
        super().__init__(reason)
        self.history = tuple(history)
        self.solutions = max(len(self.history) - 1, 0) if solutions is None else solutions


class TooShort(ConvergenceError):
    """A step whose load is hidden in round-off; a longer one may not be."""


class Collapsed(Unfinished):
    """An element has lost so much of its volume that it is about to turn inside out; no shorter load step helps."""


class OutOfTime(Unfinished):
    """The time allowed for solving has passed; a shorter load step would not help, so that it is no ConvergenceError."""


class OutOfMemory(Unfinished):
    """The memory does not suffice; nor would a shorter load step help here."""


class StorageError(TactsimError, OSError):
    """A file or folder cannot be read or written."""

    exit_code = 5


MOST_SUGGESTED = 3
"""Names that a message suggests instead of the beginning of theirs."""

_ENTRY, _NUMBER = re.compile(r"(?P<list>\w+)(?P<numbers>(\[\d+\])+)"), re.compile(r"\d+")


def suggestion(name: str, allowed: Iterable[str]) -> str:
    """``" (did you mean 'radius'?)"`` if an allowed name is near, those that begin with its words or that it begins with, else an
    empty string; ``center`` and ``centre`` are one word.

    An entry of a list as Python writes it, ``center[0]``, is suggested as a key path has it, ``center.0``.
    """
    names = list(allowed)
    entry = _ENTRY.fullmatch(name[:100])
    if entry is not None and entry["list"] in names:
        return f" (did you mean {'.'.join((entry['list'], *_NUMBER.findall(entry['numbers'])))!r}?)"
    spelled, wanted = {_spelled(other): other for other in names}, _spelled(name[:100])
    near = [spelled[other] for other in difflib.get_close_matches(wanted, spelled, n=1, cutoff=0.6)]
    longer = (other for word, other in spelled.items() if wanted and word.startswith(f"{wanted}_"))
    shorter = (other for word, other in spelled.items() if word and wanted.startswith(f"{word}_"))
    near = near or sorted(longer)[:MOST_SUGGESTED] or sorted(shorter)[:MOST_SUGGESTED]
    return f" (did you mean {' or '.join(map(repr, near))}?)" if near else ""


def _spelled(name: str) -> str:
    """A name in one of two spellings, both of which keys of cases have."""
    return name.replace("center", "centre")


def shown(value: Any) -> str:
    """``value`` as a message shows it: its ``repr``, cut in the middle when it is long."""
    return _SHORTENED.repr(value)


class _Shortened(reprlib.Repr):
    """Values on a line, of which a whole number may have more digits than Python spells."""

    def repr_int(self, x: int, level: int) -> str:
        try:
            return super().repr_int(x, level)
        except ValueError:
            return f"a whole number of {x.bit_length() * math.log10(2):.0f} digits"


_SHORTENED = _Shortened()
_SHORTENED.maxstring = _SHORTENED.maxother = _SHORTENED.maxlong = 80
