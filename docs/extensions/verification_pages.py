"""The checks against exact solutions and published numbers, as the tests recorded them."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from typing import Any

from markdown import page, table

RECORDS = Path(__file__).parents[1] / "verification" / "records.json"
HEADER = ("check", "reference", "mesh", "error", "tolerance", "order (theory)")
KINDS = {
    "exact": ("Exact solutions", "Closed forms and manufactured solutions, evaluated to round-off."),
    "published": ("Published numbers", "Numbers printed by others, or computed by another program."),
    "invariance": (
        "Identities",
        "What must hold whatever the solution is: balance, symmetry, round-off between two forms of one formula.",
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
        lines += [f"## {title}", "", what, ""]
        for module, checks in groupby(found, key=lambda row: row["test"].partition("::")[0]):
            lines += [f"### `{module.removeprefix('tests/verification/')}`", "", *table(HEADER, [_cells(row) for row in checks])]
    return {"verification.inc": page(lines)}


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    order = "" if row["order"] is None else f"{row['order']:.2f} ({row['theory']:g})"
    error = "" if row["error"] is None else f"{row['error']:.1e}"
    tolerance = "" if row["tolerance"] is None else f"{row['tolerance']:.0e}"
    return row["check"], row["reference"], row["mesh"], error, tolerance, order
