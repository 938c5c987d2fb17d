"""``tactsim list``: what comes with tactsim, a line for each."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.cli import console
from tactsim.outside.text import aligned, one_line

if TYPE_CHECKING:
    from tactsim.schema_of_model import Path as KeyPath

NAME = "list"
SUMMARY = "list shipped cases, sweeps, materials, kinds, estimators and tables"
DESCRIPTION = """\
Lists what comes with tactsim, a line for each: cases (run them by name), sweeps, materials, kinds
of experiments, estimators of the place of a lump, and the tables of the thesis.
"""
EXAMPLES = """\
examples:
  tactsim list
  tactsim list cases
  tactsim list kinds
"""
Lines = Iterable[tuple[str, str]]
Heads = dict[str, dict["KeyPath", Any]]
"""Name of a file -> what it says of itself, by key path."""
SCHEMA, TITLE, KIND = ("schema",), ("title",), ("experiment", "kind")
"""Where a file says what it is."""


class ShippedHeads:
    """What the shipped cases and sweeps say of themselves: they are read when the first section asks, and once."""

    @cached_property
    def values(self) -> Heads:
        """Of all of them."""
        from tactsim.shipped import shipped_cases

        return _heads(shipped_cases(), KIND)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument(
        "what", metavar="WHAT", nargs="?", choices=list(SECTIONS), help=f"one of {', '.join(SECTIONS)}; by default all"
    )


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    shipped = ShippedHeads()
    for section in [arguments.what] if arguments.what else SECTIONS:
        if arguments.what is None:
            console.out("\n".join([f"{section}:", *listed(section, shipped, indent="  "), ""]))
        else:
            console.out("\n".join(listed(section)))
    return 0


def listed(section: str, shipped: ShippedHeads | None = None, *, indent: str = "") -> list[str]:
    """Lines of a section, one for each name."""
    lines = SECTIONS[section](shipped or ShippedHeads())
    return aligned([(name, one_line(about, 200)) for name, about in lines], left=2, indent=indent)


def _titled(schema: str) -> Callable[[ShippedHeads], Lines]:
    """Name, kind and title of the shipped files of a schema."""

    def lines(shipped: ShippedHeads) -> Lines:
        written = _of_schema(schema, shipped.values)
        return ((name, f"{values.get(KIND, '')}: {values.get(TITLE, '')}") for name, values in written.items())

    return lines


def _heads(paths: Iterable[Path], *more: KeyPath) -> Heads:
    """Schema, title and ``more`` of files."""
    from tactsim.case.yaml_reading import first_values

    return {path.stem: first_values(path.read_text(encoding="utf-8"), SCHEMA, TITLE, *more) for path in paths}


def _of_schema(schema: str, heads: Heads) -> Heads:
    """Those that have a schema that begins so."""
    return {name: values for name, values in heads.items() if str(values.get(SCHEMA, "")).startswith(schema)}


def _materials(_: ShippedHeads) -> Lines:
    from tactsim.materials.library import LIBRARY

    return ((name, f"{entry.material.kind}; {entry.source}") for name, entry in sorted(LIBRARY.items()))


def _classes(point: str) -> Callable[[ShippedHeads], Lines]:
    def lines(_: ShippedHeads) -> Lines:
        from tactsim.field_docstrings import summary
        from tactsim.interfaces.points import kinds

        return ((kind, summary(cls)) for kind, cls in kinds(point).items())

    return lines


def _tables(_: ShippedHeads) -> Lines:
    from tactsim.shipped import CASES

    return (
        (name, str(values.get(TITLE, "")))
        for group in ("thesis", "published")
        for name, values in _of_schema("tactsim/thesis-table/", _heads(sorted((CASES / group).glob("*.yaml")))).items()
    )


SECTIONS: dict[str, Callable[[ShippedHeads], Lines]] = {
    "cases": _titled("tactsim/case/"),
    "sweeps": _titled("tactsim/sweep/"),
    "materials": _materials,
    "kinds": _classes("experiment"),
    "estimators": _classes("estimator"),
    "tables": _tables,
}
"""What can be listed -> its lines."""
