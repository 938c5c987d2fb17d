"""Distributions that a sweep has where a case has one value: each turns a number in [0, 1) into a value of the case."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from tactsim.errors import InvalidQuantity, shown
from tactsim.units import parse_quantity

SI_UNITS = ("m", "Pa", "N", "s", "Hz", "m/s", "rad", "ohm", "S", "V", "Pa*s", "J", "kg", "m^2", "kg/m^3", "S/N", "Pa/N", "ohm*m")
"""Units in which drawn quantities are stored."""
MOST_OPTIONS = 100_000
"""Entries of a list or range."""
ENTRIES = {
    "uniform": "[least, largest]",
    "log_uniform": "[least, largest]",
    "normal": "[mean, standard deviation]",
    "integer": "[first, last]",
    "range": "[first, last, number of values]",
    "values": "[value, value, ...]",
    "choice": "[option, option, ...]",
}
"""Name in a file -> what its list holds."""
BESIDE = {"choice": "weights", "values": "weights", "normal": "within"}
"""Name in a file -> the key that may stand beside it."""


class Distribution(ABC):
    """How the value of one place of a case varies."""

    @property
    def unit(self) -> str:
        """SI unit of the stored numbers; empty for plain numbers and for the index of an option."""
        return ""

    @property
    def options(self) -> tuple[Any, ...] | None:
        """What is chosen from; None where that is not a list."""
        return None

    def shares(self) -> Iterator[tuple[Any, float, float]]:
        """Each option, the number that is stored for it, and its probability; nothing where it is no list."""
        yield from ()

    @abstractmethod
    def value(self, share: float) -> tuple[Any, float]:
        """The value as a case file writes it, and the number to store, for a share in [0, 1) of the probability."""


@dataclass(frozen=True)
class Numbers:
    """Numbers in the unit that the file writes; ``factor`` turns them into ``unit``."""

    values: tuple[float, ...]
    written_unit: str
    unit: str
    factor: float

    def written(self, number: float) -> tuple[Any, float]:
        """The number as a case file writes it, and in SI."""
        text = f"{number:.15g}"
        return (f"{text} {self.written_unit}" if self.written_unit else float(text)), float(f"{float(text) * self.factor:.15g}")


@dataclass(frozen=True)
class Continuous(Distribution):
    """A uniform, log-uniform or (truncated) normal distribution."""

    name: str
    numbers: Numbers
    limits: tuple[float, float] = (-math.inf, math.inf)

    @property
    def unit(self) -> str:
        """SI unit of the stored numbers."""
        return self.numbers.unit

    def value(self, share: float) -> tuple[Any, float]:
        """The quantile of a share from 0 to 1."""
        first, second = self.numbers.values
        if self.name == "uniform":
            return self.numbers.written(first + share * (second - first))
        if self.name == "log_uniform":
            return self.numbers.written(first * (second / first) ** share)
        begin, end = ((limit - first) / second for limit in self.limits)
        normal = -_normal_quantile(1 - share, -end, -begin) if begin > 0 else _normal_quantile(share, begin, end)
        return self.numbers.written(float(np.clip(first + second * normal, *self.limits)))


def _normal_quantile(share: float, begin: float, end: float) -> float:
    """Quantile of a standard normal distribution between two numbers, the first below its mean, as digits are lost near one."""
    low, high = scipy.special.ndtr((begin, end))
    return float(scipy.special.ndtri(np.clip(low + share * (high - low), np.finfo(float).tiny, 1 - np.finfo(float).epsneg)))


@dataclass(frozen=True)
class Whole(Distribution):
    """Whole numbers of a range, both ends included, equally probable."""

    low: int
    high: int

    def value(self, share: float) -> tuple[Any, float]:
        """The whole number."""
        number = min(self.low + int(share * (self.high - self.low + 1)), self.high)
        return number, float(number)


@dataclass(frozen=True)
class Listed(Distribution):
    """Options with their probabilities; numbers and quantities are stored as such, anything else by its index."""

    entries: tuple[Any, ...]
    cumulative: tuple[float, ...]
    numbers: Numbers | None

    @property
    def options(self) -> tuple[Any, ...]:
        """What is chosen from."""
        return self.entries

    @property
    def unit(self) -> str:
        """SI unit of the stored numbers."""
        return self.numbers.unit if self.numbers else ""

    def index(self, share: float) -> int:
        """Which option."""
        return min(int(np.searchsorted(self.cumulative, share, side="right")), len(self.entries) - 1)

    def shares(self) -> Iterator[tuple[Any, float, float]]:
        """Each option, the number that is stored for it, and its probability, equal ones together."""
        together: dict[float, tuple[Any, float]] = {}
        for index, share in enumerate(np.diff(self.cumulative, prepend=0.0)):
            number = self._number(index)
            option, before = together.get(number, (self.entries[index], 0.0))
            together[number] = option, before + float(share)
        yield from ((option, number, share) for number, (option, share) in together.items())

    def value(self, share: float) -> tuple[Any, float]:
        """The option."""
        index = self.index(share)
        return self.entries[index], self._number(index)

    def _number(self, index: int) -> float:
        return float(index) if self.numbers is None else self.numbers.written(self.numbers.values[index])[1]


def distribution(written: dict[str, Any]) -> Distribution:
    """The distribution of a mapping such as ``{uniform: [2 mm, 7 mm]}``.

    Raises
    ------
    InvalidQuantity
        With what is wrong and what is expected.
    """
    names = [name for name in written if name in READERS]
    if len(names) != 1:
        raise InvalidQuantity(f"{shown(written)} is not one distribution; allowed: one of {', '.join(READERS)}")
    name, beside = names[0], BESIDE.get(names[0], "nothing")
    if extra := [key for key in written if key not in (name, beside)]:
        raise InvalidQuantity(f"{shown(written)} is not one distribution: {shown(extra[0])} beside {name}; allowed: {beside}")
    entries = written[name]
    if not isinstance(entries, list) or not 1 <= len(entries) <= MOST_OPTIONS:
        most = f" of at most {MOST_OPTIONS} entries" if isinstance(entries, list) and entries else ""
        raise InvalidQuantity(f"{name} takes a list{most}, {ENTRIES[name]}, not {shown(entries)}")
    return READERS[name](entries, written)


def _bounded(name: str) -> Callable[[list[Any], dict[str, Any]], Distribution]:
    def read(entries: list[Any], written: dict[str, Any]) -> Distribution:
        numbers = _pair(name, entries)
        low, high = numbers.values
        if low >= high:
            raise InvalidQuantity(f"{name}: {shown(entries)} must increase")
        if name == "log_uniform" and low <= 0:
            raise InvalidQuantity(f"log_uniform: {shown(entries)} must be positive")
        return Continuous(name, numbers)

    return read


def _normal(entries: list[Any], written: dict[str, Any]) -> Distribution:
    numbers = _pair("normal", entries)
    if numbers.values[1] <= 0:
        raise InvalidQuantity(f"normal: {shown(entries)} are mean and standard deviation; the latter must be positive")
    if "within" not in written:
        return Continuous("normal", numbers)
    mean, low, high = measured([entries[0], *_listed("within", written["within"], 2)]).values
    begin, end = ((limit - mean) / numbers.values[1] for limit in (low, high))
    begin, end = (-end, -begin) if begin > 0 else (begin, end)
    if not scipy.special.ndtr(begin) < scipy.special.ndtr(end):
        raise InvalidQuantity(f"normal: within {shown(written['within'])} must increase and hold a part of the distribution")
    return Continuous("normal", numbers, (low, high))


def _whole(entries: list[Any], written: dict[str, Any]) -> Distribution:
    low, high = _listed("integer", entries, 2)
    if not all(type(end) is int for end in (low, high)) or low > high:
        raise InvalidQuantity(f"integer: {shown(entries)} must be two increasing whole numbers")
    return Whole(low, high)


def _range(entries: list[Any], written: dict[str, Any]) -> Distribution:
    *ends, count = _listed("range", entries, 3)
    if type(count) is not int or not 2 <= count <= MOST_OPTIONS:
        raise InvalidQuantity(f"range: {shown(entries)} must be [first, last, number of values >= 2]")
    numbers = measured(ends)
    first, last = numbers.values
    values = tuple(float(f"{value:.15g}") for value in np.linspace(first, last, count))
    spread = Numbers(values, numbers.written_unit, numbers.unit, numbers.factor)
    return Listed(tuple(spread.written(value)[0] for value in values), _cumulative(None, count), spread)


def _options(entries: list[Any], written: dict[str, Any]) -> Distribution:
    cumulative = _cumulative(written.get("weights"), len(entries))
    return Listed(tuple(entries), cumulative, measured(entries) if all(map(_is_measured, entries)) else None)


def _values(entries: list[Any], written: dict[str, Any]) -> Distribution:
    return Listed(tuple(entries), _cumulative(written.get("weights"), len(entries)), measured(entries))


def _cumulative(weights: Any, count: int) -> tuple[float, ...]:
    given = np.ones(count) if weights is None else np.array(measured(_listed("weights", weights, count)).values)
    if (given < 0).any() or given.sum() <= 0:
        raise InvalidQuantity(f"weights: {shown(weights)} must be positive or zero, and not all zero")
    return tuple(np.cumsum(given / given.sum()))


def _pair(name: str, entries: list[Any]) -> Numbers:
    return measured(_listed(name, entries, 2))


def _listed(name: str, entries: Any, count: int) -> list[Any]:
    if not isinstance(entries, list) or len(entries) != count:
        meaning = f", {ENTRIES[name]}" if name in ENTRIES else ""
        raise InvalidQuantity(f"{name}: {shown(entries)} must be a list of {count}{meaning}")
    return entries


def _is_measured(entry: Any) -> bool:
    if isinstance(entry, str):
        return _parts(entry) is not None
    return isinstance(entry, int | float) and not isinstance(entry, bool)


def _parts(text: str) -> tuple[str, str, float] | None:
    """Unit of a quantity's text, the SI unit of its dimension and how much of it that is; None if it is no quantity."""
    unit = text.strip().lstrip("+-0123456789.eE").strip() if text.strip()[:1] in "+-.0123456789" else ""
    for si in SI_UNITS if unit else ():
        try:
            return unit, si, parse_quantity(f"1 {unit}", si)
        except InvalidQuantity:
            continue
    return None


