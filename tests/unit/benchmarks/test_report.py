"""The report with figures that are made up: every part has its rows, of one machine and one state of the package."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

import matplotlib.pyplot as plt
import pandas as pd
import pytest

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"


@pytest.fixture
def report(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHMARKS)
    module = importlib.import_module("report")
    monkeypatch.setattr(module.history, "machine", lambda: "2 x drum, Python 3")
    monkeypatch.setattr(module.history, "today", lambda: "1999-12-31")
    monkeypatch.setattr(module.history, "commit", lambda: "c0ffee1")
    monkeypatch.setattr(module.history, "package", lambda: "beef cafe")
    return module


class Ones(dict[str, float]):
    """Any figure is 1."""

    def __missing__(self, name: str) -> float:
        return 1.0


def made_up(report: ModuleType) -> dict[str, dict]:
    """Figures of every part."""
    figures: dict[str, dict] = {name: Ones() for name in report.PARTS}
    run = Ones(here_seconds=4.0, base_seconds=12.0, here_case_seconds=2.0, base_case_seconds=10.0)
    run |= {"here_solving_seconds": 1.5, "base_solving_seconds": 9.0}
    sweep = Ones(here=500.0, base=250.0, here_done=20.0, base_done=18.0, ratio=2.0)
    figures["against"] = {name: sweep if job.is_sweep else run for name, job in report.against.JOBS.items()}
    figures["validate"] = Ones(rows_left=0.0, rows=600.0, from_nothing_seconds=477.0)
    figures["scale"] = {
        "0.4": Ones(unknowns=381_170.0),
        "0.3": Ones(unknowns=1e6, finished=0.0),
        "exponent": 1.3,
        "exponent_of_a_system": 1.2,
    }
    figures["stretch"] = {"63375": {**dict.fromkeys(("systems", "force_error"), 1.0), "seconds": 20.0, "machine": "drum"}}
    figures["peers"] = peers_figures()
    return figures


def measurements(figures: dict[str, dict], **others: str) -> dict[str, dict]:
    """The same with what they are of."""
    of = {"machine": "2 x drum, Python 3", "package": "beef cafe", "day": "1999-12-31", "commit": "c0ffee1"} | others
    return {name: {**of, "figures": part} for name, part in figures.items()}


def peers_figures() -> dict[str, float | str]:
    """Of one block, where one program is installed, one is not, and one was stopped."""
    seconds = {"43245_tactsim_seconds": 5.0, "43245_felupe_seconds": 30.0, "43245_calculix_seconds": 100.0}
    versions = {"43245_felupe_version": "11.3.0", "43245_calculix_version": "2.20"}
    others = {"43245_getfem": "not installed", "43245_fenicsx": "stopped after 5 s"}
    differences = {"43245_calculix_difference_from_felupe": 7e-8, "agreement_largest_difference": 8e-6}
    return {**seconds, **versions, **others, **differences, "43245_ratio": 6.1}


def row(text: str, begin: str) -> list[str]:
    """The cells of the row whose first cell begins so."""
    (line,) = [line for line in text.splitlines() if line.startswith(f"| {begin}")]
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_table_has_every_part_and_names_its_origin(report: ModuleType) -> None:
    text = report.table(measurements(made_up(report)))
    assert text.endswith("\n\nOn 2 x drum, Python 3; 1999-12-31.")
    lines = text.splitlines()[2:-2]
    assert all(line.count("|") == 5 for line in lines)
    firsts = [line.split("|")[1] for line in lines]
    assert len(set(firsts)) == len(firsts)
    for name, part in report.PARTS.items():
        rows = part.rows(made_up(report)[name])
        assert rows
        assert all("| " + " | ".join(cells) + " | c0ffee1 |" in lines for cells in rows)


def test_parts_of_other_states_stand_with_their_commit_day_and_machine(report: ModuleType) -> None:
    figures = made_up(report)
    later = measurements({"grasp": figures["grasp"]}, commit="decade5", day="2000-01-01", machine="lathe")
    text = report.table(measurements(figures) | later)
    assert text.endswith("\n\nOn 2 x drum, Python 3; lathe; 1999-12-31 to 2000-01-01.")
    assert row(text, "memory of")[-1] == "decade5"
    assert row(text, "`annulus_icf.yaml`")[-1] == "c0ffee1"


def test_a_job_that_was_measured_by_itself_has_a_commit_of_its_own(report: ModuleType) -> None:
    parts = measurements(made_up(report))
    slower = {"grasp_lump_icf": parts["against"]["figures"]["grasp_lump_icf"] | {"here_case_seconds": 3.0}}
    newer = {**parts["against"], "commit": "decade5", "figures": slower}
    text = report.table(parts | {"against": report.with_jobs(parts["against"], newer)})
    assert row(text, "`grasp_lump_icf.yaml`, to")[2].startswith("3.00 s")
    assert row(text, "`grasp_lump_icf.yaml`, to")[-1] == "decade5"
    assert row(text, "`annulus_icf.yaml`")[-1] == "c0ffee1"


def test_figures_stand_in_one_row_each_with_what_is_asked(report: ModuleType) -> None:
    text = report.table(measurements(made_up(report)))
    assert row(text, "`annulus_icf.yaml`")[1:3] == [
        "5 s",
        "4.00 s, 3.0 times as fast as 26a5475 (12.0 s); 1.5 and 9.0 s of them solving",
    ]
    assert row(text, "`grasp_lump_icf.yaml`, to")[1:3] == [
        "5 s",
        "2.00 s, 5.0 times as fast as 26a5475 (10.0 s); 1.5 and 9.0 s of them solving, 4.0 s with all figures",
    ]
    assert row(text, "`atrial_annulus.yaml`")[1] == "15 s"
    assert row(text, "`sweep_classes.yaml`")[:3] == [
        "`sweep_classes.yaml` by turns, 20 of 20 samples done",
        "1000 per hour",
        "500 per hour, 2.0 times as many as 26a5475 (250 per hour)",
    ]
    assert row(text, "samples of `sweep_lumps.yaml`")[1] == "4 000 per hour"
    assert row(text, "time of `grasp_lump_icf.yaml` with 16 x 16")[1] == "1.05"
    assert row(text, "`tactsim validate`")[:3] == [
        "`tactsim validate`, nothing kept: 600 rows, each as recorded",
        "480 s",
        "477 s, 1 s of processors",
    ]
    assert row(text, "neo-Hookean plate")[2].startswith("20.0 s (drum)")


def test_a_size_that_was_not_solved_is_said_to_be(report: ModuleType) -> None:
    text = report.table(measurements(made_up(report)))
    assert row(text, "`grasp_lump_icf.yaml` by iteration in one step, 381 170")[1:3] == [
        "60 iterations a system, 24 GB",
        "at most 1 iterations, mean 1, in 1 systems; 1.1 GB; 1 s, 1 s of processors",
    ]
    largest = row(text, "`grasp_lump_icf.yaml` by iteration in one step, 1 000 000")
    assert largest[1].endswith("3600 s")
    assert largest[2].startswith("not solved: ")


def test_every_program_has_a_row_with_its_version_or_why_it_has_no_figure(report: ModuleType) -> None:
    text = report.table(measurements({"peers": peers_figures()}))
    block = "block of 43 245 displacement unknowns, faster than"
    assert row(text, f"{block} FElupe 11.3.0 by")[1:3] == ["7 times", "6.1 times (5.0 against 30.0 s)"]
    assert row(text, f"{block} CalculiX 2.20 by")[2].startswith("20.0 times (5.0 against 100.0 s), 7e-08 off")
    assert row(text, f"{block} GetFEM by")[2] == "not installed"
    assert row(text, f"{block} FEniCSx by")[2] == "stopped after 5 s"


@pytest.fixture
def kept(report: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """The report with files of its own and parts that cost nothing; the names of those measured, as they are."""
    (tmp_path / "README.md").write_text(f"before\n\n{report.START}\nold\n{report.END}\n\nafter\n")
    monkeypatch.setattr(report, "README", tmp_path / "README.md")
    monkeypatch.setattr(report, "MEASURED", tmp_path / "measured.json")
    monkeypatch.setattr(report.history, "HISTORY", tmp_path / "history.csv")
    figures, calls = made_up(report), []
    for name, part in report.PARTS.items():
        monkeypatch.setattr(part, "measure", lambda name=name: calls.append(name) or figures[name])
        monkeypatch.setattr(part, "rows", lambda taken, name=name: [(name, "-", f"{len(taken)} figures")])
    return calls


def run(report: ModuleType, monkeypatch: pytest.MonkeyPatch, *words: str) -> None:
    """The report by its command line."""
    monkeypatch.setattr("sys.argv", ["report.py", *words])
    report.main()


def test_readme_has_all_kept_parts(report: ModuleType, kept: list[str], monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    run(report, monkeypatch, "peers", "--keep")
    assert "| peers | - | 10 figures | c0ffee1 |" in report.README.read_text()
    monkeypatch.setattr(report.history, "commit", lambda: "decade5")
    run(report, monkeypatch, "scale", "grasp", "--keep")
    text = report.README.read_text()
    assert text.startswith(f"before\n\n{report.START}\n| what | asked | measured | commit |\n|---|---|---|---|\n| grasp |")
    assert text.endswith(f"\n\nOn 2 x drum, Python 3; 1999-12-31.\n{report.END}\n\nafter\n")
    assert [line.split("|")[4].strip() for line in text.splitlines()[5:8]] == ["decade5", "decade5", "c0ffee1"]
    assert "| peers |" not in capsys.readouterr().out.rpartition("| what |")[2]
    written = pd.read_csv(report.history.HISTORY, dtype=str).set_index("figure")["value"]
    assert written["peers.43245_getfem"] == "not installed"
    assert written["scale.0.4.unknowns"] == "381170"


def test_nothing_is_kept_unless_asked(report: ModuleType, kept: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    run(report, monkeypatch, "grasp")
    assert kept == ["grasp"]
    assert not report.MEASURED.exists()
    assert "old" in report.README.read_text()


def test_only_parts_of_another_state_or_machine_are_stale(report: ModuleType, kept: list[str], monkeypatch) -> None:
    run(report, monkeypatch, "grasp", "--keep")
    run(report, monkeypatch, "grasp", "taxels", "--stale", "--keep")
    assert kept == ["grasp", "taxels"]
    monkeypatch.setattr(report.history, "package", lambda: "another")
    run(report, monkeypatch, "grasp", "--stale", "--keep")
    monkeypatch.setattr(report.history, "machine", lambda: "lathe")
    run(report, monkeypatch, "grasp", "--stale")
    assert kept == ["grasp", "taxels", "grasp", "grasp"]


def test_figures_outlive_a_part_that_fails(report: ModuleType, kept: list[str], monkeypatch) -> None:
    def failing() -> dict[str, float]:
        raise RuntimeError("no such program")

    monkeypatch.setattr(report.taxels, "measure", failing)
    with pytest.raises(RuntimeError, match="no such program"):
        run(report, monkeypatch, "grasp", "taxels", "--keep")
    assert list(report.kept_parts()) == ["grasp"]


def test_table_of_the_readme_is_that_of_the_kept_figures(report: ModuleType) -> None:
    text = report.README.read_text(encoding="utf-8")
    assert report.with_table(text, report.table(report.kept_parts())) == text


def test_marks_of_the_readme_are_those_of_the_report(report: ModuleType) -> None:
    text = report.README.read_text(encoding="utf-8")
    assert text.count(report.START) == text.count(report.END) == 1
    page = (report.README.parent / "docs" / "verification" / "speed.md").read_text(encoding="utf-8")
    assert report.START in page
    assert report.END in page


def test_kept_history_holds_measurements_of_known_parts_only(report: ModuleType) -> None:
    names = pd.read_csv(report.history.HISTORY)["figure"]
    assert {name.split(".")[0] for name in names} <= set(report.PARTS)
    assert not [name for name in names if name.endswith("asked")]


def test_a_machine_has_one_colour_in_every_panel(report: ModuleType, monkeypatch, tmp_path: Path) -> None:
    lines = [("old", "drum", "a.seconds", "2"), ("new", "lathe", "a.seconds", "1"), ("new", "lathe", "b.seconds", "3")]
    lines += [("new", "lathe", "b.version", "11.3.0"), ("new", "lathe", "b.absent", "not installed")]
    columns = list(report.history.COLUMNS)
    history = tmp_path / "history.csv"
    pd.DataFrame([("1999-12-31", *line) for line in lines], columns=columns).to_csv(history, index=False)
    monkeypatch.setattr(report.history, "HISTORY", history)
    monkeypatch.setattr(plt, "close", lambda figure: None)
    report.history.draw(tmp_path / "history.png", ("*",))
    figure = plt.gcf()
    monkeypatch.undo()
    drawn = {ax.get_title(): [line.get_color() for line in ax.lines] for ax in figure.axes if ax.get_title()}
    (legend,) = figure.legends
    plt.close(figure)
    assert drawn == {"a.seconds": ["C0", "C1"], "b.seconds": ["C1"]}
    assert {text.get_text(): line.get_color() for text, line in zip(legend.get_texts(), legend.get_lines(), strict=True)} == {
        "drum": "C0",
        "lathe": "C1",
    }


def test_nested_figures_are_named_by_their_path(report: ModuleType) -> None:
    figures = {"a": {"b": 1, "version": "2.20", "list": [1]}, "c": 2.5}
    assert report.history.flat(figures) == {"a.b": 1.0, "a.version": "2.20", "c": 2.5}
