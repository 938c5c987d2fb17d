"""The thesis table by table: what is recorded for each number, and what was found when the table was last computed."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

from markdown_parts import page, table

from tactsim.units import format_quantity
from tactsim.validation.loading import load_tables
from tactsim.validation.table import Assumption, Bound, OutsideBy, ReproducedAfter, Row

ROOT = Path(__file__).parents[2]
OUTPUT = ROOT / "docs" / "verification" / "thesis.json"
ERRATUM = re.compile(r"\bE\d{1,2}\b")
ERRATA = re.compile(r"E\d{1,2}(, E\d{1,2})*")
STATES = ("reproduced", "after an erratum", "outside", "finding", "assumption")


def validation_pages() -> dict[str, str]:
    """What the page about validation includes."""
    tables = load_tables(ROOT / "cases" / "thesis", []).tables
    stored = json.loads(OUTPUT.read_text(encoding="utf-8"))
    counts = [(found.chapter, name, found.title, Counter(_class_of(row) for row in found.rows)) for name, found in tables.items()]
    whole: Counter[str] = sum((count for *_, count in counts), Counter())
    rows = [
        (f"[{name}](#thesis-{name.replace('_', '-')})", title, *(str(count[s] or "") for s in STATES))
        for _, name, title, count in counts
    ]
    lines = [*table(("table", "what it holds", *STATES), [*rows, ("all", "", *(str(whole[state]) for state in STATES))])]
    missing = [f"`{name}`" for name in tables if name not in stored["tables"]]
    lines += [f"The column *found* holds what `tactsim validate` computed with tactsim {stored['tactsim']}."]
    lines += [f"Not computed anew for this page, as their simulations take long: {', '.join(missing)}.", ""] if missing else [""]
    for name, found in tables.items():
        computed = stored["tables"].get(name, {})
        lines += [f"(thesis-{name.replace('_', '-')})=", f"## {found.title}", "", f"`{name}`, {found.source}.", ""]
        lines += table(
            ("number", "place", "printed", "found", "recorded state", "reason"), [_cells(row, computed) for row in found.rows]
        )
    return {"validation.inc": page(lines)}


def _class_of(row: Row) -> str:
    """Which of ``STATES`` a row is recorded in."""
    classes = {ReproducedAfter: "after an erratum", OutsideBy: "outside", Bound: "finding", Assumption: "assumption"}
    return next((name for cls, name in classes.items() if isinstance(row.state, cls)), "reproduced")


def _cells(row: Row, computed: dict[str, Any]) -> tuple[str, ...]:
    value = computed.get(row.id)
    found = "" if value is None else _in_printed_unit(value, row)
    state, reason = _state(row)
    printed = "" if row.printed is None else str(row.printed)
    leading, colon, rest = reason.partition(":")
    if ERRATA.fullmatch(leading):
        reason = f"{_linked(leading)}{colon}{rest}"
    return row.quantity, row.place, printed, found, _linked(state), reason


def _linked(text: str) -> str:
    """The text with its errata as links; in running text E1 may also be a modulus."""
    return ERRATUM.sub(lambda found: f"[{found[0]}](/theory/errata.md#{found[0].lower()})", text)


def _in_printed_unit(value: float, row: Row) -> str:
    """The found number in the unit in which the number is printed, if it is."""
    if not isinstance(row.printed, str) or not row.expected:
        return format_quantity(value, row.unit)
    number, _, unit = row.printed.partition(" ")
    return f"{float(number) * value / row.expected:.5g} {unit}"


def _state(row: Row) -> tuple[str, str]:
    """The recorded state in words, and its reason."""
    state = row.state
    if isinstance(state, OutsideBy):
        return f"outside by {state.outside_by:g} ± {state.tolerance:.0%}", state.reason
    if isinstance(state, Bound):
        return f"above {state.above}" if state.above is not None else f"below {state.below}", state.finding
    if isinstance(state, Assumption):
        return "assumption", state.assumption
    allowed = row.tolerance
    if allowed is None:
        width = ""
    elif allowed.relative is not None:
        width = f" within {100 * allowed.relative:.2g} %"
    else:
        width = f" within {allowed.absolute}"
    after = f" after {state.reproduced_after}" if isinstance(state, ReproducedAfter) else ""
    return f"reproduced{after}{width}", allowed.reason if allowed else ""
