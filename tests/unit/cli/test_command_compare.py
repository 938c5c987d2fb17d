"""``tactsim compare`` and ``tactsim run`` of several cases."""

from __future__ import annotations

import csv
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import grasp_scene

from tactsim.cli import main
from tactsim.cli.command_compare import _name_of, _unit_of, report
from tactsim.cli.figures import comparison
from tactsim.cli.figures.comparison import FEW_STEPS, comparison_figure
from tactsim.errors import InputError
from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.materials.library import LIBRARY
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.comparison import compared
from tactsim.results.writing import write_files

CASE = """\
schema: tactsim/case/1
experiment:
  kind: closed_form
  material: atrial
  outer_radius: {radius}
  points: 5
  loading: {{control: force, pieces: [{{kind: jump, to: 0.1 N, duration: 1 s}}]}}
"""

UNDRAWN = ("--figures", "none")


@pytest.fixture
def cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    monkeypatch.chdir(tmp_path)
    for name, radius in (("small", "3 mm"), ("large", "4 mm")):
        (tmp_path / f"{name}.yaml").write_text(CASE.format(radius=radius))
    return ["small.yaml", "large.yaml"]


def test_several_cases_become_one_table_and_one_figure(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *cases, "--out", "designs"]) == 0
    shown = capsys.readouterr().out
    assert "comparison designs/comparison" in shown
    rows = list(csv.DictReader(Path("designs/comparison/comparison.csv").read_text().splitlines()))
    assert [row["result"] for row in rows] == ["small", "large"]
    depth = [float(row["displacement [mm]"]) for row in rows]
    assert depth[0] == pytest.approx(4 / 3 * depth[1], rel=0.2)
    assert Path("designs/comparison/comparison.png").read_bytes().startswith(b"\x89PNG")
    table = Path("designs/comparison/comparison.md").read_text()
    assert table.startswith("| | small | large |")
    assert "| outer_radius [mm] | 3 | 4 |" in table
    assert [row["outer_radius [mm]"] for row in rows] == ["3", "4"]


def test_the_figure_of_a_comparison_has_the_form_that_is_asked_for(cases: list[str]) -> None:
    """For a paper: it was a PNG, whatever the form of the other figures."""
    assert main(["run", *cases, "--out", "designs", "--figures", "svg", "--quiet"]) == 0
    assert b"<svg" in Path("designs/comparison/comparison.svg").read_bytes()
    assert main(["compare", "designs", "--out", "again", "--figures", "pdf"]) == 0
    assert Path("again/comparison.pdf").read_bytes().startswith(b"%PDF")
    assert main(["compare", "designs", "--out", "again", "--figures", "none"]) == 0
    assert sorted(path.name for path in Path("again").glob("comparison.*")) == ["comparison.csv", "comparison.md"]


