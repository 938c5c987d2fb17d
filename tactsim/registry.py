"""Finds every kind in a package: each module there may define one, nothing needs to be listed."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any, Union

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from tactsim.errors import InputError, UnknownName
from tactsim.interfaces import MARKED, MarkedFunction


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


def shipped(what: str, name: str, library: Mapping[str, Any]) -> Any:
    """The shipped set of this name; ``what`` is what a set is called in messages.

    Raises
    ------
    UnknownName
        With the nearest name.
    """
    if name not in library:
        raise UnknownName(what, name, library)
    return library[name]


class Named:
    """Annotation that lets a field take the name of a shipped set beside the set itself, in files and in the JSON Schema.

    Parameters
    ----------
    what : what a set is called in messages
    library : gives the shipped sets by name; called when a name is read, so that it may be defined after the field's class
    """

    def __init__(self, what: str, library: Callable[[], Mapping[str, Any]]):
        self.what, self.library = what, library

    def read(self, value: Any) -> Any:
        """The shipped set of this name; anything but text passes."""
        if not isinstance(value, str):
            return value
        try:
            return shipped(self.what, value, self.library())
        except UnknownName as error:
            raise PydanticCustomError("unknown_name", "{message}", {"message": str(error)}) from None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        name = {"type": "string", "enum": sorted(self.library()), "description": f"Name of a shipped {self.what}."}
        return {"oneOf": [name, handler(schema)]}


def union_of(known: dict[str, Any]) -> Any:
    """Pydantic type of these kinds, told apart by ``kind``."""
    choices = tuple(known[kind] for kind in sorted(known))
    return choices[0] if len(choices) == 1 else Annotated[Union[choices], Field(discriminator="kind")]  # noqa: UP007


def marked_functions(package: str, family: str) -> dict[str, MarkedFunction]:
    """Name -> function of a family (``quantity``, ``drawing``), in the order of the names.

    Those of every module of ``package`` and of its packages, and those that any other module or a notebook has marked so far.

    Raises
    ------
    InputError
        If functions of two modules have the same name.
    """
    root = importlib.import_module(package)
    for info in pkgutil.walk_packages(root.__path__, f"{package}."):
        importlib.import_module(info.name)
    functions: dict[str, MarkedFunction] = {}
    for key in sorted(key for key in MARKED if key[0] == family):
        _, name, module = key
        if name in functions:
            raise InputError(f"two modules mark a {family} {name!r}: {functions[name].module} and {module}; rename one of them")
        functions[name] = MARKED[key]
    return functions


def forget(function: Callable[..., Any]) -> None:
    """Takes back the mark of a function, so that tables no longer know it.

    Raises
    ------
    UnknownName
        If it is not marked.
    """
    keys = [key for key, marked in MARKED.items() if marked.function is function]
    if not keys:
        raise UnknownName("marked function", function.__name__, (name for _, name, _ in MARKED))
    for key in keys:
        del MARKED[key]
