"""Thesis tables for the tests: small ones written to a folder with their manifest, and those that are shipped."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from tactsim.case.loading import load_case
from tactsim.shipped import CASES
from tactsim.validation import load_tables
from tactsim.validation.loading import LoadedTables
from tactsim.validation.table import Table

GROUPS = ("thesis", "published")

MANIFEST = """\
schema: tactsim/thesis-manifest/2
chapters:
  "3":
    small: 3
numbers:
  T053: sensitivity
errata:
  E4: a missing term
"""
TABLE = """\
schema: tactsim/thesis-table/2
title: A small table
chapter: 3
source: nowhere
rows:
  - id: stiffness
    quantity: force over displacement
    place: line 1
    numbers: [T053]
    expected: 125 N/m
    from: thesis
    evaluate: {kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}
    ends: {kind: reproduced, within: {relative: 0.001, reason: a quotient}}
  - id: known
    quantity: force over displacement
    place: line 2
    expected: 250 N/m
    from: thesis
    evaluate: {kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}
    ends: {kind: outside, by: 0.5, within: 0.01, why: half the displacement was meant}
  - id: supply
    quantity: supply voltage
    place: line 3
    from: thesis
    ends: {kind: not_testable, why: not printed}
"""


def write_tables(folder: Path, table: str = TABLE, manifest: str = MANIFEST) -> Path:
    """A folder with the table ``small`` and a manifest."""
    folder.mkdir(exist_ok=True)
    (folder / "manifest.yaml").write_text(manifest, encoding="utf-8")
    (folder / "small.yaml").write_text(table, encoding="utf-8")
    return folder


@cache
def shipped_tables(group: str, *names: str) -> LoadedTables:
    """The named tables of a group, or all, read when a test needs them: every process that collects tests would read them at
    import."""
    return load_tables(CASES / group, names)


def shipped_table(name: str) -> Table:
    """A table of the thesis."""
    return shipped_tables("thesis", name).tables[name]


def assert_cases_valid(group: str) -> None:
    """Every table of a group is counted, and the cases of its runs can be read and differ from each other."""
    loaded, folder = shipped_tables(group), CASES / group
    assert loaded.faults == ()
    for table in loaded.tables.values():
        for study in table.studies:
            cases = [load_case(folder / study.case, study.overrides(run)) for run in study.runs]
            assert len({case.case_id for case in cases}) == len(study.runs)


def shipped_names() -> list[tuple[str, str]]:
    """Group and name of every shipped table, as their files are called."""
    return [(group, path.stem) for group in GROUPS for path in sorted((CASES / group).glob("*.yaml")) if path.stem != "manifest"]
