"""The tables row by row, as they ended when they were last computed, and those that are recorded but were not."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

from markdown_parts import page, table

from tactsim.validation.endings import LABELS
from tactsim.validation.loading import load_groups
from tactsim.validation.pictures import PlacedPicture, parts
from tactsim.validation.report import MEANINGS, SHORT

MOST_ROWS = 4
"""Rows that the caption of a picture tells one by one."""
ROOT = Path(__file__).parents[2]
KEPT = ROOT / "docs" / "verification" / "thesis.json"
HEADER = ("number", "place", "from", "expected", "computed", "ended as", "why")
ERRATUM = re.compile(r"\bE\d{1,2}\b")
ERRATA = re.compile(r"E\d{1,2}(, E\d{1,2})*")


def validation_pages() -> dict[str, str]:
    """What the page about validation includes."""
    folders = [folder for name in ("thesis", "published") if (folder := ROOT / "cases" / name).is_dir()]
    recorded = {name: table for group in load_groups(folders) for name, table in group.tables.items()}
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    computed = {name: kept["tables"][name] for name in recorded if name in kept["tables"]}
    counts = {name: Counter(row["class"] for row in table["rows"].values()) for name, table in computed.items()}
    whole: Counter[str] = sum(counts.values(), Counter())
    rows = [
        (f"[{name}](#thesis-{name.replace('_', '-')})", computed[name]["title"], *(str(count[s] or "") for s in LABELS))
        for name, count in counts.items()
    ]
    lines = [*table(("class", "meaning"), [(label, MEANINGS[label]) for label in LABELS]), ""]
    lines += table(
        ("table", "what it holds", *(SHORT.get(label, label) for label in LABELS)),
        [*rows, ("all", "", *(str(whole[label]) for label in LABELS))],
    )
    lines += ["", f"The rows stand as tactsim {kept['tactsim']} computed them by", "", "```text", *kept["command"], "```", ""]
    if missing := [f"`{name}`" for name in recorded if name not in computed]:
        lines += [f"Recorded but not computed for this page: {', '.join(missing)}.", ""]
    for name, of_table in computed.items():
        lines += [f"(thesis-{name.replace('_', '-')})=", f"## {of_table['title']}", "", f"`{name}`, {of_table['source']}.", ""]
        pictures = [PlacedPicture(**picture) for picture in of_table["pictures"]]
        for names, below in parts(list(of_table["rows"]), pictures):
            lines += table(HEADER, [_cells(of_table["rows"][row]) for row in names])
            lines += [line for picture in below for line in _picture(picture, of_table["rows"])]
    return {"validation.inc": page(lines)}


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    expected = "" if row["expected"] is None else f"{row['expected']:g}{unit}"
    leading, colon, rest = row["why"].partition(":")
    why = f"{_linked(leading)}{colon}{rest}" if ERRATA.fullmatch(leading) else row["why"]
    allowed = f" ({row['allowed']})" if row["allowed"].startswith("±") else ""
    return (
        row["quantity"],
        row["place"],
        row["from"],
        expected,
        _text(row["computed"], unit),
        _linked(row["ended"]) + allowed,
        why,
    )


def _picture(picture: PlacedPicture, rows: dict[str, Any]) -> list[str]:
    """A picture with its caption: what the source says, and what became of the rows that it belongs to."""
    names = [row for of_class in picture.rows.values() for row in of_class]
    claims = "; ".join(f"{rows[row]['quantity']}: *{rows[row]['class']}*" for row in names[:MOST_ROWS])
    counts = ", ".join(f"{len(of_class)} {label}" for label, of_class in picture.rows.items())
    ended = f"Here: {claims if len(names) <= MOST_ROWS else f'of its {len(names)} rows {counts}'}"
    return [
        f"![{picture.title}](/verification/pictures/{picture.name})",
        "",
        f"**{picture.title}.** {picture.says}. {ended}.",
        "",
    ]


def _text(value: Any, unit: str) -> str:
    """A number or the ends of an interval, with the unit."""
    ends = value if isinstance(value, list) else [] if value is None else [value]
    return " to ".join(f"{end:.5g}" for end in ends) + (unit if ends else "")


def _linked(text: str) -> str:
    """The text with its errata as links; in running text E1 may also be a modulus."""
    return ERRATUM.sub(lambda number: f"[{number[0]}](/theory/errata.md#{number[0].lower()})", text)
