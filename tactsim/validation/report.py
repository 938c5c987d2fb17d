"""The comparison in words for the terminal, as JSON and as Markdown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from tactsim.units import format_quantity
from tactsim.validation.comparison import RowOutcome, TableOutcome
from tactsim.validation.loading import LoadedTables
from tactsim.validation.table import Assumption, Bound, OutsideBy, ReproducedAfter
from tactsim.version import __version__

HEADER = ("row", "printed", "found", "ratio", "tolerance", "state")
STATES = ("reproduced", "after an erratum", "outside", "finding", "assumption", "left")


def terminal_report(loaded: LoadedTables, outcomes: Sequence[TableOutcome]) -> str:
    """Aligned text: every row, the runs that did not converge, the counts, and what is wrong."""
    lines: list[str] = []
    for outcome in outcomes:
        cells = [HEADER, *(_cells(row) for row in outcome.rows)]
        widths = [max(len(line[k]) for line in cells) for k in range(len(HEADER))]
        lines += [f"{outcome.name}: {outcome.table.title} ({outcome.table.source})"]
        lines += [
            "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in cells
        ]
        lines += [f"    {row.row.id}: {row.reason}" for row in outcome.rows if not row.held]
        lines += [f"  did not converge: {line}" for line in _failures(outcome)] + [""]
    counts = [("chapter", "table", "rows", *STATES), *(tuple(map(str, row)) for row in count_rows(loaded, outcomes))]
    widths = [max(len(line[k]) for line in counts) for k in range(len(counts[0]))]
    lines += ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in counts]
    lines += [f"fault: {fault}" for fault in loaded.faults]
    return "\n".join(lines)


def count_rows(loaded: LoadedTables, outcomes: Sequence[TableOutcome]) -> list[tuple[Any, ...]]:
    """Per table: chapter, name, rows there of rows that must be, and rows by how they ended; last the totals."""
    ended = {outcome.name: outcome for outcome in outcomes}
    promised = loaded.manifest.tables
    names = [name for name in promised if name in ended or any(fault.startswith(f"{name}:") for fault in loaded.faults)]
    lines: list[tuple[Any, ...]] = []
    totals: dict[str, list[int]] = {}
    for name in [*names, *(name for name in ended if name not in promised)]:
        rows = ended[name].rows if name in ended else ()
        chapter, expected = promised.get(name, (ended[name].table.chapter if name in ended else 0, 0))
        counts = [sum(_class_of(row) == state for row in rows) for state in STATES]
        lines.append((chapter, name, f"{len(rows)} of {expected}", *counts))
        total = totals.setdefault(f"{chapter}", [0] * (2 + len(STATES)))
        totals[f"{chapter}"] = [a + b for a, b in zip(total, [len(rows), expected, *counts], strict=True)]
    lines += [(chapter, "all", f"{total[0]} of {total[1]}", *total[2:]) for chapter, total in totals.items()]
    return lines


def json_report(loaded: LoadedTables, outcomes: Sequence[TableOutcome]) -> str:
    """The content of ``validation.json``."""
    tables = {
        outcome.name: {
            "title": outcome.table.title,
            "chapter": outcome.table.chapter,
            "source": outcome.table.source,
            "held": outcome.held,
            "rows": [_row_values(row) for row in outcome.rows],
            "studies": {name: [run.model_dump(mode="json") for run in runs] for name, runs in outcome.inputs.studies.items()},
        }
        for outcome in outcomes
    }
    names = ("chapter", "table", "rows", *STATES)
    counts = [dict(zip(names, line, strict=True)) for line in count_rows(loaded, outcomes)]
    passed = not loaded.faults and all(outcome.held for outcome in outcomes)
    content = {"tactsim": __version__, "passed": passed, "faults": loaded.faults, "counts": counts, "tables": tables}
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def markdown_report(loaded: LoadedTables, outcomes: Sequence[TableOutcome], figures: Sequence[str] = ()) -> str:
    """The content of ``validation.md``; ``figures`` are the names of the files beside it."""
    lines = [
        "# Validation against the thesis",
        "",
        *_markdown_table(("chapter", "table", "rows", *STATES), count_rows(loaded, outcomes)),
    ]
    lines += [f"- **fault**: {fault}" for fault in loaded.faults]
    for outcome in outcomes:
        lines += ["", f"## {outcome.table.title}", "", f"{outcome.name}, {outcome.table.source}", ""]
        rows = [(*_cells(row)[:1], row.row.quantity, *_cells(row)[1:], row.row.place, row.reason) for row in outcome.rows]
        lines += _markdown_table((HEADER[0], "quantity", *HEADER[1:], "place", "reason"), rows)
        for name, runs in outcome.inputs.studies.items():
            lines += ["", f"### Runs of {name}", ""]
            lines += _markdown_table(
                ("run", "status", "over the annulus", "over the disc", "displacement", "unstable volume", "end"), run_cells(runs)
            )
        lines += [f"\n![{figure}](figures/{figure})" for figure in figures if figure.startswith(f"{outcome.name}_")]
    return "\n".join(lines) + "\n"


def run_cells(runs: Sequence[Any]) -> list[tuple[str, ...]]:
    """Cells of the table of a study's runs."""
    cells = []
    for run in runs:
        pressure = run.quantities.get("threshold_pressure") if run.converged else None
        over = ["-", "-"] if pressure is None else [format_quantity(p, "Pa") for p in (pressure, pressure * run.disc_share)]
        unstable = f"{run.quantities.get('unstable_volume_fraction', 0.0):.1%}"
        cells.append(
            (run.id, run.status, *over, format_quantity(run.quantities.get("displacement", 0.0), "m"), unstable, run.reason)
        )
    return cells


