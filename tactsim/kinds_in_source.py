"""The modules of a package, and what their source states: to look a name up, or to list all, loads no other."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import re
from functools import cache
from pathlib import Path

CLASS = re.compile(
    r"^class (?P<name>\w+)\((?P<bases>[^)]*)\):(?:(?!^class ).*\n)*?(?:^    kind: Literal\[\"(?P<kind>\w+)\"\] = |(?=^\S)|\Z)",
    re.MULTILINE,
)
"""A class in the text of a module, its bases, and its kind if it states one."""
MARK = re.compile(r"^@(?P<family>quantity|drawing)\b(?:(?!^def ).*\n)*?^def (?P<name>\w+)\(", re.MULTILINE)
"""A function in the text of a module that is marked for the tables."""


@cache
def module_names(package: str, pattern: str) -> tuple[str, ...]:
    """Full names of the modules of a package and its folders whose name within the package fits the pattern."""
    root = importlib.import_module(package)
    names = (module.name for module in pkgutil.walk_packages(root.__path__, f"{package}."))
    return tuple(sorted(name for name in names if re.fullmatch(pattern, name.removeprefix(f"{package}."))))


@cache
def load_all(package: str, pattern: str) -> None:
    """Load the modules of a package and its folders whose name within the package fits the pattern."""
    for name in module_names(package, pattern):
        importlib.import_module(name)


@cache
def kinds_in_source(modules: tuple[str, ...], base: str) -> dict[str, tuple[str, ...]]:
    """Kind -> modules in whose text a class with it extends, directly or not, a class of the name ``base``."""
    bases: dict[str, list[str]] = {}
    stated: list[tuple[str, str, str]] = []
    for module in modules:
        for cls in CLASS.finditer(_text(module)):
            bases[cls["name"]] = re.findall(r"\w+", cls["bases"])
            if cls["kind"]:
                stated.append((cls["kind"], cls["name"], module))

    def extends(name: str) -> bool:
        return name == base or any(map(extends, bases.get(name, ())))

    kinds: dict[str, tuple[str, ...]] = {}
    for kind, name, module in stated:
        if extends(name):
            kinds[kind] = (*kinds.get(kind, ()), module)
    return kinds


@cache
def functions_in_source(modules: tuple[str, ...], family: str) -> dict[str, tuple[str, ...]]:
    """Name -> modules in whose text a function of it is marked as one of a family, ``quantity`` or ``drawing``."""
    functions: dict[str, tuple[str, ...]] = {}
    for module in modules:
        for mark in MARK.finditer(_text(module)):
            if mark["family"] == family:
                functions[mark["name"]] = (*functions.get(mark["name"], ()), module)
    return functions


def _text(module: str) -> str:
    """The source of a module; nothing of one that is not written in Python."""
    spec = importlib.util.find_spec(module)
    source = Path(spec.origin) if spec is not None and spec.origin is not None else None
    return source.read_text(encoding="utf-8") if source is not None and source.suffix == ".py" else ""
