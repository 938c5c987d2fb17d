"""The modules of a package, and the kinds that their source names: a message that lists kinds need not load what they need."""

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


@cache
def module_names(package: str, pattern: str) -> tuple[str, ...]:
    """Full names of the modules of a package and its folders whose name within the package fits the pattern."""
    root = importlib.import_module(package)
    names = (module.name for module in pkgutil.walk_packages(root.__path__, f"{package}."))
    return tuple(sorted(name for name in names if re.fullmatch(pattern, name.removeprefix(f"{package}."))))


@cache
def kinds_in_source(modules: tuple[str, ...], base: str) -> dict[str, tuple[str, ...]]:
    """Kind -> modules in whose text a class with it extends, directly or not, a class of the name ``base``."""
    bases: dict[str, list[str]] = {}
    stated: list[tuple[str, str, str]] = []
    for module in modules:
        spec = importlib.util.find_spec(module)
        source = Path(spec.origin) if spec is not None and spec.origin is not None else None
        text = source.read_text(encoding="utf-8") if source is not None and source.suffix == ".py" else ""
        for cls in CLASS.finditer(text):
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
