"""``tactsim run``."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from pretence import PNG, Pretence

from tactsim import plotting
from tactsim.case import load_case
from tactsim.cli import main
from tactsim.errors import CaseError
from tactsim.interfaces.run import Course, Findings
from tactsim.progress import COMPILATION, Extent
from tactsim.results import StepRecord, read_result


@pytest.fixture(autouse=True)
def in_the_folder_of_the_case(case_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(case_file.parent)


def status_of(folder: str) -> str:
    return str(json.loads(Path(folder, "result.json").read_text(encoding="utf-8"))["status"])


def test_a_run_reports_quantities_and_ends_with_the_threshold(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml"]) == 0
    out, err = capsys.readouterr()
    lines = out.splitlines()
    assert lines[:2] == ["A pretended case", "converged: all steps accepted"]
    assert lines[2].split()[:3] == ["displacement", "300", "µm"]
    assert "2 x 3 values, 0 N to 5 N" in out
    assert "warning: coarse mesh" in out
    assert "1 assumption listed in result.json" in out
    assert lines[-1] == "threshold pressure 17.2 kPa; figure results/case/figures/pretence.png"
    assert Path("results/case/figures/pretence.png").read_bytes() == PNG
    assert err == ""


def test_the_time_left_does_not_count_compiling(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    clock = [0.0]
    monkeypatch.setattr("tactsim.cli.command_run.time.monotonic", lambda: clock[0])
    begin = Pretence.begin

    def compiled(self: Pretence) -> Course:
        clock[0] += 32.0
        monkeypatch.setattr(COMPILATION, "seconds", COMPILATION.seconds + 30.0)
        return begin(self)

    monkeypatch.setattr(Pretence, "begin", compiled)
    monkeypatch.setattr(Pretence, "extent", property(lambda self: Extent("displacement", 3e-4)))
    assert main(["run", "case.yaml", "--progress"]) == 0
    assert "about 4 s left" in capsys.readouterr().err.splitlines()[0]


def test_a_report_says_whose_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    text = Path("case.yaml").read_text(encoding="utf-8")
    Path("untitled.yaml").write_text(
        "\n".join(line for line in text.splitlines() if not line.startswith("title")), encoding="utf-8"
    )
    assert main(["run", "untitled.yaml", "--figures", "none"]) == 0
    assert capsys.readouterr().out.startswith("untitled\nconverged")
    assert main(["show", "results/untitled"]) == 0
    assert capsys.readouterr().out.startswith("untitled\nconverged")
    assert main(["run", "case.yaml", "untitled.yaml", "--figures", "none"]) == 0
    reports = capsys.readouterr().out.split("\n\n")
    assert [report.splitlines()[0] for report in reports[:2]] == ["case: A pretended case", "untitled"]


def test_provenance_holds_the_resolved_case_and_the_overrides() -> None:
    assert main(["run", "case.yaml", "--set", "experiment.steps=1", "--quiet"]) == 0
    stored = read_result("results/case")
    assert stored.provenance["case"]["experiment"]["steps"] == 1
    assert stored.provenance["overrides"] == ["experiment.steps=1"]
    assert stored.provenance["case_id"] == stored.case_id
    assert len(stored.result.steps) == 1


def test_quiet_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["run", "case.yaml", "--quiet", "--figures", "none", "--set", "experiment.fail_at=2"]) == 3
    words = "error: case.yaml: failed: residual 1.0 after 25 iterations; result results/case\n"
    assert capsys.readouterr() == ("", words), "that it failed is an error"


def test_progress_reports_every_accepted_step(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml", "--progress"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert " ".join(lines[1].split()) == "step 2 displacement 200 µm reaction_force 20 mN 4 iterations, residual 1.0e-11"


def test_what_looks_wrong_is_said_before_it_is_computed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Pretence, "doubts", lambda self: ["a block of 4 km"])
    assert main(["run", "case.yaml", "--progress"]) == 0
    assert capsys.readouterr().err.splitlines()[0] == "warning: a block of 4 km"
    assert main(["run", "case.yaml"]) == 0
    assert capsys.readouterr().err == "", "nobody watches, and the result says it"
    monkeypatch.setattr(Pretence, "doubts", lambda self: "a single text")
    assert main(["run", "case.yaml", "--progress"]) == 0
    assert capsys.readouterr().err.splitlines()[0] == "warning: a single text"


def test_the_help_names_every_file_that_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml"]) == 0
    capsys.readouterr()
    assert main(["run", "--help"]) == 0
    shown = capsys.readouterr().out
    written = {file.name for file in Path("results/case").iterdir()}
    assert {name for name in written if name not in shown and not name.endswith(".vtu")} == set()


def test_a_run_that_fails_is_written_and_presents_no_threshold(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml", "--set", "experiment.fail_at=2"]) == 3
    assert status_of("results/case") == "failed"
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("failed: residual 1.0 after 25 iterations; ")
    assert "threshold" not in last


def test_the_default_folder_is_replaced_but_a_good_result_is_not_lost() -> None:
    assert main(["run", "case.yaml"]) == 0
    assert main(["run", "case.yaml"]) == 0
    assert os.listdir("results") == ["case"]
    assert main(["run", "case.yaml", "--set", "experiment.fail_at=2"]) == 3
    assert (status_of("results/case"), status_of("results/case.earlier")) == ("failed", "converged")
    assert main(["run", "case.yaml", "--set", "experiment.fail_at=1"]) == 3
    assert status_of("results/case.earlier") == "converged"


def test_a_named_folder_needs_force_and_is_checked_before_computing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "case.yaml", "--out", "mine"]) == 0
    with monkeypatch.context() as patch:
        patch.setattr(Pretence, "begin", lambda self: pytest.fail("computed before the folder was checked"))
        assert main(["run", "case.yaml", "--out", "mine"]) == 5
    assert "use --force" in capsys.readouterr().err
    assert main(["run", "case.yaml", "--out", "mine", "--force", "--set", "experiment.fail_at=2"]) == 3
    assert status_of("mine") == "failed"
    assert not Path("mine.earlier").exists()


@pytest.mark.parametrize(("fields", "count"), [("all", 3), ("last", 1), ("none", 0)])
def test_the_case_says_which_fields_are_written(fields: str, count: int) -> None:
    assert main(["run", "case.yaml", "--set", f"output.fields={fields}"]) == 0
    assert len(list(Path("results/case").glob("fields_*.vtu"))) == count


def test_a_figure_that_cannot_be_drawn_does_not_cost_the_numbers(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken() -> bytes:
        raise ZeroDivisionError("nothing to draw")

    monkeypatch.setattr(plotting, "figures_for", lambda result: {"good": lambda: PNG, "bad": broken})
    assert main(["run", "case.yaml"]) == 0
    line = f"line {broken.__code__.co_firstlineno + 1} of {__name__}"
    assert f"warning: not every figure could be drawn: ZeroDivisionError: nothing to draw; from {line}" in capsys.readouterr().out
    assert os.listdir("results/case/figures") == ["good.png"]
    assert any("could be drawn" in warning for warning in read_result("results/case").result.warnings)


def test_a_disk_that_fills_up_still_shows_the_numbers(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from tactsim.storage import files

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    assert main(["run", "case.yaml"]) == 5
    out, err = capsys.readouterr()
    assert "threshold_pressure  17.2 kPa" in out
    assert err == "error: cannot write results/case: No space left on device\n"
    assert os.listdir("results") == []


def test_a_bad_case_leaves_no_trace(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "case.yaml", "--set", "experiment.friction=9"]) == 2
    assert capsys.readouterr().err == "error: --set experiment.friction: 9 is out of range; must be at most 2.0\n"
    with pytest.raises(CaseError, match=r"^override experiment\.friction: 9 is out of range"):
        load_case("case.yaml", ["experiment.friction=9"])  # which no command line was asked for
    assert not Path("results").exists()


@pytest.mark.parametrize(("form", "names"), [("none", None), ("svg", ["pretence.svg"]), ("pdf", ["pretence.pdf"])])
def test_the_form_of_the_figures_is_chosen(monkeypatch: pytest.MonkeyPatch, form: str, names: list[str] | None) -> None:
    drawn: list[str] = []

    def draw(form: str = "png") -> bytes:
        drawn.append(form)
        return form.encode()

    monkeypatch.setattr(plotting, "figures_for", lambda result: {"pretence.png": draw})
    assert main(["run", "case.yaml", "--figures", form]) == 0
    figures = Path("results/case/figures")
    assert (os.listdir(figures) if figures.exists() else None) == names
    assert drawn == ([] if names is None else [form])


@pytest.mark.parametrize("begun", [False, True], ids=["before it", "within it"])
def test_an_interruption_before_the_first_step_says_that_nothing_is_written(
    begun: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def step() -> Iterator[StepRecord]:
        yield signal.raise_signal(signal.SIGINT)

    def begin(self: Pretence) -> Course:
        return Course(step(), lambda: Findings("")) if begun else signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Pretence, "begin", begin)
    assert main(["run", "case.yaml"]) == 130
    assert capsys.readouterr().err == "error: interrupted: nothing was accepted yet, so results/case is not written\n"
    assert not Path("results/case").exists()
