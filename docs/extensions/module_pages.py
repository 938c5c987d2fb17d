"""One page for each room of the package with what its modules define; the text is that of the docstrings."""

from __future__ import annotations

import importlib
import pkgutil
import tomllib
from pathlib import Path

import tactsim

ROOT = Path(__file__).parents[2]


def module_pages() -> dict[str, str]:
    """The page of each room, from the lowest to the highest as the layers stand, and the page that lists them."""
    rooms = rooms_upwards()
    pages = {f"modules/{room}.rst": _room_page(room) for room in rooms}
    lines = [
        _title("Modules"),
        "One page for each room; a room uses those before it in this list, see :doc:`/building/house`.",
        "",
    ]
    lines += [".. list-table::", "", *(f"   * - :doc:`{room}`\n     - {_summary(room)}" for room in rooms), ""]
    lines += [".. toctree::", "   :hidden:", "", *(f"   {room}" for room in rooms)]
    return pages | {"modules/index.rst": "\n".join(lines) + "\n"}


def rooms_upwards() -> list[str]:
    """Names of the rooms, lowest first, as ``pyproject.toml`` holds them; those that no layer names come first."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    layers = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
    ordered = [name.strip().removeprefix("tactsim.") for layer in reversed(layers) for name in layer.split("|")]
    present = [module.name for module in pkgutil.iter_modules(tactsim.__path__) if not module.name.startswith("_")]
    return [*(room for room in present if room not in ordered), *(room for room in ordered if room in present)]


def _summary(room: str) -> str:
    return " ".join((importlib.import_module(f"tactsim.{room}").__doc__ or "").split("\n\n")[0].split())


def _room_page(room: str) -> str:
    lines = [_title(f"tactsim.{room}")]
    for name in _modules(f"tactsim.{room}"):
        if name != f"tactsim.{room}":
            lines += [name.removeprefix(f"tactsim.{room}."), "-" * len(name), ""]
        lines += [f".. automodule:: {name}", *(["   :ignore-module-all:"] if _is_package(name) else []), ""]
    return "\n".join(lines)


def _modules(name: str) -> list[str]:
    module = importlib.import_module(name)
    if not hasattr(module, "__path__"):
        return [name]
    below = [found.name for found in pkgutil.walk_packages(module.__path__, f"{name}.")]
    return [name, *(found for found in below if not found.rpartition(".")[2].startswith("_"))]


def _is_package(name: str) -> bool:
    return hasattr(importlib.import_module(name), "__path__")


def _title(text: str) -> str:
    return f"{text}\n{'=' * len(text)}\n"
