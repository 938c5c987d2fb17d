"""Several results in one table: a row for each, a column for every number that one of them has."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from tactsim.outside.text import markdown_row
from tactsim.results.result import Result
from tactsim.units import compact_unit, conversion

UnitOf = Callable[[Mapping[str, Any], tuple[str | int, ...]], str]
"""SI unit of a number by the experiment of its case and its key path in it; empty without one."""
NameOf = Callable[[Mapping[str, Any]], str]
"""Name of a part of a case, such as that of a shipped material; empty without one."""


@dataclass(frozen=True)
class Column:
    """A number of several results in the unit that suits them; None where a result does not have it."""

    name: str
    unit: str
    description: str
    values: tuple[float | None, ...]

    @property
    def head(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit not in ("", "1") else self.name


@dataclass(frozen=True)
class Comparison:
    """Names, status and numbers of several results."""

    names: tuple[str, ...]
    statuses: tuple[str, ...]
    columns: tuple[Column, ...]
    inputs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Key of the case with its unit -> its value in each result, where they differ."""

    @property
    def differing(self) -> tuple[Column, ...]:
        """The columns in which the results are not all the same."""
        return tuple(column for column in self.columns if len(set(map(shown_number, column.values))) > 1)

    def csv_text(self) -> str:
        """A row for each result; what it does not have is empty."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["result", "status", *self.inputs, *(column.head for column in self.columns)])
        for row, (name, status) in enumerate(zip(self.names, self.statuses, strict=True)):
            given = [values[row] for values in self.inputs.values()]
            writer.writerow(
                [name, status, *given, *("" if (v := column.values[row]) is None else repr(v) for column in self.columns)]
            )
        return text.getvalue()

    def markdown_text(self) -> str:
        """A row for each number, a column for each result, five digits."""
        lines = [f"| {markdown_row(self.names)}", f"|---{'|---:' * len(self.names)}|", markdown_row(["status", *self.statuses])]
        lines += [markdown_row([key, *values]) for key, values in self.inputs.items()]
        lines += [markdown_row([column.head, *map(shown_number, column.values)]) for column in self.columns]
        return "\n".join(lines) + "\n"


def shown_number(value: float | None) -> str:
    """Five digits, empty for None."""
    return "" if value is None else f"{value:.5g}"


def compared(results: Mapping[str, Result], unit_of: UnitOf, name_of: NameOf = lambda part: "") -> Comparison:
    """The numbers of results by their names, in the order in which they come."""
    names: dict[str, tuple[str, str]] = {}
    for result in results.values():
        for name, quantity in result.quantities.items():
            if isinstance(quantity.value, int | float):
                names.setdefault(name, (quantity.unit, quantity.description))
    columns = [_column(name, *about, results) for name, about in names.items()]
    statuses = tuple(str(result.status) for result in results.values())
    return Comparison(tuple(results), statuses, tuple(columns), _differing_inputs(results, unit_of, name_of))


def _differing_inputs(results: Mapping[str, Result], unit_of: UnitOf, name_of: NameOf) -> dict[str, tuple[str, ...]]:
    """Values of the cases, by key and unit, that are not the same in all results; empty where a case has no such key.

    A key that has another unit in a case of another kind, as that of a force and of a displacement, has a row for each. One with
    the name of a quantity, such as ``displacement``, is ``experiment.displacement``, as it is elsewhere.
    """
    experiments = [result.provenance.get("case", {}).get("experiment", {}) for result in results.values()]
    cases = [dict(_leaves(experiment, (), name_of)) for experiment in experiments]
    differing: dict[str, tuple[str, ...]] = {}
    for path in dict.fromkeys(path for case in cases for path in case):
        values = [case.get(path) for case in cases]
        if len(set(map(_text, values))) > 1:
            units = [unit_of(one, path) if path in case else None for one, case in zip(experiments, cases, strict=True)]
            for unit in dict.fromkeys(unit for unit in units if unit is not None):
                of_unit = [value if one == unit else None for value, one in zip(values, units, strict=True)]
                name = ".".join(map(str, path))
                twice = any(name in result.quantities for result in results.values())
                differing |= dict([_in_unit(f"experiment.{name}" if twice else name, of_unit, unit)])
    return differing


def _in_unit(name: str, values: list[Any], unit: str) -> tuple[str, tuple[str, ...]]:
    """The head and the texts of a row of the cases' values, which are numbers in SI if they have a unit."""
    sizes = [abs(value) for value in values if isinstance(value, int | float)]
    readable = compact_unit(max(sizes, default=0.0), unit)
    factor = conversion(unit, readable) if readable else 1.0
    return f"{name} [{readable}]" if readable else name, tuple(_text(value, factor) for value in values)


def _text(value: Any, factor: float = 1.0) -> str:
    if value is None:
        return ""
    return f"{factor * value:.5g}" if isinstance(value, float) else str(value)


def _leaves(value: Any, path: tuple[str | int, ...], name_of: NameOf) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Key path and value of everything in a case that is no list or mapping, and of what has a name its name before."""
    if isinstance(value, Mapping) and (name := name_of(value)):
        yield path, name
    if isinstance(value, Mapping | list | tuple):
        for key, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _leaves(item, (*path, key), name_of)
    else:
        yield path, value


def _column(name: str, unit: str, description: str, results: Mapping[str, Result]) -> Column:
    quantities = [result.quantities.get(name) for result in results.values()]
    values = [
        float(one.value) if one is not None and one.unit == unit and isinstance(one.value, int | float) else None
        for one in quantities
    ]
    sizes = [abs(value) for value in values if value is not None and math.isfinite(value)]
    readable = compact_unit(max(sizes, default=0.0), unit)
    factor = conversion(unit, readable)
    return Column(name, readable, description, tuple(None if value is None else value * factor for value in values))
