"""What the pages show of ``tactsim validate``: the kept rows are those of the tables, and what the quick tables compute now."""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from thesis_tables import CASES, shipped_names, shipped_tables

from tactsim.validation import compare
from tactsim.validation.comparison import FIGURE, reason_of
from tactsim.validation.execution import Task, simulated
from tactsim.validation.pictures import placed_pictures
from tactsim.validation.report import row_values
from tactsim.validation.table import Row

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "extensions"))
import keep_thesis  # noqa: E402  a script beside the pages

KEPT = json.loads(keep_thesis.KEPT.read_text(encoding="utf-8"))
TABLES = shipped_names()
SHORT = ("section_2_3", "section_3_1_2")
"""Tables whose studies take a second; those of others take minutes."""
RECORDED = "section_3_1_2"
"""The table that reads recorded signals: its rows are stale whenever these are remade."""
QUICK = [
    (group, name)
    for group, name in TABLES
    if name in SHORT or "\nstudies:" not in (CASES / group / f"{name}.yaml").read_text(encoding="utf-8")
]
ROUND_OFF = 1e-6
"""Numbers below this are differences of equal ones."""
PART = 1e-5
"""Largest difference of a kept number from one that is computed anew: it is kept to six digits."""


def test_the_file_names_the_commands_that_make_it() -> None:
    assert KEPT["command"] == list(keep_thesis.COMMAND)
    assert set(KEPT["tables"]) == {name for _, name in TABLES}


@pytest.mark.parametrize(("group", "name"), TABLES)
def test_kept_rows_are_those_of_the_table(group: str, name: str) -> None:
    table = shipped_tables(group).tables[name]
    kept = KEPT["tables"][name]
    assert kept["title"] == table.title
    assert list(kept["rows"]) == [row.id for row in table.rows]
    assert [row.id for row in table.rows if not is_kept(row, kept["rows"][row.id])] == [], "renew the table as `command` says"
    assert [picture["says"] for picture in kept["pictures"]] == [picture.says for picture in table.figures.values()]
    missing = [
        each["name"] for each in kept["pictures"] if not (keep_thesis.pictures_beside(keep_thesis.KEPT) / each["name"]).is_file()
    ]
    assert missing == []


def is_kept(row: Row, kept: dict[str, Any]) -> bool:
    """Whether the words of a row are those of the table, whatever figures the run filled in."""
    pattern = re.escape(reason_of(row))
    for placeholder in {match[0] for match in FIGURE.finditer(reason_of(row))}:
        pattern = pattern.replace(re.escape(placeholder), ".+")
    words = {"quantity": row.quantity, "place": row.place, "from": row.origin, "class": row.label}
    return all(kept[key] == value for key, value in words.items()) and re.fullmatch(pattern, kept["why"]) is not None


def test_a_changed_row_is_noticed() -> None:
    row = shipped_tables("thesis").tables["section_4_7"].rows[3]
    kept = KEPT["tables"]["section_4_7"]["rows"][row.id]
    assert is_kept(row, kept)
    for key in ("quantity", "place", "from", "class", "why"):
        assert not is_kept(row, {**kept, key: "another"})


@pytest.mark.parametrize(
    ("group", "name"),
    [each if each[1] == RECORDED else pytest.param(*each, marks=pytest.mark.slow, id="-".join(each)) for each in QUICK],
)
def test_kept_rows_are_what_is_computed(group: str, name: str) -> None:
    loaded = shipped_tables(group)
    table = loaded.tables[name]
    studies = {
        study.name: tuple(simulated(Task(run.id, str(loaded.folder / study.case), study.overrides(run))) for run in study.runs)
        for study in table.studies
    }
    outcome = compare(name, table, loaded.folder, studies)
    kept = KEPT["tables"][name]
    for row in outcome.rows:
        ours, theirs = keep_thesis.kept_row(row_values(row)), kept["rows"][row.row.id]
        allowed = row.row.shown(row.row.allowed or 0.0)  # of what is zero up to round-off
        assert same(ours["computed"], theirs["computed"], allowed), row.row.id
        assert {**ours, "computed": 0, "ratio": 0} == {**theirs, "computed": 0, "ratio": 0}, row.row.id
        if max(map(abs, ends(theirs["computed"])), default=0.0) > ROUND_OFF:
            wrong = [1.001 * each for each in ends(theirs["computed"])]
            assert not same(ours["computed"], wrong, allowed), row.row.id
    drawn = {picture["name"]: picture for picture in kept["pictures"]}
    assert {picture.name: dict(picture.rows) for picture in placed_pictures(outcome)} == {
        name: {label: tuple(rows) for label, rows in picture["rows"].items()} for name, picture in drawn.items()
    }


def ends(value: Any) -> list[float]:
    """A number, or both ends of an interval."""
    return list(value) if isinstance(value, list | tuple) else [] if value is None else [value]


def same(first: Any, second: Any, allowed: float) -> bool:
    """Whether two numbers, or intervals, are the same up to digits that are not kept, and round-off of what is zero."""
    pairs = zip(ends(first), ends(second), strict=True)
    return all(math.isclose(a, b, rel_tol=PART, abs_tol=min(allowed, 1e-9)) for a, b in pairs)
