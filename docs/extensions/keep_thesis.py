"""Keeps what ``tactsim validate`` found for the pages: ``python docs/extensions/keep_thesis.py validation.json``.

Tables that were not computed keep what an earlier call found.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

KEPT = Path(__file__).parents[1] / "verification" / "thesis.json"


def keep(report: Path) -> None:
    """Adds the tables of a report to what is kept."""
    found = json.loads(report.read_text(encoding="utf-8"))
    tables = json.loads(KEPT.read_text(encoding="utf-8"))["tables"] if KEPT.is_file() else {}
    for name, table in found["tables"].items():
        tables[name] = {row["id"]: float(f"{row['found']:.6g}") for row in table["rows"] if row["found"] is not None}
    content = {"tactsim": found["tactsim"], "tables": dict(sorted(tables.items()))}
    KEPT.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    keep(Path(sys.argv[1]))
