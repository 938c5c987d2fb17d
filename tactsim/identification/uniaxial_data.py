"""Measured uniaxial stress-stretch curves, read from CSV with their units."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.identification.table import Table, read_table
from tactsim.outside.files import named_path
from tactsim.outside.text import one_line
from tactsim.units import parse_quantity

FEWEST_POINTS = 3
MOST_PREAMBLE = 100
"""Lines above a header in which a testing machine may say what was tested."""

STRETCH_COLUMNS = ("stretch", "strain", "engineering_strain")
STRESS_COLUMNS = ("stress", "nominal_stress", "engineering_stress", "true_stress", "cauchy_stress")


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
                f"{self.source}: stretch = {stretch.min():g}; it must be > 0 (1 is rest, strain is stretch - 1; "
                "a strain in percent has a header such as strain [%])"
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

    def within(self, least: float, largest: float) -> UniaxialCurve:
        """The part of the curve between two strains, stretch - 1.

        Raises
        ------
        InvalidQuantity
            If too little is left.
        """
        if not least < largest:
            raise InvalidQuantity(f"strains from {least:g} to {largest:g}; allowed: from the lower one to the higher one")
        kept = (self.stretch >= 1 + least) & (self.stretch <= 1 + largest)
        where = f"{self.source}, strains {least:g} to {largest:g}"
        return UniaxialCurve(self.stretch[kept], self.nominal_stress[kept], where)


def read_uniaxial_curve(path: str | Path) -> UniaxialCurve:
    r"""The curve in a CSV file: a header such as ``strain [%], nominal stress [kPa]``, rows in any order, ``#`` before comments.

    What a testing machine writes above the header is passed over. Where a file holds true values beside nominal ones, the nominal
    ones are read.

    The first column may be ``stretch``, ``strain`` or ``engineering strain`` (with ``%`` for percent); the second ``stress``,
    ``nominal stress``, ``engineering stress``, ``true stress`` or ``cauchy stress``, with its unit in brackets or after ``_``.
    Capitals do not matter, nor whether ``_`` or a blank stands between words. A stress that is not called true is nominal; a true
    stress is divided by the stretch, as the material keeps its volume.

    >>> import tactsim as ts
    >>> from pathlib import Path
    >>> _ = Path("pulled.csv").write_text("strain [%], nominal stress [kPa]\n-10, -2.6\n10, 2.2\n20, 4.0\n")
    >>> ts.read_uniaxial_curve("pulled.csv").stretch
    array([0.9, 1.1, 1.2])

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If it holds no usable curve, with file and line.
    """
    table, name = _below_preamble(read_table(named_path(path, "read_uniaxial_curve"))), one_line(path)
    strain_at, strain_name, percent = _column(table, STRETCH_COLUMNS)
    stress_at, stress_name, unit = _column(table, STRESS_COLUMNS)
    factor = _stress_factor(table, stress_name, unit)
    values = np.array(table.numbers(), dtype=float).reshape(-1, len(table.header))
    stretch = values[:, strain_at] * _strain_factor(table, strain_name, percent)
    if strain_name != "stretch":
        stretch = 1 + stretch
    with np.errstate(all="ignore"):  # what is no number is refused by the curve
        stress = values[:, stress_at] * factor
        nominal = stress / stretch if stress_name in ("true_stress", "cauchy_stress") else stress
    return UniaxialCurve(stretch, nominal, name)


def _below_preamble(table: Table) -> Table:
    """The table below the first line that names a strain and a stress; all of it if none does."""
    for number, (at, line) in enumerate(table.lines[:MOST_PREAMBLE]):
        cells = [cell.lower() for cell in table.cells(at, line)]
        if any("strain" in cell or "stretch" in cell for cell in cells) and any("stress" in cell for cell in cells):
            return table.below(number)
    return table


def _column(table: Table, allowed: tuple[str, ...]) -> tuple[int, str, str]:
    """Position, name and unit text of the one column whose name is allowed."""
    columns = []
    for position, cell in enumerate(table.header):
        for name in sorted(allowed, key=len, reverse=True):
            words = name.replace("_", "[ _]+")
            match = re.fullmatch(rf"(?i:{words})(?:[ _]*[(\[]?(?P<unit>[^()\[\]\s]+)[)\]]?)?", cell)
            if match:
                columns.append((position, name, match["unit"] or ""))
                break
    nominal = [one for one in columns if not one[1].startswith(("true", "cauchy"))]
    if len(columns) > 1 and len(nominal) == 1:
        columns = nominal
    if len(columns) != 1:
        header = table.quoted_header(", ".join(table.header))
        needed = f"{', '.join(allowed)}, like 'strain [%], nominal stress [kPa]'"
        raise InvalidQuantity(f"{one_line(table.name)}: header {header} must have exactly one column of {needed}")
    return columns[0]


def _stress_factor(table: Table, name: str, unit: str) -> float:
    """Pa per unit of a stress column."""
    place = f"{one_line(table.name)}: column {name!r}"
    if not unit:
        raise InvalidQuantity(f"{place} has no unit; write it after the name, like nominal_stress_kPa or nominal stress [kPa]")
    try:
        return parse_quantity(f"1 {unit}", "Pa")
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{place}: {error}" if table.quotable else f"{place} has another unit than one of stress") from None


def _strain_factor(table: Table, name: str, unit: str) -> float:
    """1 for a plain number, 0.01 for percent."""
    if unit.lower() not in ("", "-", "1", "%", "percent"):
        place = f"{one_line(table.name)}: column {name!r} has the unit {table.quoted_header(unit)}"
        raise InvalidQuantity(f"{place}: stretch and strain are dimensionless; allowed are no unit, % or percent")
    return 0.01 if unit.lower() in ("%", "percent") else 1.0
