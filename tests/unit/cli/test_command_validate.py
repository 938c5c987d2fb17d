"""``tactsim validate``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from thesis_tables import TABLE, write_tables

from tactsim.cli import main
from tactsim.results.writing import write_files
from tactsim.validation import StudyRunner
from tactsim.validation.execution import Progress, Studies


def validate(folder: Path, *arguments: str) -> int:
    return main(["validate", "--from", str(folder / "tables"), "--out", str(folder / "out"), *arguments])


def test_known_deviations_do_not_fail(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, "small") == 0
    text = capsys.readouterr().out
    assert "outside by 0.5" in text
    assert "every row ended as recorded" in text
    report = json.loads((tmp_path / "out" / "validation.json").read_text(encoding="utf-8"))
    assert report["passed"] is True
    group = report["groups"]["tables"]
    assert group["counts"][0]["rows"] == "3 of 3"
    assert [row["ended"] for row in group["tables"]["small"]["rows"]] == ["reproduced", "outside by 0.5", "not testable"]
    assert [(row["expected"], row["computed"], row["unit"]) for row in group["tables"]["small"]["rows"][:2]] == [
        (125.0, pytest.approx(125.0, rel=1e-12), "N/m"),
        (250.0, pytest.approx(125.0, rel=1e-12), "N/m"),
    ]
    assert "| small | 3 of 3 | 1 | 0 | 0 | 0 | 1 | 0 | 0 | 0 | 1 | 0 |" in (tmp_path / "out" / "validation.md").read_text("utf-8")


def test_a_report_takes_the_place_of_an_earlier_one_and_of_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, "small") == validate(tmp_path, "small") == 0
    write_files({"comparison.csv": b"kept"}, tmp_path / "compared")
    write_files({"result.json": b"{}"}, tmp_path / "run")
    for name in ("compared", "run"):
        assert main(["validate", "--from", str(tmp_path / "tables"), "--out", str(tmp_path / name)]) == 5
        assert not (tmp_path / name / "validation.json").exists()
    refused = capsys.readouterr().err
    assert "compared holds something else than a validation report, which is not replaced" in refused
    assert "run holds a result, which no validation report replaces" in refused


def test_the_report_opens_from_disk(tmp_path: Path) -> None:
    """One file: figures inside, nothing fetched, text of tables escaped, errata in words where they are used."""
    text = TABLE.replace("half the displacement was meant", "'E4: <b>half</b> of it'")
    write_tables(tmp_path / "tables", text)
    assert validate(tmp_path) == 0
    page = (tmp_path / "out" / "validation.html").read_text(encoding="utf-8")
    assert '<abbr title="a missing term">E4</abbr>: &lt;b&gt;half&lt;/b&gt; of it' in page
    assert page.count("data:image/png;base64,") == 1, "the overview"
    assert not re.search(r'(src|href)="(?!data:|#)', page)


@pytest.mark.parametrize(("old", "new"), [("125 N/m", "126 N/m"), ("by: 0.5", "by: 0.6")])
def test_a_row_that_leaves_its_state_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str) -> None:
    write_tables(tmp_path / "tables", TABLE.replace(old, new))
    assert validate(tmp_path) == 4
    assert "left their class: small." in capsys.readouterr().out
    assert json.loads((tmp_path / "out" / "validation.json").read_text(encoding="utf-8"))["passed"] is False


def test_an_absent_row_or_file_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_tables(tmp_path / "tables", TABLE.split("  - id: supply", maxsplit=1)[0])
    assert validate(tmp_path) == 4
    assert "fault: small: 2 rows where the manifest counts 3" in capsys.readouterr().out
    (folder / "small.yaml").unlink()
    assert validate(tmp_path) == 4
    assert "0 of 3" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["tabels"], ["small", "--workers", "0"]])
def test_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str]) -> None:
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, *arguments) == 2
    assert not (tmp_path / "out").exists()


def test_shipped_tables_are_found_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["validate", "table_3_3"]) == 0
    assert (tmp_path / "results" / "validation" / "validation.md").is_file()


def test_a_place_that_is_taken_is_refused_before_computing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_tables(tmp_path / "tables")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.docx").write_text("mine")
    assert validate(tmp_path, "small") == 5
    out, err = capsys.readouterr()
    assert not out, "a table that is printed was computed"
    assert "'thesis.docx', which tactsim did not write" in err


@pytest.mark.parametrize(
    ("computed", "kept", "words"),
    [
        (0, 7, "all 7 simulations of the studies are from the cache; --fresh computes them again\n"),
        (2, 5, "2 simulations were computed, 5 are from the cache; --fresh computes them again\n"),
        (0, 1, "the only simulation of the studies is from the cache; --fresh computes it again\n"),
        (1, 1, "1 simulation was computed, 1 is from the cache; --fresh computes it again\n"),
        (7, 0, ""),
    ],
)
def test_progress_is_reported_to_a_file_if_asked_for_and_the_cache_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], computed: int, kept: int, words: str
) -> None:
    def outcomes(self: StudyRunner, tables: dict[str, object], folder: Path, progress: Progress) -> Iterator[tuple[str, Studies]]:
        progress("1/7 simulations")
        self.computed.update(map(str, range(computed)))
        self.from_cache.update(map(str, range(kept)))
        yield from ((name, {}) for name in tables)

    monkeypatch.setattr(StudyRunner, "outcomes", outcomes)
    monkeypatch.setattr("tactsim.validation.figures.overview", lambda *rows: b"")  # how it looks is of no interest
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, "small") == 0
    printed, noted = capsys.readouterr()
    assert ("1/7" in noted, "cache" in printed, words in printed) == (False, bool(words), True)
    assert validate(tmp_path, "small", "--progress") == 0
    assert "  1/7 simulations\n" in capsys.readouterr().err


def test_an_interruption_says_what_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def outcomes(self: StudyRunner, *arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(StudyRunner, "outcomes", outcomes)
    write_tables(tmp_path / "tables")
    assert validate(tmp_path, "small") == 130
    assert "interrupted: no report is written; simulations that ended are kept" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
