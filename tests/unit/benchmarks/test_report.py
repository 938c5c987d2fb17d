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
    run = Ones(here_seconds=4.0, base_seconds=12.0, here_solving_seconds=2.0, base_solving_seconds=10.0, ratio=3.0)
    sweep = Ones(here=500.0, base=250.0, here_done=20.0, base_done=18.0, ratio=2.0)
    figures["against"] = {name: sweep if job.is_sweep else run for name, job in report.against.JOBS.items()}
    figures["validate"] = Ones(rows_left=0.0, rows=600.0, from_nothing_seconds=477.0)
    figures["scale"] = {
        "0.4": Ones(unknowns=381_170.0),
        "0.3": Ones(unknowns=1e6, finished=0.0),
        "exponent": 1.3,
        "exponent_of_a_system": 1.2,
    }
    figures["stretch"] = {"63375": Ones(seconds=20.0)}
    figures["peers"] = peers_figures()
    return figures


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
    text = report.table(made_up(report))
    assert text.endswith("\n\nOn 2 x drum, Python 3; 1999-12-31, commit c0ffee1.")
    lines = text.splitlines()[2:-2]
    assert all(line.count("|") == 4 for line in lines)
    firsts = [line.split("|")[1] for line in lines]
    assert len(set(firsts)) == len(firsts)
    for name, part in report.PARTS.items():
        rows = part.rows(made_up(report)[name])
        assert rows
        assert all("| " + " | ".join(cells) + " |" in lines for cells in rows)


def test_figures_stand_in_one_row_each_with_what_is_asked(report: ModuleType) -> None:
    text = report.table(made_up(report))
    assert row(text, "`annulus_icf.yaml`")[1:] == ["5 s", "4.00 s (2.0 s without figures), 3.0 times as fast as 26a5475 (12.0 s)"]
    assert row(text, "`grasp_lump_icf.yaml`, to")[1:] == [
        "5 s",
        "2.00 s (4.0 s with figures), 5.0 times as fast as 26a5475 (10.0 s)",
    ]
    assert row(text, "`atrial_annulus.yaml`")[1] == "15 s"
    assert row(text, "`sweep_classes.yaml`") == [
        "`sweep_classes.yaml` by turns, 20 of 20 samples done",
        "1000 per hour",
        "500 per hour, 2.0 times as many as 26a5475 (250 per hour)",
    ]
    assert row(text, "samples of `sweep_lumps.yaml`")[1] == "4 000 per hour"
    assert row(text, "time of `grasp_lump_icf.yaml` with 16 x 16")[1] == "1.05"
    assert row(text, "`tactsim validate`") == [
        "`tactsim validate`, nothing kept: 600 rows, each as recorded",
        "480 s",
        "477 s, 1 s of processors",
    ]
    assert row(text, "neo-Hookean plate")[2].startswith("20.0 s (2 x drum, Python 3, 1999-12-31)")


def test_a_size_that_was_not_solved_is_said_to_be(report: ModuleType) -> None:
    text = report.table(made_up(report))
    assert row(text, "`grasp_lump_icf.yaml` by iteration in one step, 381 170")[1:] == [
        "60 iterations a system, 24 GB",
        "at most 1 iterations, mean 1, in 1 systems; 1.1 GB; 1 s, 1 s of processors",
    ]
    largest = row(text, "`grasp_lump_icf.yaml` by iteration in one step, 1 000 000")
    assert largest[1].endswith("3600 s")
    assert largest[2].startswith("not solved: ")


def test_every_program_has_a_row_with_its_version_or_why_it_has_no_figure(report: ModuleType) -> None:
    text = report.table({"peers": peers_figures()})
    block = "block of 43 245 displacement unknowns, faster than"
    assert row(text, f"{block} FElupe 11.3.0 by")[1:] == ["7 times", "6.1 times (5.0 against 30.0 s)"]
    assert row(text, f"{block} CalculiX 2.20 by")[2].startswith("20.0 times (5.0 against 100.0 s), 7e-08 off")
    assert row(text, f"{block} GetFEM by")[2] == "not installed"
    assert row(text, f"{block} FEniCSx by")[2] == "stopped after 5 s"


def test_readme_is_written_with_all_parts(report: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(f"before\n\n{report.START}\nold\n{report.END}\n\nafter\n")
    monkeypatch.setattr(report, "README", readme)
    monkeypatch.setattr(report.history, "HISTORY", tmp_path / "history.csv")
    figures = made_up(report)
    for name, part in report.PARTS.items():
        monkeypatch.setattr(part, "measure", lambda name=name: figures[name])
    monkeypatch.setattr("sys.argv", ["report.py", "--readme", "--history"])
    report.main()
    text = report.table(figures)
    assert readme.read_text() == f"before\n\n{report.START}\n{text}\n{report.END}\n\nafter\n"
    assert text in capsys.readouterr().out
    written = pd.read_csv(tmp_path / "history.csv", dtype=str).set_index("figure")["value"]
    assert written["peers.43245_getfem"] == "not installed"
    assert written["peers.43245_felupe_version"] == "11.3.0"
    assert written["scale.0.4.unknowns"] == "381170"


def test_marks_of_the_readme_are_those_of_the_report(report: ModuleType) -> None:
    text = report.README.read_text(encoding="utf-8")
    assert text.count(report.START) == text.count(report.END) == 1
    page = (report.README.parent / "docs" / "verification" / "speed.md").read_text(encoding="utf-8")
    assert report.START in page
    assert report.END in page


def test_kept_figures_are_taken_on_the_same_machine_and_package_only(report: ModuleType, monkeypatch, tmp_path: Path) -> None:
    calls: list[str] = []
    monkeypatch.setattr(report.grasp, "measure", lambda: calls.append("grasp") or {"seconds": 1.0})
    kept = tmp_path / "kept.json"
    first = report.measure(["grasp"], kept)
    assert report.measure(["grasp"], kept) == first
    assert calls == ["grasp"]
    monkeypatch.setattr(report.history, "package", lambda: "another")
    with pytest.raises(SystemExit, match="was measured on"):
        report.measure(["grasp"], kept)


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
