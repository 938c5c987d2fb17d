"""Small thesis tables for the tests: written to a folder with their manifest."""

from __future__ import annotations

from pathlib import Path

MANIFEST = """\
schema: tactsim/thesis-manifest/1
chapters:
  "3":
    small: 3
"""
TABLE = """\
schema: tactsim/thesis-table/1
title: A small table
chapter: 3
source: nowhere
rows:
  - id: stiffness
    quantity: force over displacement
    place: line 1
    printed: 125 N/m
    evaluate: {kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}
    tolerance: {relative: 0.001, reason: a quotient}
    state: {reproduced: true}
  - id: known
    quantity: force over displacement
    place: line 2
    printed: 250 N/m
    evaluate: {kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}
    state: {outside_by: 0.5, tolerance: 0.01, reason: half the displacement was meant}
  - id: supply
    quantity: supply voltage
    place: line 3
    state: {assumption: not printed}
"""


def write_tables(folder: Path, table: str = TABLE, manifest: str = MANIFEST) -> Path:
    """A folder with the table ``small`` and a manifest."""
    folder.mkdir(exist_ok=True)
    (folder / "manifest.yaml").write_text(manifest, encoding="utf-8")
    (folder / "small.yaml").write_text(table, encoding="utf-8")
    return folder
