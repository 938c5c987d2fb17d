"""Functions that the tables of the thesis call by name, found in their package or marked elsewhere; nothing is listed."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tactsim.errors import AmbiguousKind, IncompleteInstallation, UnknownName
from tactsim.kinds_in_source import functions_in_source, load_all, module_names

ANY = ".*"
"""Pattern of modules: all of a package."""


@dataclass(frozen=True)
class MarkedFunction:
    """A function that the tables of the thesis call by its name, with arguments that are read from its signature."""

    family: str
    """``quantity`` for the number of a row, ``drawing`` for the data of a figure."""
    function: Callable[..., Any]
    unit: str | Callable[..., str] = "1"
    """SI unit of the number, or a function that returns it from those of the arguments that it names."""
    check: Callable[..., None] | None = None
    """Raises a ValueError if the arguments that it names do not go together; called when a table is read."""

    @property
    def name(self) -> str:
        """What a table writes as ``kind``."""
        return self.function.__name__

    @property
    def module(self) -> str:
        """Where it is defined."""
        return self.function.__module__


_marked: dict[tuple[str, str, str], MarkedFunction] = {}
"""Every marked function by family, name and module; one defined again in its module takes the place of the earlier one."""


def mark(marked: MarkedFunction) -> None:
    """Make a function known to the tables."""
    _marked[marked.family, marked.name, marked.module] = marked


def forget_function(function: Any) -> None:
    """Remove a marked function."""
    for key in [key for key, marked in _marked.items() if marked.function is function]:
        del _marked[key]


def marked_functions(package: str, family: str) -> dict[str, MarkedFunction]:
    """Name -> function of a family (``quantity``, ``drawing``), sorted by name.

    Those of every module of ``package`` and its folders, and those that any other module or a notebook has marked so far.

    Raises
    ------
    AmbiguousKind
        If functions of two modules have the same name.
    """
    load_all(package, ANY)
    return {name: _marked_as(family, name) for name in sorted({name for known, name, _ in _marked if known == family})}


def functions_outside(package: str) -> tuple[MarkedFunction, ...]:
    """The functions that are marked outside a package, such as those of a notebook."""
    return tuple(marked for marked in _marked.values() if marked.module.partition(".")[0] != package)


def marked_function(package: str, family: str, name: str) -> MarkedFunction:
    """The function of a family that has this name; of the package only the modules whose source states it are loaded.

    Raises
    ------
    AmbiguousKind
        If functions of two modules have the name.
    IncompleteInstallation
        If a module that states it needs another one of this program that is not there, such as a family that was removed.
    UnknownName
        With the nearest name.
    """
    for module in functions_in_source(module_names(package, ANY), family).get(name, ()):
        try:
            importlib.import_module(module)
        except ModuleNotFoundError as error:
            if error.name is None or error.name.partition(".")[0] != package.partition(".")[0]:
                raise
            raise IncompleteInstallation(f"{family} {name} of {module} needs {error.name}, which is not installed") from error
    if not _marking(family, name):
        raise UnknownName(family, name, marked_names(package, family))
    return _marked_as(family, name)


def marked_names(package: str, family: str) -> list[str]:
    """Names of a family that are marked now, and those that the source of the package states; loads none of its modules."""
    stated = functions_in_source(module_names(package, ANY), family)
    return sorted({*stated, *(name for known, name, _ in _marked if known == family)})


def _marking(family: str, name: str) -> list[str]:
    """The modules that mark a function of a family by this name."""
    return sorted(module for known, named, module in _marked if (known, named) == (family, name))


def _marked_as(family: str, name: str) -> MarkedFunction:
    """The one function of a family that has this name.

    Raises
    ------
    AmbiguousKind
        If two modules mark one.
    """
    modules = _marking(family, name)
    if len(modules) > 1:
        raise AmbiguousKind(f"two modules mark a {family} {name!r}: {modules[0]} and {modules[1]}; rename one of them")
    return _marked[family, name, modules[0]]
