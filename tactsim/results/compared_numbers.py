"""The numbers of several results side by side: each in the unit that suits it, of arrays the largest and how far they differ."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.results.quantity import ROUND_OFF, Quantity
from tactsim.results.result import Result
from tactsim.units import compact_unit, conversion

FROM_FIRST = "largest difference of "
"""Beginning of the name of a column of how far an array is from that of the first result."""
ONE_SIDED = "numbers on one side of "
"""Beginning of the name of a column of how many numbers only an array has, or only that of the first result."""
LARGEST = "largest "
"""Beginning of the name of a column of the largest value of an array, whatever its sign."""
OF_ARRAYS = (FROM_FIRST, ONE_SIDED, LARGEST)
"""What the names of columns of arrays begin with."""
CLOSE = 1e-9
"""Relative distance of two values along an axis, such as times, that are the same."""


@dataclass(frozen=True)
class Column:
    """A number of several results in the unit that suits them; None where a result does not have it."""

    name: str
    unit: str
    description: str
    values: tuple[float | None, ...]
    round_off: float = 0.0
    """Differences up to this size, in the same unit, are round-off."""

    @property
    def head(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit not in ("", "1") else self.name

    @property
    def differs(self) -> bool:
        """Whether five digits tell the results apart, by more than round-off; an array that one does not have tells nothing."""
        numbers = [value for value in self.values if value is not None]
        if self.name.startswith((FROM_FIRST, ONE_SIDED)):
            return any(numbers)
        if self.name.startswith(LARGEST) or len(numbers) == len(self.values):
            return len(set(map(shown_number, numbers))) > 1 and not max(numbers) - min(numbers) <= self.round_off
        return bool(numbers)


def shown_number(value: float | None) -> str:
    """Five digits, empty for None."""
    return "" if value is None else f"{value:.5g}"


def columns_of(results: Sequence[Result]) -> list[Column]:
    """A column for every number that one of the results has, and for every array what is largest in it and in its difference."""
    first_of: dict[str, Quantity] = {}
    for result in results:
        for name, quantity in result.quantities.items():
            if quantity.value is not None:
                first_of.setdefault(name, quantity)
    sizes = _sizes(results)
    columns: list[Column] = []
    for name, first in first_of.items():
        same_unit = [one if (one := result.quantities.get(name)) and one.unit == first.unit else None for result in results]
        if isinstance(first.value, int | float):
            values = [float(one.value) if one and isinstance(one.value, int | float) else None for one in same_unit]
            columns.append(_column(name, first, values, sizes))
        elif any(one is not None and _finite(one).size for one in same_unit):
            columns += _of_array(name, first, [r if one else None for r, one in zip(results, same_unit, strict=True)], sizes)
    return columns


def _of_array(name: str, first: Quantity, results: Sequence[Result | None], sizes: Mapping[str, float]) -> list[Column]:
    """The largest of an array in each result, and its largest difference from that of the first, where that can be told."""
    held = [None if result is None else result[name] for result in results]
    peaks = [float(np.abs(values).max()) if one and (values := _finite(one)).size else None for one in held]
    columns = [_column(f"{LARGEST}{name}", first, peaks, sizes)]
    apart = [None, *(difference(held[0], one) for one in held[1:])]
    far = [None if one is None else float(np.nanmax(np.abs(one), initial=0.0)) for one in apart]
    if any(one is not None for one in far):
        limit = ROUND_OFF * max([*(peak for peak in peaks if peak), _size_of(first.unit, sizes)])
        far = [0.0 if one is not None and one <= limit else one for one in far]
        columns.append(_column(f"{FROM_FIRST}{name}", first, far, sizes))
    alone = [None if gap is None else _one_sided(held[0], one) for gap, one in zip(apart, held, strict=True)]
    if any(alone):
        columns.append(Column(f"{ONE_SIDED}{name}", "", first.description, tuple(alone)))
    return columns


def _one_sided(first: Quantity | None, other: Quantity | None) -> float | None:
    """At how many places only one of two arrays of one shape has a number; None if one is not there."""
    if first is None or other is None:
        return None
    return float(np.count_nonzero(np.isfinite(first.numbers) != np.isfinite(other.numbers)))


def difference(first: Quantity | None, other: Quantity | None) -> np.ndarray | None:
    """An array less another of the same shape, 0 where that is round-off; None if there is none, or they lie at other times.

    Taxels are held against those of the same row and column, wherever they are.
    """
    if first is None or other is None or first.unit != other.unit or not first.numbers.ndim:
        return None
    if first.numbers.shape != other.numbers.shape or not _at_the_same(first, other):
        return None
    apart: np.ndarray = other.numbers - first.numbers
    largest = max(float(np.abs(_finite(one)).max(initial=0.0)) for one in (first, other))
    return np.where(np.abs(apart) <= ROUND_OFF * largest, 0.0, apart)


def _at_the_same(first: Quantity, other: Quantity) -> bool:
    """Whether two arrays have the same values along their axes, such as times, where both are known."""
    for name, one in first.coordinates.items():
        beside = other.coordinates.get(name)
        if name != one.axis or name in ("row", "column") or beside is None:
            continue
        if one.unit == "" and one.values != beside.values:
            return False
        if one.unit != "" and not np.allclose(one.values, beside.values, rtol=CLOSE, atol=0.0):
            return False
    return True


def _finite(quantity: Quantity) -> np.ndarray:
    values = quantity.numbers
    return values[np.isfinite(values)]


def _sizes(results: Sequence[Result]) -> dict[str, float]:
    """The largest size in all results of what has a unit: beside it the round-off of a sum is seen."""
    sizes: dict[str, float] = {}
    for result in results:
        for quantity in result.quantities.values():
            largest = float(np.abs(_finite(quantity)).max(initial=0.0))
            sizes[quantity.unit] = max(largest, sizes.get(quantity.unit, 0.0))
    return sizes


def _size_of(unit: str, sizes: Mapping[str, float]) -> float:
    """The size beside which a number is round-off; a plain number stands beside 1, counts say nothing of it."""
    return 1.0 if unit in ("", "1") else sizes[unit]


def _column(name: str, about: Quantity, values: Sequence[float | None], sizes: Mapping[str, float]) -> Column:
    """A column of values in SI."""
    largest = max((abs(value) for value in values if value is not None and math.isfinite(value)), default=0.0)
    readable = compact_unit(largest, about.unit)
    factor = conversion(about.unit, readable)
    shown = tuple(None if value is None else value * factor for value in values)
    return Column(name, readable, about.description, shown, ROUND_OFF * factor * _size_of(about.unit, sizes))
