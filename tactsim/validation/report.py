"""The comparison in words for the terminal, as JSON and as Markdown."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, get_args

from tactsim.outside.text import aligned, markdown_table
from tactsim.units import format_quantity
from tactsim.validation.comparison import LEFT, RowOutcome, TableOutcome, figure_text
from tactsim.validation.endings import AFTER, LABELS, REPEATED, Origin, Outside, Regression, Reproduced, Transcribed
from tactsim.validation.limits import Bound, Tolerance
from tactsim.validation.loading import LoadedTables
from tactsim.validation.pictures import parts, placed_pictures
from tactsim.version import __version__

HEADER = ("row", "from", "expected", "computed", "ratio", "allowed", "ended as")
CLASSES = (*LABELS, LEFT)
SHORT = {AFTER: "after erratum", "inside a range": "in range"}
"""Classes whose names are too long for a column."""
_COLUMNS = tuple(SHORT.get(label, label) for label in CLASSES)
COUNT_HEADER, ORIGIN_HEADER = ("chapter", "table", "rows", *_COLUMNS), ("from", *_COLUMNS)
"""Heads of the tables of `count_rows` and `count_origins`."""
ORIGINS = get_args(Origin)
MEANINGS = {
    "reproduced": "the expected number comes out within a tolerance whose reason is given",
    AFTER: "it comes out once an error of the thesis is corrected",
    "confirmed": "a claim that is no number holds",
    "inside a range": "the expected number lies inside an interval that was computed without it",
    "outside": "it does not come out; by what factor, and the presumed cause",
    "contradicted": "a claim does not hold",
    "transcribed": "an input, or an equation with the same inputs on both sides: it was copied well, and nothing else is shown",
    "regression": "a number of this program: it shows that the program has changed, never that it is right",
    "not testable": "nothing to compare, and why",
    REPEATED: "it follows from another row, which its reason names: held as it ended, and not counted a second time",
    LEFT: "it did not end as recorded: the validation fails",
}


@dataclass(frozen=True)
class Validation:
    """A group of tables and how they ended."""

    loaded: LoadedTables
    outcomes: tuple[TableOutcome, ...]

    @property
    def name(self) -> str:
        """Name of the group: ``thesis``, ``published``."""
        return self.loaded.folder.name

    @property
    def rows(self) -> list[RowOutcome]:
        """Every row of every table."""
        return [row for outcome in self.outcomes for row in outcome.rows]

    @property
    def wrong(self) -> list[str]:
        """Rows that left their class and faults of the tables; empty if everything holds."""
        left = [f"{outcome.name}.{row.row.id}" for outcome in self.outcomes for row in outcome.rows if not row.held]
        return [*left, *(fault.partition(":")[0] for fault in self.loaded.faults)]


def table_text(outcome: TableOutcome) -> str:
    """Aligned text of a table: every row, why rows left, and the runs that did not converge."""
    lines = [f"{outcome.name}: {outcome.table.title} ({outcome.table.source})"]
    lines += aligned([HEADER, *(cells(row) for row in outcome.rows)], left=len(HEADER), indent="  ")
    lines += [f"    {row.row.id}: {row.reason}" for row in outcome.rows if not row.held]
    lines += [f"  did not converge: {line}" for line in _failures(outcome)]
    return "\n".join([*lines, ""])


def summary_text(validation: Validation) -> str:
    """Aligned text of a group: the classes of each table and in sum, where what is expected comes from, and the faults."""
    lines: list[str] = []
    for head, rows in ((COUNT_HEADER, count_rows(validation)), (ORIGIN_HEADER, count_origins(validation.rows))):
        lines += [*aligned([head, *([str(cell) for cell in row] for row in rows)], left=len(head)), ""]
    return "\n".join([*lines[:-1], *(f"fault: {fault}" for fault in validation.loaded.faults)])


def count_rows(validation: Validation) -> list[tuple[Any, ...]]:
    """Per table: chapter, name, rows there of rows that must be, and rows by class; last each chapter and all."""
    ended = {outcome.name: outcome for outcome in validation.outcomes}
    promised, faults = validation.loaded.manifest.tables, validation.loaded.faults
    names = [name for name in promised if name in ended or any(fault.startswith(f"{name}:") for fault in faults)]
    lines: list[tuple[Any, ...]] = []
    totals: dict[str, list[int]] = {}
    for name in [*names, *(name for name in ended if name not in promised)]:
        rows = ended[name].rows if name in ended else ()
        chapter, expected = promised.get(name, (str(ended[name].table.chapter) if name in ended else "", 0))
        counts = [sum(row.label == label for row in rows) for label in CLASSES]
        lines.append((chapter, name, f"{len(rows)} of {expected}", *counts))
        for key in (chapter, "all"):
            before = totals.get(key, [0] * (2 + len(CLASSES)))
            totals[key] = [a + b for a, b in zip(before, [len(rows), expected, *counts], strict=True)]
    whole = totals.pop("all", None)
    lines += [(chapter, "all", f"{total[0]} of {total[1]}", *total[2:]) for chapter, total in totals.items()]
    return [*lines, ("all", "all", f"{whole[0]} of {whole[1]}", *whole[2:])] if whole else lines


def count_origins(rows: Sequence[RowOutcome]) -> list[tuple[Any, ...]]:
    """Per origin of what is expected: rows by class."""
    counts = Counter((row.row.origin, row.label) for row in rows)
    return [
        (origin.replace("_", " "), *(counts[origin, label] for label in CLASSES))
        for origin in ORIGINS
        if any(counts[origin, label] for label in CLASSES)
    ]


def json_report(validations: Sequence[Validation]) -> str:
    """The content of ``validation.json``."""
    names = ("chapter", "table", "rows", *CLASSES)
    groups = {
        validation.name: {
            "passed": not validation.wrong,
            "faults": validation.loaded.faults,
            "counts": [dict(zip(names, line, strict=True)) for line in count_rows(validation)],
            "origins": [dict(zip(("from", *CLASSES), line, strict=True)) for line in count_origins(validation.rows)],
            "tables": {outcome.name: _table_values(outcome) for outcome in validation.outcomes},
        }
        for validation in validations
    }
    content = {"tactsim": __version__, "passed": not any(validation.wrong for validation in validations), "groups": groups}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _table_values(outcome: TableOutcome) -> dict[str, Any]:
    return {
        "title": outcome.table.title,
        "chapter": outcome.table.chapter,
        "source": outcome.table.source,
        "held": outcome.held,
        "rows": [row_values(row) for row in outcome.rows],
        "pictures": [asdict(picture) for picture in placed_pictures(outcome)],
        "studies": {name: [run.model_dump(mode="json") for run in runs] for name, runs in outcome.inputs.studies.items()},
    }


def row_values(outcome: RowOutcome) -> dict[str, Any]:
    """A row as plain data; ``expected`` and ``computed`` are in ``unit``."""
    row = outcome.row
    expected = row.expected_si
    return {
        "id": row.id,
        "quantity": row.quantity,
        "place": row.place,
        "numbers": row.numbers,
        "from": row.origin,
        "unit": "1" if row.unit == "1" else row.shown_unit,
        "expected": row.expected if expected is None else row.shown(expected),
        "computed": outcome.shown,
        "ratio": outcome.ratio,
        "allowed": _allowed(row.ends),
        "class": outcome.label,
        "held": outcome.held,
        "ended": outcome.ended,
        "why": outcome.reason,
        "evaluate": row.evaluate.model_dump(mode="json") if row.evaluate else None,
    }


def markdown_report(validations: Sequence[Validation], figures: Mapping[str, Sequence[str]]) -> str:
    """The content of ``validation.md``; ``figures`` are the names of the files in ``figures/`` by table, and ``overview``."""
    lines = ["# Validation", ""]
    lines += [f"![every number as a point](figures/{name})\n" for name in figures.get("overview", ())]
    lines += [*markdown_table(("class", "meaning"), [(label, MEANINGS[label]) for label in CLASSES]), ""]
    for validation in validations:
        lines += [f"## {validation.name.capitalize()}", ""]
        lines += markdown_table(COUNT_HEADER, count_rows(validation))
        lines += ["", *markdown_table(ORIGIN_HEADER, count_origins(validation.rows))]
        lines += [f"- **fault**: {fault}" for fault in validation.loaded.faults]
        for outcome in validation.outcomes:
            lines += _markdown_section(outcome, figures.get(outcome.name, ()))
        if errata := validation.loaded.manifest.errata:
            lines += ["", "### Errata", "", *markdown_table(("erratum", "what is wrong"), list(errata.items()))]
    return "\n".join(lines) + "\n"


def _markdown_section(outcome: TableOutcome, figures: Sequence[str]) -> list[str]:
    lines = ["", f"### {outcome.table.title}", "", f"{outcome.name}, {outcome.table.source}", ""]
    drawn = [picture for picture in placed_pictures(outcome) if picture.name in figures]
    by_name = {row.row.id: row for row in outcome.rows}
    for names, pictures in parts(list(by_name), drawn):
        rows = [by_name[name] for name in names]
        shown = [(*cells(row)[:1], row.row.quantity, *cells(row)[1:], row.row.place, row.reason) for row in rows]
        lines += [*markdown_table((HEADER[0], "quantity", *HEADER[1:], "place", "reason"), shown), ""]
        for picture in pictures:
            lines += [f"![{picture.title}](figures/{picture.name})", "", f"*{picture.caption}*", ""]
    for name, runs in outcome.inputs.studies.items():
        lines += [f"#### Runs of {name}", "", *markdown_table(RUN_HEADER, run_cells(runs)), ""]
    return lines


RUN_HEADER = ("run", "status", "over the annulus", "over the disc", "displacement", "unstable volume", "end")


def run_cells(runs: Sequence[Any]) -> list[tuple[str, ...]]:
    """Cells of the table of a study's runs."""
    lines = []
    for run in runs:
        pressure = run.quantities.get("threshold_pressure") if run.converged else None
        over = ["-", "-"] if pressure is None else [format_quantity(p, "Pa") for p in (pressure, pressure * run.disc_share)]
        unstable = f"{100 * run.quantities.get('unstable_volume_fraction', 0.0):.1f} %"
        lines.append(
            (run.id, run.status, *over, format_quantity(run.quantities.get("displacement", 0.0), "m"), unstable, run.reason)
        )
    return lines


