"""``tactsim show``."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import pytest
from pretence import PNG, pretended_result

from tactsim import plotting
from tactsim.cli import main
from tactsim.cli.command_show import NOISE_WORDS
from tactsim.interfaces.readings import RESOLUTION, ROUNDING_NOISE
from tactsim.live.sources.noise import MESH_SHARE
from tactsim.results import Status, StepRecord, write_result
from tactsim.shipped import CASES


@pytest.fixture
def folder(tmp_path: Path, pretended: None) -> Path:
    result = pretended_result(Status.CONVERGED, "done", (StepRecord(1, 4, 1e-11, {"displacement": 1e-4}),))
    return write_result(result, tmp_path / "out", case_id="abc", provenance={"case": {"title": "A case"}})


def test_quantities_are_printed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(folder)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("A case\nconverged: done\n")
    assert "threshold_pressure  17.2 kPa" in out
    assert out.endswith("case abc\n")
    assert main(["show", str(folder / "result.json")]) == 0
    assert capsys.readouterr().out == out


def test_the_main_figure_is_saved(folder: Path, tmp_path: Path) -> None:
    assert main(["show", str(folder), "--save", str(tmp_path / "a.png")]) == 0
    assert (tmp_path / "a.png").read_bytes() == PNG


def test_the_ending_says_the_form_and_only_the_main_figure_is_drawn(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    figures = {"main.png": lambda form: form.encode(), "other.png": lambda form: pytest.fail("drawn in vain")}
    monkeypatch.setattr(plotting, "figures_for", lambda result: figures)
    for form in ("svg", "pdf"):
        assert main(["show", str(folder), "--save", str(tmp_path / f"a.{form}")]) == 0
        assert (tmp_path / f"a.{form}").read_bytes() == form.encode()
    assert main(["show", str(folder), "--save", str(tmp_path / "a.jpg")]) == 2
    assert "a figure is saved as .png, .svg, .pdf" in capsys.readouterr().err


def test_a_result_without_figure_is_reported(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(plotting, "figures_for", lambda result: {})
    assert main(["show", str(folder), "--save", str(tmp_path / "a.png")]) == 2
    assert "a result of kind 'pretence' has no figure" in capsys.readouterr().err


def test_what_is_no_result_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(tmp_path)]) == 5
    assert "holds no result.json" in capsys.readouterr().err
    assert main(["show", str(tmp_path / "missing")]) == 5


def test_a_case_is_shown_before_it_is_computed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "annulus_icf"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("Annular hardness sensor on ICF, stable constants\n  indentation, at rest; nothing is computed\n")
    assert "specimen of radius 15 mm" in out
    assert "--save sketch.png" in out
    assert main(["new", "grasp", str(tmp_path / "mine.yaml")]) == 0
    assert main(["show", str(tmp_path / "mine.yaml"), "--save", str(tmp_path / "sketch.svg")]) == 0
    drawn = (tmp_path / "sketch.svg").read_text(encoding="utf-8")
    assert "at rest" in drawn
    assert "from above" in drawn
    assert main(["show", "annulus_icf", "--save", str(tmp_path / "sketch.bmp")]) == 2
    assert main(["show", "film_lingstat"]) == 2
    assert "film_test: nothing to show at rest" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["indentation", "indentation_3d", "timed_indentation", "grasp", "boundary_value_problem"])
def test_every_case_that_is_shown_says_how_large_its_mesh_is(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", kind, str(tmp_path / "case.yaml")]) == 0
    assert main(["show", str(tmp_path / "case.yaml")]) == 0
    assert re.search(r"\n  mesh of \d+ elements, \d+ unknowns\n", capsys.readouterr().out)


def test_a_sweep_is_shown_before_it_is_computed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "sweep_annulus", "--save", str(tmp_path / "first.svg")]) == 0
    out = capsys.readouterr().out
    assert "a sweep of indentation: 500 samples, design sobol; nothing is computed" in out
    assert "  specimen.material.c10  log-uniform 1 kPa, 10 kPa\n" in out
    assert "  specimen.thickness     choice 5 mm, 10 mm, 15 mm\n" in out
    assert out.endswith("compute it with: tactsim sweep sweep_annulus --out sweep_annulus.zarr\n")
    assert "\n  labels: " in out
    assert "threshold_pressure" in next(line for line in out.splitlines() if line.startswith("  readings: "))
    assert (tmp_path / "first.svg").is_file()
    assert main(["show", "sweep_arteries"]) == 0
    assert "choice a list of 1, a list of 2, a list of 1, a list of 2, an empty list; weights" in capsys.readouterr().out


def test_a_sweep_that_would_be_refused_is_not_shown_as_sound(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A label that there is not was met only by the sweep itself."""
    text = (CASES / "sweep_annulus.yaml").read_text(encoding="utf-8")
    (tmp_path / "s.yaml").write_text(text.replace("thin: {thickness:", "thin: {thicknes:"), encoding="utf-8")
    assert main(["show", str(tmp_path / "s.yaml")]) == 2
    assert "sweep.splits.out_of_distribution.thin.thicknes: unknown label (did you mean 'thickness'?)" in capsys.readouterr().err


def test_a_case_is_shown_with_a_key_changed(capsys: pytest.CaptureFixture[str]) -> None:
    change = "experiment.specimen.thickness=7 mm"
    assert main(["show", "sweep_annulus", "--set", change]) == 0
    out = capsys.readouterr().out
    assert "specimen.thickness" not in out.split("labels:")[0]
    assert out.endswith("tactsim sweep sweep_annulus --set 'experiment.specimen.thickness=7 mm' --out sweep_annulus.zarr\n")
    assert main(["show", "annulus_icf", "--set", "experiment.specimen.thickness=-7 mm"]) == 2
    assert "--set experiment.specimen.thickness: '-7 mm' is out of range" in capsys.readouterr().err


def test_no_key_of_a_result_is_changed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for other in ([], ["--web"]):
        assert main(["show", str(folder), "--set", "experiment.friction=0.1", *other]) == 2
        assert "--set: of a case or a sweep" in capsys.readouterr().err


def test_a_folder_of_the_name_of_a_case_comes_first(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with contextlib.chdir(folder.parent):
        folder.rename("annulus_icf")
        assert main(["show", "annulus_icf"]) == 0
    assert capsys.readouterr().out.startswith("A case\nconverged: done\n")


def test_the_help_gives_the_noise_that_the_page_takes() -> None:
    """Written out, since the help loads none of what computes it."""
    assert f"{100 * MESH_SHARE:g} %% of the largest force" in " ".join(NOISE_WORDS.split())
    assert f"{1e3 * ROUNDING_NOISE:.3f} mN" in NOISE_WORDS
    assert f"a resolution of {RESOLUTION:g} N" in NOISE_WORDS


def test_a_misspelt_case_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "annulus_ifc"]) == 5
    shown = capsys.readouterr().err
    assert "there is no folder annulus_ifc here" in shown
    assert "did you mean 'annulus_icf'?" in shown
