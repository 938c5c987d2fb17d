"""Columns of numbers from CSV files whose header names every quantity and its unit."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.identification.table import Table, read_table
from tactsim.outside.text import one_line
from tactsim.units import parse_quantity

_HEADER = re.compile(r"(?P<name>[^\[\]()]+?)\s*(?:[\[(](?P<unit>[^\[\]()]*)[\])])?")


def read_columns(path: str | Path, units: dict[str, str], *, complete: bool = False) -> dict[str, Array]:
    """Columns in SI, by name, of a CSV file with a header such as ``frequency [Hz], storage modulus [kPa]``.

    Parameters
    ----------
    path
        File in UTF-8; blank lines and lines that begin with ``#`` are skipped.
    units
        Every column name that may occur (lower case, words apart) and the SI unit it is returned in.
    complete
        Whether every one of them must stand there.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If a column is unknown, repeated or missing, has no unit or a wrong one, or a row is not one finite number per
        column; with file and line.
    """
    table = read_table(path)
    place, header = one_line(path), [_column(table, cell, units) for cell in table.header]
    names = [name for name, _ in header]
    for name in names:
        if names.count(name) > 1:
            raise InvalidQuantity(f"{place}: column {name!r} stands there {names.count(name)} times; allowed: once")
    missing = [name for name in units if name not in names] if complete else []
    if missing:
        allowed = ", ".join(f"{name} [{unit}]" for name, unit in units.items())
        raise InvalidQuantity(f"{place}: no column {', '.join(missing)}; allowed: {allowed}")
    values = np.array(table.numbers(names), dtype=float).reshape(-1, len(names))
    return {name: values[:, k] * factor for k, (name, factor) in enumerate(header)}


def tests_by(columns: dict[str, Array], name: str, unit: str, fewest: int) -> Iterator[tuple[float, dict[str, Array]]]:
    """Each value of a column (n,), ascending, with the other columns of the rows that have it: the tests of one file.

    Raises
    ------
    InvalidQuantity
        If one has less than the ``fewest`` rows.
    """
    values = columns[name]
    for value in np.unique(values):
        rows = values == value
        if rows.sum() < fewest:
            raise InvalidQuantity(
                f"the {name} {value:g} {unit} stands in {rows.sum()} rows; allowed: at least {fewest} for each {name}, by which "
                f"tests are told apart: write the {name} that was set, not the one that was measured"
            )
        yield float(value), {other: column[rows] for other, column in columns.items() if other != name}


@contextmanager
def of_file(path: str | Path) -> Iterator[None]:
    """Names the file in what is refused of the numbers that were read from it.

    Raises
    ------
    InvalidQuantity
        If the block refuses a number, with the file.
    """
    try:
        yield
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{one_line(path)}: {error}") from None


def _column(table: Table, cell: str, units: dict[str, str]) -> tuple[str, float]:
    """Name and SI factor of a header cell."""
    place, match = one_line(table.name), _HEADER.fullmatch(cell)
    name = " ".join(match["name"].lower().replace("_", " ").split()) if match else ""
    if match is None or name not in units:
        allowed = f"allowed: {', '.join(units)}, each with its unit"
        raise InvalidQuantity(f"{place}: unknown column {table.quoted_header(cell)}; {allowed}")
    unit = (match["unit"] or "").strip()
    if not unit:
        hint = f"write it in brackets after the name, like '{name} [{units[name]}]'"
        raise InvalidQuantity(f"{place}: column {name!r} has no unit; {hint}")
    if unit == units[name]:
        return name, 1.0
    try:
        return name, parse_quantity(f"1 {unit}", "dimensionless" if units[name] == "1" else units[name])
    except InvalidQuantity as error:
        hint = f": {error}" if table.quotable else f" has another unit than {units[name]}"
        raise InvalidQuantity(f"{place}: column {name!r}{hint}") from None
