"""Columns of numbers from CSV files whose header names every quantity and its unit."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Array
from tactsim.outside.files import opened
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
    rows = data_lines(path)
    header = [_column(path, cell, units) for cell in _cells(f"{path}:{rows[0][0]}", rows[0][1])]
    names = [name for name, _ in header]
    for name in names:
        if names.count(name) > 1:
            raise InvalidQuantity(f"{path}: column {name!r} stands there {names.count(name)} times; allowed: once")
    missing = [name for name in units if name not in names] if complete else []
    if missing:
        allowed = ", ".join(f"{name} [{unit}]" for name, unit in units.items())
        raise InvalidQuantity(f"{path}: no column {', '.join(missing)}; allowed: {allowed}")
    values = np.array([_numbers(f"{path}:{number}", line, names) for number, line in rows[1:]]).reshape(-1, len(names))
    return {name: values[:, k] * factor for k, (name, factor) in enumerate(header)}


def data_lines(path: str | Path) -> list[tuple[int, str]]:
    """Header and data lines with their numbers, without blanks and comments.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If nothing is left.
    """
    lines = opened(path, "table").text().splitlines()
    rows = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise InvalidQuantity(f"{path}: no header and no data")
    return rows


def _column(path: str | Path, cell: str, units: dict[str, str]) -> tuple[str, float]:
    """Name and SI factor of a header cell."""
    match = _HEADER.fullmatch(cell.strip())
    name = " ".join(match["name"].lower().replace("_", " ").split()) if match else ""
    if match is None or name not in units:
        hint = "; columns are separated by commas" if ";" in cell or "\t" in cell else ""
        raise InvalidQuantity(f"{path}: unknown column {cell.strip()!r}; allowed: {', '.join(units)}, each with its unit{hint}")
    if not (match["unit"] or "").strip():
        raise InvalidQuantity(
            f"{path}: column {cell.strip()!r} has no unit; write it in brackets after the name, like '{name} [{units[name]}]'"
        )
    if match["unit"].strip() == units[name]:
        return name, 1.0
    try:
        return name, parse_quantity(f"1 {match['unit'].strip()}", "dimensionless" if units[name] == "1" else units[name])
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{path}: column {cell.strip()!r}: {error}") from None


def _numbers(place: str, line: str, names: list[str]) -> list[float]:
    """The finite numbers of one row."""
    cells = _cells(place, line)
    if len(cells) != len(names):
        raise InvalidQuantity(f"{place}: {len(cells)} values in a row of {len(names)} columns")
    return [_number(place, cell, name) for cell, name in zip(cells, names, strict=True)]


def _cells(place: str, line: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise InvalidQuantity(f"{place}: {error}; allowed: one number per column") from None


def _number(place: str, cell: str, name: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidQuantity(f"{place}: {name} is {cell.strip()!r}; allowed: a finite number")
    return value
