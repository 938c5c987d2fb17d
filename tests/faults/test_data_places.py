"""``tactsim data`` writes its reports and estimators where nothing else stands, and looks before it computes."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import pytest

from tactsim.cli import command_data, main
from tactsim.errors import StorageError


@pytest.mark.parametrize("action", ["rank", "confusion"])
@pytest.mark.parametrize("what", ["file", "pipe", "store", "report"])
def test_a_report_replaces_nothing_of_others(action: str, what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "report"
    if what == "file":
        place.write_text("mine")
    elif what == "pipe":
        os.mkfifo(place)
    else:
        place.mkdir()
        (place / {"store": "zarr.json", "report": "report.md"}[what]).write_text("mine")
    before = sorted(place.iterdir()) if place.is_dir() else []
    assert main(["data", action, str(tmp_path / "none"), "--reference", str(tmp_path), "--out", str(place)]) == 5
    error = capsys.readouterr().err
    assert "--out" in error or "move it away or choose another place" in error
    assert (sorted(place.iterdir()) if place.is_dir() else []) == before


def test_a_report_is_written_anew(tmp_path: Path) -> None:
    folder = tmp_path / "report"
    for text in ("first", "second"):
        command_data._refuse_place(folder)
        command_data._write(folder, {}, text, {"a.png": text.encode()})
    assert (folder / "report.md").read_text() == "second"
    (folder / "a.png").write_text("mine")
    with pytest.raises(StorageError, match=r"a\.png is not what tactsim wrote there"):
        command_data._write(folder, {}, "third", {"a.png": b"third"})
    assert (folder / "report.md").read_text() == "second"


@pytest.mark.parametrize("what", ["file", "pipe", "folder"])
def test_an_estimator_replaces_estimators_only(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "mine.npz"
    {"file": lambda: place.write_text("mine"), "pipe": lambda: os.mkfifo(place), "folder": place.mkdir}[what]()
    arguments = ["data", "train", str(tmp_path / "none"), "--reference", str(tmp_path), "--out", str(place)]
    assert main(arguments) == 5
    assert "is no estimator that tactsim wrote; choose another with --out" in capsys.readouterr().err
    assert what != "file" or place.read_text() == "mine"


def test_findings_without_end_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from tactsim.dataset import checking
    from tactsim.dataset.checking import Finding

    many = checking.Checked({}, tuple(Finding("kind", (), str(number)) for number in range(1000)))
    monkeypatch.setattr(checking, "check", lambda store: many)
    assert command_data._check(argparse.Namespace(store=tmp_path)) == 4
    assert len(capsys.readouterr().out.splitlines()) == 102
