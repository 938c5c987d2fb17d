"""Keeps what ``tactsim validate`` computed for the pages: ``python docs/extensions/keep_thesis.py validation.json``.

Tables that were not computed keep what an earlier call kept, so that a few tables are renewed alone. Pictures are taken from the
folder ``figures`` beside the report.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from PIL import Image

KEPT = Path(__file__).parents[1] / "verification" / "thesis.json"
SHOWN = ("quantity", "place", "from", "unit", "expected", "computed", "ratio", "allowed", "class", "ended", "why")
COMMAND = (
    "tactsim validate TABLE... --out results/validation",
    "python docs/extensions/keep_thesis.py results/validation/validation.json",
)
"""What makes the file, for some tables or, without a name, for all."""
COLOURS = 64
"""Of a kept picture, a third of the size of what the report has."""


def keep(report: Path, kept: Path = KEPT) -> None:
    """Adds the tables of a report, with their pictures, to what is kept."""
    computed = json.loads(report.read_text(encoding="utf-8"))
    tables = json.loads(kept.read_text(encoding="utf-8"))["tables"] if kept.is_file() else {}
    for group in computed["groups"].values():
        for name, table in group["tables"].items():
            earlier = tables.get(name, {}).get("pictures", [])
            tables[name] = {key: table[key] for key in ("title", "source", "chapter")} | {
                "rows": {row["id"]: kept_row(row) for row in table["rows"]},
                "pictures": _kept_pictures(table["pictures"], earlier, report.parent / "figures", pictures_beside(kept)),
            }
    content = {"command": COMMAND, "tactsim": computed["tactsim"], "tables": dict(sorted(tables.items()))}
    kept.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def pictures_beside(kept: Path) -> Path:
    """The folder of the kept pictures."""
    return kept.parent / "pictures"


def kept_row(row: dict[str, Any]) -> dict[str, Any]:
    """What is kept of a row of a report."""
    return {key: _rounded(row[key]) for key in SHOWN}


def _kept_pictures(
    pictures: list[dict[str, Any]], earlier: list[dict[str, Any]], source: Path, target: Path
) -> list[dict[str, Any]]:
    """Those of the pictures that were drawn, their files kept with few colours; files of earlier ones are removed."""
    for picture in earlier:
        (target / picture["name"]).unlink(missing_ok=True)
    drawn = [picture for picture in pictures if (source / picture["name"]).is_file()]
    target.mkdir(exist_ok=True)
    for picture in drawn:
        with Image.open(source / picture["name"]) as image:
            image.convert("RGB").quantize(COLOURS).save(target / picture["name"], optimize=True)
    return drawn


def _rounded(value: Any) -> Any:
    """Numbers to six digits, so that noise of round-off is no change."""
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


if __name__ == "__main__":
    keep(Path(sys.argv[1]))
