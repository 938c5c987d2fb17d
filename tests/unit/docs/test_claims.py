"""Numbers that pages take from the record of the validation are those of the record."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def tables():
    return json.loads((DOCS / "verification" / "thesis.json").read_text(encoding="utf-8"))["tables"]


def page(name):
    return " ".join((DOCS / name).read_text(encoding="utf-8").split())


def test_the_lowest_threshold_pressures_over_the_printed_ones(tables):
    rows = tables["table_3_2"]["rows"]
    annular, either = ([rows[f"{set_}.fea{area}"] for set_ in ("b1a", "icf")] for area in ("_annulus", ""))
    first, second = (" and ".join(f"{min(row['computed']) / row['expected']:.1f}" for row in both) for both in (annular, either))
    assert f"the lowest pressures are {first} times the printed ones over the annular area, {second} times over the disc" in page(
        "theory/errata.md"
    )


def test_what_the_barrier_does_to_line_and_drift(tables):
    rows = {name: row["computed"] for name, row in tables["section_2_3"]["rows"].items()}
    line = [max(abs(rows[f"{film}_line_{side}"]) for side in ("above", "below")) for film in ("identified", "joint")]
    words = " and ".join(
        f"{what} from {100 * before:.0f} to {100 * after:.0f} %{of}"
        for what, of, before, after in (
            ("the error of the line", " of full scale", *line),
            ("the drift in a minute at 1 N", "", rows["identified_drift"], rows["joint_drift"]),
        )
    )
    assert words in page("guide/sensors.md")