def cells(outcome: RowOutcome) -> tuple[str, ...]:
    """The row in words, as `HEADER` names the columns."""
    row = outcome.row
    expected = "-" if row.expected is None else f"{row.expected}"
    ratio = "-" if outcome.ratio is None else f"{outcome.ratio:.4g}"
    computed = figure_text(outcome, _digits(expected))
    return row.id, row.origin.replace("_", " "), expected, computed, ratio, _allowed(row.ends), outcome.ended


def _digits(expected: str) -> int:
    """Digits in which a computed number can be compared with a printed one: one more than it has, four to nine."""
    mantissa = expected.partition(" ")[0].lower().partition("e")[0]
    return min(9, max(4, 1 + len("".join(c for c in mantissa if c.isdigit()).lstrip("0"))))


def _allowed(ending: Any) -> str:
    if isinstance(ending, Reproduced | Regression | Transcribed) and ending.within is not None:
        return _width(ending.within)
    if isinstance(ending, Outside):
        return f"{ending.by:.4g} ± {100 * ending.within:.2g} %"
    return ending.limit if isinstance(ending, Bound) else "-"


def _width(tolerance: Tolerance) -> str:
    return f"± {tolerance.relative * 100:.2g} %" if tolerance.relative is not None else f"± {tolerance.absolute}"


def _failures(outcome: TableOutcome) -> list[str]:
    return [
        f"{study}, {run.id}: {run.reason}" for study, runs in outcome.inputs.studies.items() for run in runs if not run.converged
    ]
