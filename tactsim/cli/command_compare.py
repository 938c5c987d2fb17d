"""``tactsim compare``: several stored results in one table and one figure."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tactsim.cli import console
from tactsim.errors import InputError, UnknownName
from tactsim.outside.text import aligned, one_line

if TYPE_CHECKING:
    from tactsim.results import Result
    from tactsim.results.comparison import Comparison

NAME = "compare"
SUMMARY = "put several stored results into one table and one figure"
DESCRIPTION = """\
Prints the numbers in which several stored results differ, a column for each result, and their
warnings. Of arrays, such as the forces of taxels, it gives the largest value and the largest
difference from the first result; what differs by round-off only is the same. With --out a
folder is written, in the place of an earlier comparison: comparison.csv and comparison.md with
every number, comparison.png (or .svg, .pdf: --figures) with a curve for each result and, of grasps,
a map of their taxels. A folder that holds several results, such as that of
tactsim run CASE1 CASE2 --out DIR, stands for all of them.
"""
EXAMPLES = """\
examples:
  tactsim compare results/soft results/hard
  tactsim compare results/designs --out designs --figures pdf
"""
LONGEST_IN_TABLE = 24
LEAST_HEAD, LEAST_CELL = 8, 10
"""Least widths of the columns of a table."""
TABLE_FILE = "comparison.csv"
"""What every comparison holds."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("results", metavar="RESULT", type=Path, nargs="+", help="folder of a result, or of several")
    parser.add_argument("--out", metavar="DIR", type=Path, help="write the table and the figure into this folder")
    words = "form of the picture (default: png); none draws nothing"
    parser.add_argument("--figures", choices=("none", "png", "svg", "pdf"), default="png", help=words)
    parser.add_argument("--all", action="store_true", help="print every number, those that are the same too")


def run(arguments: argparse.Namespace) -> int:
    """Exit code of the whole command.

    Raises
    ------
    InputError
        If fewer than two results are named.
    StorageError
        If a result cannot be read or the folder cannot be written.
    """
    from tactsim.results import read_result
    from tactsim.results.folder import refuse_others

    if arguments.out is not None:
        refuse_others(arguments.out, TABLE_FILE, "comparison")
    folders = [folder for place in arguments.results for folder in _folders(place)]
    stored = {name: read_result(folder, fields=False) for name, folder in _named(folders).items()}
    if len(stored) < 2:
        raise InputError("one result has nothing to be compared with; name two or more, or a folder that holds several")
    report({name: one.complete for name, one in stored.items()}, arguments.out, form=arguments.figures, everything=arguments.all)
    return 0


def report(
    results: Mapping[str, Result],
    out: Path | None,
    *,
    form: str = "png",
    everything: bool = False,
    warnings: bool = True,
    quiet: bool = False,
) -> None:
    """Print the table unless it is to be quiet, with the warnings if they are wanted, and write it with its figure in a form, or
    "none", if a folder is given.
    """
    from tactsim.results.comparison import compared

    comparison = compared(results, _unit_of, _name_of)
    if not quiet:
        _print(comparison, everything)
        if warnings:
            _print_warnings(comparison)
    if out is not None:
        from tactsim.results.writing import write_files

        texts = {TABLE_FILE: comparison.csv_text(), "comparison.md": comparison.markdown_text()}
        files = {name: text.encode() for name, text in texts.items()}
        remark = ""
        if form != "none":
            from tactsim.cli.figures.comparison import drawn_comparison

            figure = drawn_comparison(results, comparison, form)
            if figure is not None:
                files[f"comparison.{form}"] = figure
            else:
                remark = "; no figure, for no two of the results share a number"
        write_files(files, out)
        if not quiet:
            console.out(f"comparison {one_line(out)}{remark}")


def _print(comparison: Comparison, everything: bool) -> None:
    """Print a row for every input that differs, and for every number, or for those that differ."""
    from tactsim.results.compared_numbers import FROM_FIRST, shown_number

    names = [one_line(name, LONGEST_IN_TABLE) for name in comparison.names]
    rows = [["", *names], ["status", *comparison.statuses]]
    if comparison.warned:
        rows.append(["warnings", *comparison.counted_warnings])
    rows += [[key, *(one_line(value, LONGEST_IN_TABLE) for value in values)] for key, values in comparison.inputs.items()]
    columns = comparison.columns if everything else comparison.differing
    rows += [[column.head, *(shown_number(value) or "-" for value in column.values)] for column in columns]
    heads = max([LEAST_HEAD, *(len(column.head) for column in comparison.columns)])
    console.out("\n".join(aligned(rows, least=[heads, *[LEAST_CELL] * len(names)])))
    if any(column.name.startswith(FROM_FIRST) for column in columns):
        console.out("\n".join(comparison.notes))


def _print_warnings(comparison: Comparison) -> None:
    """Print every warning once, with the results that have it."""
    for text, warned in comparison.warned.items():
        console.out(f"warning: {', '.join(one_line(name, LONGEST_IN_TABLE) for name in warned)}: {one_line(text)}")


def _unit_of(experiment: Mapping[str, Any], path: tuple[str | int, ...]) -> str:
    """SI unit of a key of an experiment by the schema of its kind; empty for a kind that this tactsim does not have."""
    from tactsim.case.model import experiment_class
    from tactsim.schema_of_model import unit_at

    try:
        return unit_at(experiment_class(str(experiment.get("kind"))), experiment, path)
    except UnknownName:
        return ""


def _name_of(part: Mapping[str, Any]) -> str:
    """The shipped material set of which a part of a case holds the constants; empty if it holds those of none."""
    if "kind" not in part:
        return ""
    from tactsim.materials.library import LIBRARY

    return next((name for name, entry in LIBRARY.items() if entry.material.model_dump(mode="json") == part), "")


def _folders(place: Path) -> list[Path]:
    """The folder of a result, or those within a folder that holds several."""
    if (place / "result.json").is_file() or not place.is_dir():
        return [place]
    return sorted(path.parent for path in place.glob("*/result.json")) or [place]


def _named(folders: list[Path]) -> dict[str, Path]:
    """Folders by their last names, or by as much of their paths as tells them apart."""
    names = [folder.name for folder in folders]
    return {folder.name if names.count(folder.name) == 1 else str(folder): folder for folder in folders}