def measured(entries: Sequence[Any]) -> Numbers:
    """Plain numbers, or quantities of one dimension in the unit of the first.

    Raises
    ------
    InvalidQuantity
        If an entry is neither, or they do not belong together.
    """
    wrong = [entry for entry in entries if not _is_measured(entry)]
    if wrong:
        raise InvalidQuantity(f"{shown(wrong[0])} is not a number or a quantity with its unit")
    texts = [isinstance(entry, str) for entry in entries]
    if any(texts) != all(texts):
        raise InvalidQuantity(f"{shown(list(entries))} mixes plain numbers and quantities")
    if not any(texts):
        endless = [entry for entry in entries if not math.isfinite(entry)]
        if endless:
            raise InvalidQuantity(f"{shown(endless[0])} is not a finite number")
        return Numbers(tuple(map(float, entries)), "", "", 1.0)
    parts = _parts(entries[0])
    assert parts is not None  # every entry was checked above
    unit, si, factor = parts
    return Numbers(tuple(parse_quantity(entry, unit) for entry in entries), unit, si, factor)


READERS = {
    "uniform": _bounded("uniform"),
    "log_uniform": _bounded("log_uniform"),
    "normal": _normal,
    "integer": _whole,
    "range": _range,
    "values": _values,
    "choice": _options,
}
"""Name in a file -> reader of its entries."""
