"""``tactsim schema``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tactsim.case import case_json_schema
from tactsim.cli import main
from tactsim.dataset.sampling.json_schema import sweep_json_schema


def test_the_schema_is_printed_or_written(pretended: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == case_json_schema()
    assert main(["schema", "--out", str(tmp_path / "s.json")]) == 0
    assert json.loads((tmp_path / "s.json").read_text(encoding="utf-8")) == case_json_schema()
    assert main(["schema", "--out", str(tmp_path / "no" / "s.json")]) == 5
    (tmp_path / "empty.json").touch()
    for name in ("s.json", "empty.json"):
        assert main(["schema", "--out", str(tmp_path / name)]) == 0


@pytest.mark.parametrize("text", ["schema: tactsim/case/1\n", "[1]", '{"mine": 1}', "[" * 100_000, "\xff"])
def test_a_file_that_is_no_schema_is_kept(text: str, pretended: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(text, encoding="latin-1")
    assert main(["schema", "--out", str(mine)]) == 5
    assert "mine.yaml exists and is no JSON Schema; choose another FILE" in capsys.readouterr().err
    assert mine.read_text(encoding="latin-1") == text


def test_the_schema_of_sweeps_is_printed(pretended: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema", "--sweep"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == sweep_json_schema()
    assert printed != case_json_schema()
