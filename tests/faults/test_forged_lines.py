"""Text that others wrote never steers a terminal nor begins a line of its own; warnings of libraries become those of the run."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pretence
import pytest

from tactsim.case.loading import MOST_PROBLEMS, case_error
from tactsim.case.yaml_reading import Problem
from tactsim.cli import main
from tactsim.interfaces.run import Course
from tactsim.storage.own_files import MANIFEST

FORGED = "ok\x1b[31m\nconverged: FAKE\r\x07\x9b2J\u202e"


def harmless(text: str) -> bool:
    """Whether nothing in what was written can steer a terminal or pretends to be a line of ours."""
    return all(c.isprintable() or c in "\n\t" for c in text) and not any(
        line.startswith("converged: FAKE") for line in text.splitlines()
    )


def test_a_title_cannot_forge(case_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    title = json.dumps(FORGED)
    assert main(["run", str(case_file), "--out", str(tmp_path / "out"), "--set", f"title={title}"]) == 0
    printed = capsys.readouterr()
    assert "ok\\x1b[31m\\nconverged: FAKE" in printed.out
    assert harmless(printed.out + printed.err)


@pytest.mark.parametrize("place", ["reason", "warnings", "case_id", "quantities"])
def test_a_stored_result_cannot_forge(case_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str) -> None:
    assert main(["run", str(case_file), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    stored = tmp_path / "out" / "result.json"
    content = json.loads(stored.read_text())
    quantity = {"value": 1.0, "unit": FORGED, "description": FORGED}
    content[place] = {"reason": FORGED, "warnings": [FORGED], "case_id": FORGED, "quantities": {FORGED: quantity}}[place]
    stored.write_text(json.dumps(content))
    (tmp_path / "out" / MANIFEST).unlink()
    code = main(["show", str(tmp_path / "out")])
    printed = capsys.readouterr()
    assert code in (0, 5)
    assert harmless(printed.out + printed.err)


@pytest.mark.parametrize("arguments", [["run", FORGED], ["show", FORGED], ["sweep", FORGED, "--out", "x"], ["material", FORGED]])
def test_a_path_cannot_forge(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) in (2, 5)
    printed = capsys.readouterr()
    assert harmless(printed.out + printed.err)


@pytest.mark.parametrize("key", ["title", FORGED, "experiment.specimen"])
def test_a_key_or_a_value_cannot_forge(case_file: Path, capsys: pytest.CaptureFixture[str], key: str) -> None:
    case_file.write_text(case_file.read_text() + f"{json.dumps(key)}: {json.dumps([FORGED])}\n")
    assert main(["run", str(case_file)]) == 2
    printed = capsys.readouterr()
    assert harmless(printed.out + printed.err)


def test_thousands_of_faults_are_counted(case_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case_file.write_text(case_file.read_text() + "".join(f"unknown_{k}: 1\n" for k in range(9000)))
    assert main(["run", str(case_file)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 21
    assert lines[-1] == "and 8980 more faults"


def test_faults_are_counted_as_often_as_they_are_told() -> None:
    faults = [Problem(("key", k // 2), k // 2, "wrong") for k in range(2 * (MOST_PROBLEMS + 1))]
    *told, last = str(case_error(faults, lambda problem: f"line {problem.line}")).splitlines()
    assert (len(told), last) == (MOST_PROBLEMS, "and 1 more fault")


def test_warnings_of_libraries_are_those_of_the_run(
    case_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    calm = pretence.Pretence.begin

    def warned(self: pretence.Pretence) -> Course:
        warnings.warn(f"from a library {FORGED}", RuntimeWarning, stacklevel=1)
        np.float64(1e308) * np.float64(10)
        return calm(self)

    monkeypatch.setattr(pretence.Pretence, "begin", warned)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert main(["run", str(case_file), "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert harmless(printed.out)
    stored = json.loads((tmp_path / "out" / "result.json").read_text())["warnings"]
    assert any("overflow encountered" in line for line in stored)
    assert any("from a library ok\\x1b[31m" in line for line in stored)
    assert not any(str(Path(__file__).parent) in line for line in stored), "no path of the machine"