def _cells(outcome: RowOutcome) -> tuple[str, ...]:
    row = outcome.row
    printed = "-" if row.printed is None else f"{row.printed}"
    computed = "-" if outcome.computed is None else quantity_text(outcome.computed, row.unit)
    ratio = "-" if outcome.ratio is None else f"{outcome.ratio:.4g}"
    return row.id, printed, computed, ratio, _tolerance(row), outcome.state


def _tolerance(row: Any) -> str:
    if isinstance(row.state, OutsideBy):
        return f"{row.state.outside_by:.4g} ± {100 * row.state.tolerance:.2g} %"
    if isinstance(row.state, Bound):
        return f"> {row.state.above}" if row.state.above is not None else f"< {row.state.below}"
    if row.tolerance is None:
        return "-"
    relative = row.tolerance.relative
    return f"± {relative * 100:.2g} %" if relative is not None else f"± {row.tolerance.absolute}"


def quantity_text(value: float, unit: str) -> str:
    """A number with its unit; areas in mm^2, which have no prefix that reads well."""
    return f"{value * 1e6:.4g} mm^2" if unit == "m^2" else f"{value:.5g} {unit}" if "/" in unit else format_quantity(value, unit)


def _class_of(outcome: RowOutcome) -> str:
    if not outcome.held:
        return "left"
    kinds = ((ReproducedAfter, "after an erratum"), (OutsideBy, "outside"), (Bound, "finding"), (Assumption, "assumption"))
    return next((name for kind, name in kinds if isinstance(outcome.row.state, kind)), "reproduced")


def _row_values(outcome: RowOutcome) -> dict[str, Any]:
    row = outcome.row
    return {
        **row.model_dump(mode="json", exclude_none=True),
        "unit": row.unit,
        "expected": row.expected if row.evaluate else None,
        "found": outcome.computed,
        "ratio": outcome.ratio,
        "held": outcome.held,
        "ended": outcome.state,
        "why": outcome.reason,
    }


def _failures(outcome: TableOutcome) -> list[str]:
    return [
        f"{study}, {run.id}: {run.reason}" for study, runs in outcome.inputs.studies.items() for run in runs if not run.converged
    ]


def _markdown_table(header: Sequence[str], rows: Sequence[Sequence[Any]]) -> list[str]:
    lines = [header, ["---"] * len(header), *rows]
    return ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines]
