"""Keeps what ``tactsim validate`` computed for the pages: ``python docs/extensions/keep_thesis.py validation.json``.

Tables that were not computed keep what an earlier call kept.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

KEPT = Path(__file__).parents[1] / "verification" / "thesis.json"
SHOWN = ("quantity", "place", "from", "unit", "expected", "computed", "ratio", "allowed", "class", "ended", "why")


def keep(report: Path) -> None:
    """Adds the tables of a report to what is kept."""
    computed = json.loads(report.read_text(encoding="utf-8"))
    tables = json.loads(KEPT.read_text(encoding="utf-8"))["tables"] if KEPT.is_file() else {}
    for group in computed["groups"].values():
        for name, table in group["tables"].items():
            rows = {row["id"]: {key: _rounded(row[key]) for key in SHOWN} for row in table["rows"]}
            tables[name] = {key: table[key] for key in ("title", "source", "chapter")} | {"rows": rows}
    content = {"tactsim": computed["tactsim"], "tables": dict(sorted(tables.items()))}
    KEPT.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _rounded(value: Any) -> Any:
    """Numbers to six digits, so that noise of round-off is no change."""
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


if __name__ == "__main__":
    keep(Path(sys.argv[1]))
