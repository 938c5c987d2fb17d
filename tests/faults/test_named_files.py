"""Files that a case names: found beside it from any folder, reported with file, line and key, and when they lie elsewhere."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tactsim.cli import main
from tactsim.shipped import CASES

NAME = "calibrate_force_sensor.yaml"
DATA = "force_sensor_calibration.csv"
KEY = "experiment.data.path"


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The shipped calibration from a file, in a folder of its own that is not the working folder."""
    (tmp_path / "mine" / "data").mkdir(parents=True)
    (tmp_path / "work").mkdir()
    shutil.copy(CASES / NAME, tmp_path / "mine")
    shutil.copy(CASES / "data" / DATA, tmp_path / "mine" / "data")
    monkeypatch.chdir(tmp_path / "work")
    return tmp_path / "mine" / NAME


def warnings_of(out: Path) -> list[str]:
    return [line for line in json.loads((out / "result.json").read_text())["warnings"] if KEY in line]


def test_a_case_runs_from_any_folder(case: Path, tmp_path: Path) -> None:
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert warnings_of(tmp_path / "out") == []


def test_the_working_folder_is_searched_too(case: Path, tmp_path: Path) -> None:
    shutil.move(tmp_path / "mine" / "data", tmp_path / "work" / "data")
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert warnings_of(tmp_path / "out") == []


@pytest.mark.parametrize("how", ["absolute", "climbing", "linked"])
def test_what_lies_elsewhere_is_reported(case: Path, tmp_path: Path, how: str) -> None:
    (tmp_path / "far").mkdir()
    there = shutil.move(tmp_path / "mine" / "data" / DATA, tmp_path / "far" / DATA)
    if how == "linked":
        os.symlink(there, tmp_path / "mine" / "data" / DATA)
    path = {"absolute": str(there), "climbing": f"../far/{DATA}", "linked": f"data/{DATA}"}[how]
    assert main(["run", str(case), "--out", str(tmp_path / "out"), "--quiet", "--set", f"{KEY}={path}"]) == 0
    (line,) = warnings_of(tmp_path / "out")
    assert line == f"{KEY}: {path} lies neither beside the case nor in the working folder"


def put_a_pipe(place: Path) -> None:
    os.mkfifo(place)


def put_a_device(place: Path) -> None:
    os.symlink("/dev/zero", place)


@pytest.mark.parametrize(
    ("put", "words"),
    [
        (lambda place: None, "No such file or directory; looked in the folder of the case and in the working folder"),
        (put_a_pipe, "it is a pipe; allowed: a regular file"),
        (put_a_device, "it is a device; allowed: a regular file"),
        (lambda place: os.symlink("nowhere", place), "No such file or directory"),
    ],
)
def test_what_cannot_be_read_is_reported_with_file_line_and_key(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], put: Callable[[Path], None], words: str
) -> None:
    place = tmp_path / "mine" / "data" / DATA
    place.unlink()
    put(place)
    assert main(["run", str(case), "--out", str(tmp_path / "out")]) == 5
    printed = capsys.readouterr().err
    line = next(k for k, text in enumerate(case.read_text().splitlines(), 1) if DATA in text)
    assert printed.startswith(f"error: {case}:{line}: {KEY}: cannot read the file data/{DATA}: ")
    assert words in printed
    assert sorted(os.listdir(tmp_path)) == ["mine", "work"]


def test_an_option_that_names_a_missing_file_is_blamed(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case), "--set", f"{KEY}=none.csv"]) == 5
    assert capsys.readouterr().err.startswith(f"error: --set {KEY}: cannot read the file none.csv")


def test_a_missing_result_is_reported_with_file_line_and_key(capsys: pytest.CaptureFixture[str], case: Path) -> None:
    assert main(["run", str(CASES / "localize_lump.yaml")]) == 5
    assert "localize_lump.yaml:11: experiment.grasp: cannot read the file results/grasp_lump_icf" in capsys.readouterr().err


def test_a_shipped_case_says_what_to_run_before_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "localize_lump"]) == 5
    printed = capsys.readouterr().err
    assert "; run first\n   tactsim run grasp_lump_icf --out results/grasp_lump_icf\n   tactsim run grasp_plain --out" in printed
    assert main(["run", "localize_lump", "--set", "experiment.grasp=mine"]) == 5
    assert "run first" not in capsys.readouterr().err


def test_the_comment_of_a_stranger_is_no_advice(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text("#   rm -r results/mine\n" + (CASES / "localize_lump.yaml").read_text().replace("results/", "results/mine"))
    assert main(["run", str(case)]) == 5
    assert "run first" not in capsys.readouterr().err


def test_a_missing_surface_is_reported_with_file_line_and_key(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text((CASES / "grasp_stl.yaml").read_text().replace("meshes/lump.stl", "mine.stl"))
    assert main(["run", str(case)]) == 5
    line = next(k for k, text in enumerate(case.read_text().splitlines(), 1) if "mine.stl" in text)
    key = "experiment.inclusions.0.shape.path"
    assert capsys.readouterr().err.startswith(f"error: {case}:{line}: {key}: cannot read the surface mine.stl")
    assert main(["run", "grasp_stl", "--set", f"{key}=mine.stl"]) == 5
    assert capsys.readouterr().err.startswith(f"error: --set {key}: cannot read the surface mine.stl")


def test_the_path_of_a_checkout_leads_to_the_name(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "cases/annulus_icf.yaml"]) == 5
    assert "tactsim comes with a case of this name: write annulus_icf, without folder" in capsys.readouterr().err
    assert main(["run", "cases/mine.yaml"]) == 5
    assert "comes with" not in capsys.readouterr().err
    assert main(["run", "annulus_ifc"]) == 2
    assert capsys.readouterr().err == "error: unknown case 'annulus_ifc' (did you mean 'annulus_icf'?); tactsim list lists all\n"


@pytest.mark.parametrize("path", ["a\\0b", "", " "])
def test_a_path_that_cannot_be_is_bad_input(case: Path, capsys: pytest.CaptureFixture[str], path: str) -> None:
    assert main(["run", str(case), "--set", f'{KEY}="{path}"']) == 2
    assert "a path of 1 to 4096 characters without a null character" in capsys.readouterr().err


def test_a_case_that_is_a_pipe_is_refused_at_once(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.unlink()
    os.mkfifo(case)
    assert main(["run", str(case)]) == 5
    assert "it is a pipe; allowed: a regular file" in capsys.readouterr().err
