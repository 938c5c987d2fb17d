"""Finds every kind in a package: each module there may define one, nothing needs to be listed."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from functools import cache
from typing import Annotated, Any, Union

from pydantic import Field

from tactsim.errors import UnknownName


@cache
def kinds(package: str, base: type) -> dict[str, type]:
    """``kind`` -> concrete subclass of ``base`` defined in the modules of ``package``."""
    found: dict[str, type] = {}
    root = importlib.import_module(package)
    for info in sorted(pkgutil.iter_modules(root.__path__), key=lambda module: module.name):
        module = importlib.import_module(f"{package}.{info.name}")
        for cls in vars(module).values():
            own = inspect.isclass(cls) and issubclass(cls, base) and cls.__module__ == module.__name__
            if own and not inspect.isabstract(cls):
                found[cls.model_fields["kind"].default] = cls
    return found


def kind_class(package: str, base: type, kind: str) -> Any:
    """The class registered as ``kind``.

    Raises
    ------
    UnknownName
        With the nearest registered kind.
    """
    known = kinds(package, base)
    if kind not in known:
        raise UnknownName(f"{base.__name__.lower()} kind", kind, known)
    return known[kind]


def tagged_union(package: str, base: type) -> Any:
    """Pydantic type of all kinds in a package, told apart by ``kind``."""
    return union_of(kinds(package, base))


def union_of(known: dict[str, Any]) -> Any:
    """Pydantic type of these kinds, told apart by ``kind``."""
    choices = tuple(known[kind] for kind in sorted(known))
    return choices[0] if len(choices) == 1 else Annotated[Union[choices], Field(discriminator="kind")]  # noqa: UP007
