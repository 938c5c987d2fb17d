"""Several results in one table: a row for each, a column for every number that one of them has."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from tactsim.outside.text import markdown_row, one_line
from tactsim.results.compared_numbers import FROM_FIRST, Column, columns_of, shown_number
from tactsim.results.result import Result
from tactsim.units import compact_unit, conversion

UnitOf = Callable[[Mapping[str, Any], tuple[str | int, ...]], str]
"""SI unit of a number by the experiment of its case and its key path in it; empty without one."""
NameOf = Callable[[Mapping[str, Any]], str]
"""Name of a part of a case, such as that of a shipped material; empty without one."""


@dataclass(frozen=True)
class Comparison:
    """Names, status, warnings and numbers of several results."""

    names: tuple[str, ...]
    statuses: tuple[str, ...]
    columns: tuple[Column, ...]
    inputs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Key of the case with its unit -> its value in each result, where they differ."""
    warnings: tuple[tuple[str, ...], ...] = ()
    """Those of each result."""

    @property
    def differing(self) -> tuple[Column, ...]:
        """The columns in which the results are not all the same."""
        return tuple(column for column in self.columns if column.differs)

    @property
    def counted_warnings(self) -> tuple[str, ...]:
        """How many warnings each result has."""
        return tuple(str(len(dict.fromkeys(one))) for one in self.warnings or ((),) * len(self.names))

    @property
    def warned(self) -> dict[str, tuple[str, ...]]:
        """Every warning -> the names of the results that have it."""
        texts = dict.fromkeys(text for one in self.warnings for text in one)
        return {text: tuple(n for n, one in zip(self.names, self.warnings, strict=True) if text in one) for text in texts}

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known to read the names of the numbers."""
        if not any(column.name.startswith(FROM_FIRST) for column in self.columns):
            return ()
        return (f"The largest difference of an array is that from {one_line(self.names[0])}; signs do not count.",)

    def csv_text(self) -> str:
        """A row for each result; what it does not have is empty."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["result", "status", "warnings", *self.inputs, *(column.head for column in self.columns)])
        for row, (name, status) in enumerate(zip(self.names, self.statuses, strict=True)):
            given = [values[row] for values in self.inputs.values()]
            writer.writerow(
                [name, status, self.counted_warnings[row], *given]
                + ["" if (v := column.values[row]) is None else repr(v) for column in self.columns]
            )
        return text.getvalue()

    def markdown_text(self) -> str:
        """A row for each number, a column for each result, five digits; then every warning with the results that have it."""
        lines = [f"| {markdown_row(self.names)}", f"|---{'|---:' * len(self.names)}|", markdown_row(["status", *self.statuses])]
        lines.append(markdown_row(["warnings", *self.counted_warnings]))
        lines += [markdown_row([key, *values]) for key, values in self.inputs.items()]
        lines += [markdown_row([column.head, *map(shown_number, column.values)]) for column in self.columns]
        lines += [line for note in self.notes for line in ("", note)]
        if self.warned:
            lines += ["", "Warnings:", ""]
            lines += [f"- {', '.join(map(one_line, names))}: {one_line(text)}" for text, names in self.warned.items()]
        return "\n".join(lines) + "\n"


def compared(results: Mapping[str, Result], unit_of: UnitOf, name_of: NameOf = lambda part: "") -> Comparison:
    """The numbers and warnings of results by their names, in the order in which they come."""
    given = _differing_inputs(results, unit_of, name_of)
    statuses = tuple(str(result.status) for result in results.values())
    warnings = tuple(result.warnings for result in results.values())
    return Comparison(tuple(results), statuses, tuple(columns_of(list(results.values()))), given, warnings)


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
