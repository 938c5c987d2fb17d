"""The record of a campaign: a line for every trial, in the order in which they ended, to which later runs add."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from campaign.trials import Ended

ANSWERS = ("converged", "no threshold")
"""Outcomes that answer the question of a case."""


def as_line(ended: Ended) -> str:
    """A line of the record."""
    return json.dumps(asdict(ended)) + "\n"


def read_record(path: Path) -> list[Ended]:
    """The trials so far; none if there is no record. A last line cut short by a kill is left out."""
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("}\n")]
    if whole != lines:
        path.write_text("".join(whole), encoding="utf-8")
    return [Ended(**json.loads(line)) for line in whole]


def first_runs(record: Iterable[Ended]) -> list[Ended]:
    """What each case did when it was first tried."""
    first: dict[tuple[str, int], Ended] = {}
    for one in record:
        first.setdefault((one.kind, one.number), one)
    return list(first.values())


def last_runs(record: Iterable[Ended]) -> dict[tuple[str, int], Ended]:
    """What each case did when it was last tried, by kind and number."""
    return {(one.kind, one.number): one for one in record}
