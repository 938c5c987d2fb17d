"""Thesis tables as data: closed, frozen, with the place of every fault."""

from __future__ import annotations

from pathlib import Path

import pytest
from thesis_tables import MANIFEST, TABLE, write_tables

from tactsim.errors import CaseError, InputError, StorageError, UnknownName
from tactsim.validation import load_groups, load_tables


def test_a_table_is_read_in_si(tmp_path: Path) -> None:
    table = load_tables(write_tables(tmp_path)).tables["small"]
    assert [row.expected_si for row in table.rows] == [125.0, 250.0, None]
    assert table.rows[0].allowed == pytest.approx(0.125, rel=1e-12)  # round-off of one product
    with pytest.raises(InputError, match="cannot be changed"):
        table.rows[0].id = "other"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("125 N/m", "125 N", r"small.yaml:6: rows.0: '125 N' has the wrong dimension"),
        ("125 N/m", "125", r"small.yaml:6: rows.0: 125 has no unit"),
        ("force: 0.1 N, displacement: 0.8 mm}\n    ends", "force: 0.1, displacement: 0.8 mm}\n    ends", "rows.0.evaluate.force"),
        ("kind: stiffness_resolution", "kind: stiffness_resolutoin", "did you mean 'stiffness_resolution'"),
        ("    place: line 1\n", "", "rows.0.place: missing"),
        (", within: {relative: 0.001, reason: a quotient}", "", "rows.0.ends.within: missing"),
        ("reason: a quotient", "raeson: a quotient", "rows.0.ends.within.raeson: unknown key"),
        ("by: 0.5", "by: 1.001", "is no deviation"),
        ("from: thesis", "from: own", "ends as a regression"),
        ("from: thesis", "from: hearsay", "rows.0.from"),
        ("T053", "53", "rows.0.numbers.0"),
        ("id: known", "id: stiffness", "rows with the same name: stiffness"),
        ("why: not printed", "why: not printed, by: 2", "rows.2.ends.by: unknown key"),
        ("title: A small table", "title: [", "not valid YAML"),
    ],
)
def test_a_fault_is_reported_with_its_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in TABLE
    with pytest.raises(CaseError) as caught:
        load_tables(write_tables(tmp_path, TABLE.replace(old, new, 1)))
    assert message in str(caught.value)
    assert "small.yaml:" in str(caught.value)


def test_an_unknown_table_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=r"did you mean 'small'"):
        load_tables(write_tables(tmp_path), ["smal"])


def test_a_missing_manifest_is_reported(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match=r"manifest\.yaml"):
        load_tables(tmp_path)


@pytest.mark.parametrize("kept", [1, 2])
def test_a_deleted_row_is_a_fault(tmp_path: Path, kept: int) -> None:
    text = "  - id:".join(TABLE.split("  - id:")[: kept + 1])
    assert load_tables(write_tables(tmp_path, text)).faults == (f"small: {kept} rows where the manifest counts 3",)


def test_a_deleted_or_uncounted_file_is_a_fault(tmp_path: Path) -> None:
    folder = write_tables(tmp_path)
    assert load_tables(folder).faults == ()
    (folder / "small.yaml").rename(folder / "renamed.yaml")
    first, second = load_tables(folder).faults
    assert "small: the table is absent, and with it 3 rows of chapter 3" in first
    assert "renamed: the manifest does not count" in second
    assert load_tables(folder, ["small"]).faults == (first,)


def test_a_table_of_another_chapter_is_a_fault(tmp_path: Path) -> None:
    faults = load_tables(write_tables(tmp_path, manifest=MANIFEST.replace('"3"', '"4"'))).faults
    assert faults == ("small: the table names chapter 3, the manifest chapter 4",)


def test_a_number_without_a_row_is_a_fault(tmp_path: Path) -> None:
    loaded = load_tables(write_tables(tmp_path, TABLE.replace("    numbers: [T053]\n", "")))
    assert loaded.faults == ("T053: no row names it: sensitivity",)
    assert load_tables(tmp_path, ["small"]).faults == (), "only all tables together must have every number"
    unknown = load_tables(write_tables(tmp_path, TABLE.replace("[T053]", "[T053, T054]")))
    assert unknown.faults == ("small: T054 is no number of the manifest",)


def test_groups_are_read_by_their_folder_or_by_table(tmp_path: Path) -> None:
    folders = [write_tables(tmp_path / name) for name in ("thesis", "published")]
    assert [group.folder.name for group in load_groups(folders)] == ["thesis", "published"]
    assert [group.folder.name for group in load_groups(folders, ["published"])] == ["published"]
    assert [list(group.tables) for group in load_groups(folders, ["small"])] == [["small"], ["small"]]
    with pytest.raises(UnknownName, match="did you mean 'published'"):
        load_groups(folders, ["publisht"])