def test_a_warning_of_several_cases_is_said_in_the_report_of_its_own_alone(
    cases: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", *cases, *UNDRAWN]) == 0
    lines = capsys.readouterr().out.splitlines()
    warnings = [line.strip() for line in lines if "warning: " in line]
    assert len(warnings) == len(cases)
    assert not any(line.startswith("warning: ") for line in lines), "none is repeated below the table"
    assert any(line.split() == ["warnings", "1", "1"] for line in lines)


def test_several_cases_are_run_again_and_again_in_the_default_folder(cases: list[str]) -> None:
    for force, figures in (("0.1 N", ()), ("0.2 N", UNDRAWN), ("0.3 N", UNDRAWN)):
        assert main(["run", *cases, "--quiet", *figures, "--set", f"experiment.loading.pieces.0.to={force}"]) == 0
        assert sorted(os.listdir("results")) == ["comparison", "large", "small"]
        assert f"largest_force [mN] | {1e3 * float(force[:3]):g} |" in Path("results/comparison/comparison.md").read_text()
        assert main(["compare", "results", "--out", "table", *figures]) == 0
    assert sorted(os.listdir(".")) == ["large.yaml", "results", "small.yaml", "table"]


def test_a_named_folder_of_several_cases_needs_force_as_that_of_one_does(
    cases: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    silent = ("--quiet", *UNDRAWN)
    assert main(["run", *cases, "--out", "mine", *silent]) == 0
    with monkeypatch.context() as patch:
        patch.setattr(ClosedForm, "begin", lambda self: pytest.fail("computed before the folders were checked"))
        assert main(["run", *cases, "--out", "mine", *silent]) == 5
        told = capsys.readouterr().err
        assert "the output folders mine/small, mine/large and mine/comparison exist; use --force" in told
        (Path("mine/large") / "notes.txt").write_text("mine")
        assert main(["run", *cases, "--out", "mine", *silent]) == 5
        told = capsys.readouterr().err
        assert "mine/large holds 'notes.txt'" in told
        assert "mine/small and mine/comparison exist" in told
    (Path("mine/large") / "notes.txt").unlink()
    for _ in range(3):
        assert main(["run", *cases, "--out", "mine", *silent, "--force"]) == 0
    assert sorted(os.listdir("mine")) == ["comparison", "large", "small"]


def test_no_comparison_replaces_a_result(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *cases, "--quiet", *UNDRAWN]) == 0
    assert main(["compare", "results", "--out", "results/small"]) == 5
    assert "results/small holds a result" in capsys.readouterr().err
    write_files({"validation.json": b"{}"}, "report")
    assert main(["compare", "results", "--out", "report"]) == 5
    assert "report holds something else than a comparison" in capsys.readouterr().err
    Path("comparison.yaml").write_text(Path(cases[0]).read_text())
    assert main(["run", *cases, "comparison.yaml", "--quiet", *UNDRAWN]) == 2
    assert main(["run", "comparison.yaml", "--quiet", *UNDRAWN]) == 0
    assert main(["run", *cases, "--quiet", *UNDRAWN]) == 5
    assert Path("results/comparison/result.json").is_file()


def test_stored_results_are_compared_by_what_differs(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *cases, "--out", "designs", "--quiet", *UNDRAWN]) == 0
    assert capsys.readouterr().out == ""
    assert Path("designs/comparison/comparison.csv").is_file(), "quiet are words alone, not files"
    assert main(["compare", "designs"]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[0].split() == ["large", "small"]
    assert shown[2].split() == ["warnings", "1", "1"]
    assert shown[3].split() == ["outer_radius", "[mm]", "4", "3"], "what differs between the cases stands first"
    assert not any(line.startswith("points") for line in shown)
    assert not any(line.startswith("largest_force ") for line in shown), "the force is that of both"
    assert main(["compare", "designs/small", "designs/large", "--all", "--out", "table", *UNDRAWN]) == 0
    assert "largest_force" in capsys.readouterr().out
    assert Path("table/comparison.csv").is_file()


def test_what_cannot_be_compared_is_said(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", cases[0], "--quiet", *UNDRAWN]) == 0
    assert main(["compare", "results/small"]) == 2
    assert "nothing to be compared with" in capsys.readouterr().err
    assert main(["compare", "results/small", "nowhere"]) == 5
    assert main(["run", cases[0], f"./{cases[0]}"]) == 2


def test_a_wrong_case_is_refused_before_another_is_computed(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path("wrong.yaml").write_text(CASE.format(radius="3"))
    assert main(["run", cases[0], "wrong.yaml", "--out", "designs"]) == 2
    assert "wrong.yaml:5: experiment.outer_radius" in capsys.readouterr().err
    assert main(["run", cases[0], "absent.yaml", "--out", "designs"]) in (2, 5)
    assert not Path("designs").exists()
    Path("designs/comparison").mkdir(parents=True)
    Path("designs/comparison/mine.txt").write_text("mine")
    assert main(["run", *cases, "--out", "designs"]) == 5
    assert [path.name for path in Path("designs").iterdir()] == ["comparison"]


def test_a_case_may_read_what_one_before_it_writes(cases: list[str]) -> None:
    Path("read.yaml").write_text("schema: tactsim/case/1\nexperiment: {kind: matrix_readout, grasp: designs/pressed}\n")
    assert main(["run", cases[0], "read.yaml", "--out", "designs", *UNDRAWN]) == 5, "the grasp is looked for when its turn comes"
    assert Path("designs/small/result.json").is_file()


def pressed(tissue: str, threshold: float | None, **mesh: float) -> Result:
    """A made-up indentation of a shipped tissue."""
    steps = tuple(StepRecord(k, 1, 0.0, {"displacement": 1e-3 * k, "reaction_force": 0.1 * k**2}) for k in range(4))
    quantities = {f"threshold_{name}": Quantity(threshold, "", "") for name in ("displacement", "force") if threshold}
    case = {"experiment": {"kind": "made_up", "tissue": LIBRARY[tissue].material.model_dump(mode="json"), "mesh": mesh}}
    units = {"displacement": "m", "reaction_force": "N"}
    return Result("made_up", Status.CONVERGED, "", quantities, steps=steps, units=units, provenance={"case": case})


def test_tissues_are_compared_by_their_names_too(capsys: pytest.CaptureFixture[str]) -> None:
    report({"soft": pressed("icf_stable", None), "firm": pressed("b1a_stable", None)}, None)
    shown = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["tissue", "icf_stable", "b1a_stable"] in shown
    assert any(line[0].startswith("tissue.c10") for line in shown)


def test_curves_are_told_apart_without_colour_and_the_title_says_what_differs() -> None:
    results = {f"run{number}": pressed("icf_stable", 2e-3 if number < 2 else None, size=1e-3 * number) for number in range(12)}
    results["firm"] = pressed("b1a_stable", None)
    figure = comparison_figure(results, compared(results, lambda experiment, path: "", _name_of))
    lines = figure.axes[0].lines
    drawn = [(line.get_linestyle(), line.get_marker()) for line in lines]
    assert len(set(drawn)) == len(drawn) == len(results) + 1
    assert lines[-1].get_label() == "threshold"
    assert len(lines[-1].get_xdata()) == 2
    assert figure.get_suptitle() == "13 results that differ in tissue, mesh.size"


def test_a_curve_that_ends_on_another_one_lies_above_it_and_no_mark_is_hidden() -> None:
    """Of five recesses the first and the fifth differ by the mark at the end alone, which lay below the star of the threshold."""
    results = {f"run{number}": pressed("icf_stable", 3e-3, size=1e-3 * number) for number in range(5)}
    results["run0"] = replace(results["run0"], steps=results["run0"].steps[:3])
    figure = comparison_figure(results, compared(results, lambda experiment, path: "", _name_of))
    *curves, stars = figure.axes[0].lines
    assert all(curves[0].get_zorder() > longer.get_zorder() for longer in curves[1:])
    assert all(stars.get_zorder() > curve.get_zorder() for curve in curves)
    assert stars.get_markerfacecolor() == "none"


def grasped(steps: int, forces: list[list[float]], *warnings: str, solver: float = 1.0) -> Result:
    """A made-up grasp whose jaws read the same."""
    quantities = {
        "reaction_force": Quantity(3.0, "N", ""),
        "gap_force_upper": Quantity(0.1, "N", ""),
        "max_penetration": Quantity(1e-6 * solver, "m", ""),
        "mirror_asymmetry": Quantity(1e-15 * solver, "1", ""),
        "base_force": Quantity(2e-17 * solver, "N", ""),
        "unknowns": Quantity(int(100 * solver), "1", ""),
    }
    for side in JAWS:
        quantities[f"taxel_force_{side}"] = Quantity(forces, "N", "force on each taxel; [row][column]")
    times = [(k + 1) / steps for k in range(steps)]
    quantities["time_history"] = Quantity(times, "s", "time [time]")
    quantities["force_history"] = Quantity([3.0 * time for time in times], "N", "force [time]")
    records = tuple(
        StepRecord(k, 1, 0.0, {"displacement": 1e-3 * time, "reaction_force": 3 * time}) for k, time in enumerate(times)
    )
    units = {"displacement": "m", "reaction_force": "N"}
    return Result("made_up", Status.CONVERGED, "", quantities, warnings=warnings, steps=records, units=units)


def heads_and_texts(results: dict[str, Result]) -> tuple[list[str], list[str]]:
    """Labels of the axes of the figure, and what is written in them."""
    figure = comparison_figure(results, compared(results, lambda experiment, path: ""))
    heads = [text for axis in figure.axes for text in (axis.get_xlabel(), axis.get_ylabel(), axis.get_title()) if text]
    return heads, [text.get_text() for axis in figure.axes for text in axis.texts]


def test_two_grasps_show_their_forces_and_not_their_solver() -> None:
    """Bars of what tells of the solver were all that was shown if one of two grasps had a single step."""
    first = [[0.3, 0.2], [0.2, 0.1]]
    results = {"one": grasped(1, first), "other": grasped(3, [[0.35, 0.2], [0.2, 0.1 + 1e-16]], solver=9.0)}
    heads, texts = heads_and_texts(results)
    assert heads[:2] == ["displacement in mm", "reaction force in N"]
    assert {"one", "other", "second less first", "upper jaw", "lower jaw", "difference in mN"} <= set(heads)
    assert texts.count("350") == 2
    assert texts.count("+50") == 2
    assert texts.count("0") == 6, "round-off is no difference"
    heads, texts = heads_and_texts({"one": grasped(1, first), "other": grasped(1, first, solver=9.0)})
    assert heads[0] == "reaction_force [N]"
    assert not any(name in head for head in heads for name in ("max_penetration", "unknowns", "mirror_asymmetry", "base_force"))
    heads, _ = heads_and_texts({name: grasped(1, first) for name in "abcdef"})
    assert heads == ["reaction_force [N]", "largest taxel_force_upper [mN]", "largest taxel_force_lower [mN]"]
    heads, _ = heads_and_texts({"a": grasped(1, first), "b": grasped(1, [[0.1]])})
    assert "second less first" not in heads, "of other matrices no difference is told"
    heads, _ = heads_and_texts({name: grasped(2, [[force]]) for name, force in (("a", 1.0), ("b", 2.0), ("c", 2.5))})
    assert "upper jaw,\nless the first" in heads


def test_taxels_of_other_sizes_are_compared_by_their_pressure() -> None:
    """Forces of 16 x 16 taxels were all dark beside those of 3 x 3."""
    layouts = {"large": TaxelLayout(), "small": TaxelLayout(rows=6, columns=6, pitch=5e-3, size=4.5e-3)}
    results = {}
    for name, layout in layouts.items():
        one = grasped(2, np.full((layout.rows, layout.columns), 5e3 * layout.area).tolist())
        pressures = Quantity(np.full((layout.rows, layout.columns), 5e3).tolist(), "Pa", "")
        quantities = one.quantities | {f"taxel_pressure_{side}": pressures for side in JAWS}
        results[name] = replace(one, quantities=quantities, scene=grasp_scene((40e-3, 40e-3, 20e-3), layout))
    heads, texts = heads_and_texts(results)
    assert "mean pressure on the taxel in kPa; row 1 at the front" in heads
    assert texts.count("5") == 2 * (9 + 36)
    alike, _ = heads_and_texts({"one": results["large"], "other": results["large"]})
    assert "force on the taxel in mN; row 1 at the front" in alike


def test_arrays_are_compared_by_their_largest_and_round_off_is_no_difference() -> None:
    results = {
        "one": grasped(2, [[0.3, -0.4]]),
        "other": grasped(2, [[0.35, -0.4 - 1e-16]], solver=1.2),
        "third": grasped(3, [[0.3]]),
    }
    comparison = compared(results, lambda experiment, path: "")
    columns = {column.name: column for column in comparison.columns}
    assert columns["largest taxel_force_upper"].values == pytest.approx((400, 400, 300))
    assert columns["largest difference of taxel_force_upper"].values == (None, pytest.approx(50), None)
    assert columns["largest difference of force_history"].values == (None, 0.0, None), (
        "other times are not held against each other"
    )
    differing = {column.name for column in comparison.differing}
    assert {"max_penetration", "unknowns", "largest difference of taxel_force_upper"} <= differing
    assert not {"base_force", "mirror_asymmetry", "largest difference of force_history"} & differing
    assert "largest difference of taxel_force_upper [mN] |  | 50 |  |" in comparison.markdown_text()
    assert "The largest difference of an array is that from one" in comparison.markdown_text()


def test_a_number_beside_none_is_a_difference() -> None:
    """A taxel that one result has and another has not went unseen, as the largest difference leaves such places out."""
    results = {
        "one": grasped(1, [[0.3, 0.4, 0.1]]),
        "dead": grasped(1, [[0.3, None, 0.1]]),
        "same": grasped(1, [[0.3, 0.4, 0.1]]),
    }
    comparison = compared(results, lambda experiment, path: "")
    alone = next(column for column in comparison.differing if column.name == "numbers on one side of taxel_force_upper")
    assert alone.values == (None, 1.0, 0.0)
    alike = compared({"one": results["dead"], "other": results["dead"]}, lambda experiment, path: "")
    assert not alike.differing, "None on both sides is the same"


def test_every_warning_is_told_once_with_the_results_that_have_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    results = {
        "one": grasped(1, [[1.0]], "too coarse"),
        "other": grasped(1, [[1.0]], "too coarse", "an\nedge"),
        "good": grasped(1, [[1.0]]),
    }
    report(results, tmp_path / "out")
    shown = capsys.readouterr().out.splitlines()
    assert [line for line in shown if line.startswith("warning: ")] == [
        "warning: one, other: too coarse",
        "warning: other: an\\nedge",
    ]
    assert ["warnings", "1", "2", "0"] in [line.split() for line in shown]
    table = (tmp_path / "out" / "comparison.md").read_text()
    assert "| warnings | 1 | 2 | 0 |" in table
    assert table.endswith("\nWarnings:\n\n- one, other: too coarse\n- other: an\\nedge\n")
    rows = list(csv.DictReader((tmp_path / "out" / "comparison.csv").read_text().splitlines()))
    assert [row["warnings"] for row in rows] == ["1", "2", "0"]


def test_a_changed_file_of_a_result_is_a_warning_of_the_comparison(cases: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *cases, "--quiet", *UNDRAWN]) == 0
    place = Path("results/small/result.json")
    place.write_text(place.read_text() + " ")
    assert main(["compare", "results", "--out", "table", *UNDRAWN]) == 0
    line = "small: result.json was changed since tactsim wrote it"
    assert f"warning: {line}" in capsys.readouterr().out
    assert f"- {line}" in Path("table/comparison.md").read_text()


def test_numbers_of_other_kinds_leave_gaps() -> None:
    def result(**values: float) -> Result:
        quantities = {name: Quantity(value, "Pa", name) for name, value in values.items()}
        return Result(kind="pretence", status=Status.CONVERGED, reason="", quantities=quantities)

    comparison = compared({"a": result(one=2e3, both=1.0), "b": result(two=5.0, both=1 + 1e-9)}, lambda experiment, path: "")
    assert {column.head: column.values for column in comparison.columns} == {
        "one [kPa]": (2.0, None),
        "both [Pa]": (1.0, 1 + 1e-9),
        "two [Pa]": (None, 5.0),
    }
    assert [column.name for column in comparison.differing] == ["one", "two"], "what five digits do not tell apart is the same"
    assert "| one [kPa] | 2 |  |" in comparison.markdown_text()
    assert InputError.exit_code == 2


def test_a_key_that_has_another_unit_in_another_kind_has_a_row_for_each() -> None:
    def result(kind: str, to: float) -> Result:
        case = {"experiment": {"kind": kind, "to": to}}
        return Result(kind=kind, status=Status.CONVERGED, reason="", provenance={"case": case})

    units = {"pulled": "N", "moved": "m"}
    results = {"one": result("pulled", 0.2), "other": result("moved", 1e-3), "third": result("moved", 2e-3)}
    comparison = compared(results, lambda experiment, path: units[experiment["kind"]] if path == ("to",) else "")
    loading = {"pieces": [{"kind": "ramp", "to": 1e-3, "duration": 1.0}], "control": "displacement"}
    assert _unit_of({"kind": "grasp", "loading": loading}, ("loading", "pieces", 0, "to")) == "m"
    assert _unit_of({"kind": "grasp", "loading": loading | {"control": "force"}}, ("loading", "pieces", 0, "to")) == "N"
    assert comparison.inputs == {
        "kind": ("pulled", "moved", "moved"),
        "to [mN]": ("200", "", ""),
        "to [mm]": ("", "1", "2"),
    }


def test_a_key_with_the_name_of_a_quantity_has_another_head() -> None:
    """Two rows were called ``displacement [mm]``: how far the body was to go, and how far it went."""
    results = {}
    for name, asked, reached in (("a", 8e-3, 2e-3), ("b", 4e-3, 1e-3)):
        case = {"experiment": {"kind": "indentation", "displacement": asked, "recess": asked}}
        went = {"displacement": Quantity(reached, "m", "displacement of the body")}
        results[name] = Result("indentation", Status.CONVERGED, "", quantities=went, provenance={"case": case})
    comparison = compared(results, lambda experiment, path: "m")
    assert comparison.inputs == {"experiment.displacement [mm]": ("8", "4"), "recess [mm]": ("8", "4")}
    assert [column.head for column in comparison.columns] == ["displacement [mm]"]
    assert comparison_figure(results, comparison).get_suptitle() == "2 results that differ in displacement, recess"


def test_each_of_a_few_steps_is_marked() -> None:
    """Two grasps of two steps were two straight lines, as if the force grew in proportion."""
    results = {f"run{number}": pressed("icf_stable", None, size=1e-3 * number) for number in range(2)}
    few = {name: replace(result, steps=result.steps[:2]) for name, result in results.items()}
    for shown, marked in ((few, None), (results, None if len(results["run0"].steps) <= FEW_STEPS else [-1])):
        lines = comparison_figure(shown, compared(shown, lambda experiment, path: "", _name_of)).axes[0].lines
        assert [line.get_markevery() for line in lines[:2]] == [marked] * 2
        assert all(line.get_marker() for line in lines[:2]) == (marked is None)


def test_no_figure_is_written_of_results_that_share_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Six bars of one result were all that a comparison of an indentation with a film showed."""
    made = {name: replace(grasped(1, [[0.1]]), units={}, quantities={name: Quantity(2.0, "N", "")}) for name in ("one", "two")}
    report(made, tmp_path / "out")
    assert not (tmp_path / "out" / "comparison.png").exists()
    assert (tmp_path / "out" / "comparison.csv").exists()
    assert "no figure, for no two of the results share a number" in capsys.readouterr().out


def test_the_maps_of_the_taxels_are_collected_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They were for whether there is a figure, and for the figure."""
    counted: list[int] = []
    collected = comparison.taxel_maps
    monkeypatch.setattr(comparison, "taxel_maps", lambda results: counted.append(len(results)) or collected(results))
    report({name: grasped(1, [[force]]) for name, force in (("one", 0.1), ("two", 0.2))}, tmp_path / "out")
    assert (tmp_path / "out" / "comparison.png").exists()
    assert counted == [2]
