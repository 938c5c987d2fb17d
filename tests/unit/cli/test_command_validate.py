"""``tactsim validate``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from thesis_tables import TABLE, write_tables

from tactsim.cli import main


def validate(folder: Path, *arguments: str) -> int:
    return main(["validate", "--from", str(folder / "tables"), "--out", str(folder / "out"), *arguments])


def test_known_deviations_do_not_fail(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, "small") == 0
    text = capsys.readouterr().out
    assert "outside by 0.5" in text
    assert "every row holds" in text
    report = json.loads((tmp_path / "out" / "validation.json").read_text(encoding="utf-8"))
    assert report["passed"] is True
    assert report["counts"][0]["rows"] == "3 of 3"
    assert [row["ended"] for row in report["tables"]["small"]["rows"]] == ["reproduced", "outside by 0.5", "assumption"]
    assert "| small | 3 of 3 | 1 | 0 | 1 | 0 | 1 | 0 |" in (tmp_path / "out" / "validation.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("old", "new"), [("125 N/m", "126 N/m"), ("outside_by: 0.5", "outside_by: 0.6")])
def test_a_row_that_leaves_its_state_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str) -> None:
    write_tables(tmp_path / "tables", TABLE.replace(old, new))
    assert validate(tmp_path) == 4
    assert "left their recorded state: small." in capsys.readouterr().out
    assert json.loads((tmp_path / "out" / "validation.json").read_text(encoding="utf-8"))["passed"] is False


def test_an_absent_row_or_file_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_tables(tmp_path / "tables", TABLE.split("  - id: supply", maxsplit=1)[0])
    assert validate(tmp_path) == 4
    assert "fault: small: 2 rows where the manifest counts 3" in capsys.readouterr().out
    (folder / "small.yaml").unlink()
    assert validate(tmp_path) == 4
    assert "0 of 3" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["tabel"], ["small", "--workers", "0"]])
def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]) -> None:
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, *arguments) == 2
    assert not (tmp_path / "out").exists()


def test_shipped_tables_are_found_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["validate", "table_3_3"]) == 0
    assert (tmp_path / "results" / "validation" / "validation.md").is_file()
