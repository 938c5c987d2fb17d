"""Measured uniaxial stress-stretch curves, read from CSV with their units."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.identification.columns import data_lines
from tactsim.interfaces import Array
from tactsim.units import parse_quantity

FEWEST_POINTS = 3

STRETCH_COLUMNS = ("stretch", "strain", "engineering_strain")
STRESS_COLUMNS = ("nominal_stress", "engineering_stress", "true_stress", "cauchy_stress")


@dataclass(frozen=True)
class UniaxialCurve:
    """Nominal stress against stretch, tension positive, sorted by stretch.

    Raises
    ------
    InvalidQuantity
        If the data cannot be used, with the reason.
    """

    stretch: Array
    """Length over rest length, dimensionless, shape (n,)."""
    nominal_stress: Array
    """Force over rest area in Pa, shape (n,)."""
    source: str
    """Where the data come from."""

    def __post_init__(self) -> None:
        stretch, stress = (np.array(x, dtype=float).ravel() for x in (self.stretch, self.nominal_stress))
        if stretch.shape != stress.shape:
            raise InvalidQuantity(f"{self.source}: {stretch.size} stretches but {stress.size} stresses")
        if not (np.isfinite(stretch).all() and np.isfinite(stress).all()):
            raise InvalidQuantity(f"{self.source}: a stretch or a stress is not finite")
        if (stretch <= 0).any():
            raise InvalidQuantity(
                f"{self.source}: stretch = {stretch.min():g}; it must be > 0 (1 is rest, strain is stretch - 1)"
            )
        if np.unique(stretch[stretch != 1]).size < FEWEST_POINTS:
            raise InvalidQuantity(f"{self.source}: needs at least {FEWEST_POINTS} different stretches other than 1")
        if stress @ (stretch - 1) <= 0:
            raise InvalidQuantity(
                f"{self.source}: stress must have the sign of stretch - 1: tension positive, compression negative"
            )
        order = np.argsort(stretch, kind="stable")
        object.__setattr__(self, "stretch", stretch[order])
        object.__setattr__(self, "nominal_stress", stress[order])


def read_uniaxial_curve(path: str | Path) -> UniaxialCurve:
    """The curve in a CSV file: a header such as ``stretch,nominal_stress_kPa``, rows in any order, ``#`` before comments.

    The first column may be ``stretch``, ``strain`` or ``engineering_strain`` (with ``_%`` for percent); the second
    ``nominal_stress``, ``engineering_stress``, ``true_stress`` or ``cauchy_stress``, with its unit after ``_`` or in brackets.
    A true stress is divided by the stretch, as the material keeps its volume.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If it holds no usable curve, with file and line.
    """
    rows = data_lines(path)
    header = [cell.strip() for cell in next(csv.reader([rows[0][1]]))]
    strain_at, strain_name, percent = _column(path, header, STRETCH_COLUMNS)
    stress_at, stress_name, unit = _column(path, header, STRESS_COLUMNS)
    factor = _stress_factor(path, header[stress_at], unit)
    values = np.array([_numbers(f"{path}:{number}", line, len(header)) for number, line in rows[1:]]).reshape(-1, len(header))
    stretch = values[:, strain_at] * _strain_factor(path, header[strain_at], percent)
    if strain_name != "stretch":
        stretch = 1 + stretch
    stress = values[:, stress_at] * factor
    return UniaxialCurve(stretch, stress / stretch if stress_name in ("true_stress", "cauchy_stress") else stress, str(path))


def _column(path: str | Path, header: list[str], allowed: tuple[str, ...]) -> tuple[int, str, str]:
    """Position, name and unit text of the one column whose name is allowed."""
    found = []
    for position, cell in enumerate(header):
        for name in sorted(allowed, key=len, reverse=True):
            match = re.fullmatch(rf"{name}(?:[ _]*[(\[]?(?P<unit>[^()\[\]\s]+)[)\]]?)?", cell)
            if match:
                found.append((position, name, match["unit"] or ""))
                break
    if len(found) != 1:
        hint = "; columns are separated by commas" if any(";" in cell or "\t" in cell for cell in header) else ""
        raise InvalidQuantity(f"{path}: header {', '.join(header)!r} must have exactly one column of {', '.join(allowed)}{hint}")
    return found[0]


def _stress_factor(path: str | Path, column: str, unit: str) -> float:
    """Pa per unit of a stress column."""
    if not unit:
        raise InvalidQuantity(f"{path}: column {column!r} has no unit; write it after the name, like nominal_stress_kPa")
    try:
        return parse_quantity(f"1 {unit}", "Pa")
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{path}: column {column!r}: {error}") from None


def _strain_factor(path: str | Path, column: str, unit: str) -> float:
    """1 for a plain number, 0.01 for percent."""
    if unit not in ("", "%", "percent"):
        raise InvalidQuantity(
            f"{path}: column {column!r}: stretch and strain are dimensionless; allowed are no unit, % or percent"
        )
    return 1.0 if unit == "" else 0.01


def _numbers(place: str, line: str, columns: int) -> list[float]:
    """The finite numbers of one row."""
    cells = next(csv.reader([line]))
    try:
        numbers = [float(cell) for cell in cells]
    except ValueError:
        raise InvalidQuantity(f"{place}: {line.strip()!r} is not a row of numbers") from None
    if len(numbers) != columns:
        raise InvalidQuantity(f"{place}: {len(numbers)} values in a row of {columns} columns")
    if not np.isfinite(numbers).all():
        raise InvalidQuantity(f"{place}: {line.strip()!r} holds a value that is not finite")
    return numbers
