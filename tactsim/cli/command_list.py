"""``tactsim list``: what comes with tactsim, a line for each."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
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
SCHEMA, TITLE, KIND = ("schema",), ("title",), ("experiment", "kind")
"""Where a file says what it is."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument(
        "what", metavar="WHAT", nargs="?", choices=list(SECTIONS), help=f"one of {', '.join(SECTIONS)}; by default all"
    )


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command."""
    for section in [arguments.what] if arguments.what else SECTIONS:
        if arguments.what is None:
            console.out("\n".join([f"{section}:", *listed(section, indent="  "), ""]))
        else:
            console.out("\n".join(listed(section)))
    return 0


def listed(section: str, *, indent: str = "") -> list[str]:
    """Lines of a section, one for each name."""
    return aligned([(name, one_line(about, 200)) for name, about in SECTIONS[section]()], left=2, indent=indent)


def _titled(schema: str) -> Callable[[], Lines]:
    """Name, kind and title of the shipped files of a schema."""

    def lines() -> Lines:
        from tactsim.shipped import shipped_cases

        written = _written(shipped_cases(), schema, KIND)
        return ((name, f"{values.get(KIND, '')}: {values.get(TITLE, '')}") for name, values in written.items())

    return lines


def _written(paths: Iterable[Path], schema: str, *more: KeyPath) -> dict[str, dict[KeyPath, Any]]:
    """Name -> schema, title and ``more`` of those files that have a schema that begins so."""
    from tactsim.case.yaml_reading import first_values

    heads = {path.stem: first_values(path.read_text(encoding="utf-8"), SCHEMA, TITLE, *more) for path in paths}
    return {name: values for name, values in heads.items() if str(values.get(SCHEMA, "")).startswith(schema)}


def _materials() -> Lines:
    from tactsim.materials.library import LIBRARY

    return ((name, f"{entry.material.kind}; {entry.source}") for name, entry in sorted(LIBRARY.items()))


def _classes(point: str) -> Callable[[], Lines]:
    def lines() -> Lines:
        from tactsim.field_docstrings import summary
        from tactsim.interfaces.points import kinds

        return ((kind, summary(cls)) for kind, cls in kinds(point).items())

    return lines


def _tables() -> Lines:
    from tactsim.shipped import CASES

    return (
        (name, str(values.get(TITLE, "")))
        for group in ("thesis", "published")
        for name, values in _written(sorted((CASES / group).glob("*.yaml")), "tactsim/thesis-table/").items()
    )


SECTIONS: dict[str, Callable[[], Lines]] = {
    "cases": _titled("tactsim/case/"),
    "sweeps": _titled("tactsim/sweep/"),
    "materials": _materials,
    "kinds": _classes("experiment"),
    "estimators": _classes("estimator"),
    "tables": _tables,
}
"""What can be listed -> its lines."""
