"""The checks against exact solutions and published numbers, as the tests recorded them."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import Any

from markdown_parts import page, table

RECORDS = Path(__file__).parents[1] / "verification" / "records.json"
HEADER = ("check", "reference", "mesh", "error", "tolerance", "test")
ORDERS = ("check", "reference", "mesh", "order", "theory", "tolerance", "test")
KINDS = {
    "exact": ("Exact solutions", "Closed forms and manufactured solutions, evaluated to round-off."),
    "published": ("Published numbers", "Numbers printed by others, or computed by another program."),
    "invariance": (
        "Identities",
        "What must hold whatever the solution is: balance, symmetry, and the same from two formulas, models, meshes or programs.",
    ),
    "convergence": (
        "Orders of convergence",
        "Fitted over a ladder of meshes or steps; the style of this project demands theory within 0.1.",
    ),
}


def verification_pages() -> dict[str, str]:
    """What the page about verification includes."""
    content = json.loads(RECORDS.read_text(encoding="utf-8"))
    rows = sorted(content["records"], key=lambda row: (list(KINDS).index(row["kind"]), row["test"], row["check"]))
    lines = [f"{len(rows)} checks, recorded with tactsim {content['tactsim']} by", "", "```text", content["command"], "```", ""]
    for kind, found in groupby(rows, key=lambda row: row["kind"]):
        title, what = KINDS[kind]
        header, cells = (ORDERS, _order_cells) if kind == "convergence" else (HEADER, _error_cells)
        lines += [f"## {title}", "", what, "", *table(header, [cells(row) for row in found])]
    return {"verification.inc": page(lines)}


def _error_cells(row: dict[str, Any]) -> tuple[str, ...]:
    return row["check"], row["reference"], row["mesh"], _short(row["error"]), _short(row["tolerance"]), _test(row)


def _order_cells(row: dict[str, Any]) -> tuple[str, ...]:
    order, theory, tolerance = f"{row['order']:.2f}", f"{row['theory']:g}", f"{row['tolerance']:g}"
    return row["check"], row["reference"], row["mesh"], order, theory, tolerance, _test(row)


def _short(number: float) -> str:
    """A small number of two digits that no line break parts."""
    return "0" if number == 0 else f"{number:.1e}".replace("e-0", "e-").replace("-", "\N{NON-BREAKING HYPHEN}")


def _test(row: dict[str, Any]) -> str:
    return f"`{Path(row['test'].partition('::')[0]).stem}`"
