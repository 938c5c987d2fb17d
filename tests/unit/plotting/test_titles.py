"""Titles of users stand in figures letter by letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.cli import main
from tactsim.experiments.localization.scene import ConfusionScene
from tactsim.plotting.canvas import entitle, new_figure, result_figure, with_minus
from tactsim.results.quantity import Quantity
from tactsim.results.result import Result, Status
from tactsim.shipped import CASES


def test_a_title_is_drawn_as_it_is_written_not_as_tex(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = CASES / "annulus_dynamic_load.yaml"
    assert main(["run", str(case), "--out", str(tmp_path / "r"), "--set", r"title=$x_$ \frac{"]) == 0
    assert list((tmp_path / "r" / "figures").glob("*.png"))
    assert "warning" not in capsys.readouterr().err


def test_a_title_of_two_lines_has_two_lines() -> None:
    figure = new_figure(4, 3)
    entitle(figure, "Switch probe", "Force over depth\t")
    assert figure.get_suptitle() == "Switch probe\nForce over depth\\t"


def test_a_title_that_is_wider_than_its_figure_goes_on_in_a_new_line() -> None:
    figure = new_figure(4, 3)
    words = "The strongest place reads more than the reference, which is beyond four deviations"
    entitle(figure, words, "Below")
    figure.canvas.draw()
    text = figure._suptitle
    assert text.get_text().split() == [*words.split(), "Below"]
    assert text.get_text().endswith("\nBelow")
    assert text.get_window_extent().x1 <= figure.bbox.x1


def test_the_table_of_a_confusion_is_a_figure() -> None:
    classes = ("nothing", "lump")
    result = Result(
        kind="confusion",
        status=Status.CONVERGED,
        reason="3 of 4",
        quantities={"confusion": Quantity([[2, 0], [1, 1]], "1", "counts")},
        scene=ConfusionScene(classes=classes, grasps=(), estimator="hypotheses"),
    )
    assert result.plot()["confusion"].get_suptitle() == "Confusion table: 3 of 4"


def test_numbers_in_words_have_a_minus_sign_and_words_keep_their_hyphens() -> None:
    assert with_minus("in this cut -1.01 to 23.2 kPa, B1-A, 1e-3") == "in this cut −1.01 to 23.2 kPa, B1-A, 1e-3"
    assert with_minus("F = 20.94 C - 0.132 (thesis; C in mS) - a line") == "F = 20.94 C − 0.132 (thesis; C in mS) - a line"


def test_the_foot_of_an_interrupted_run_says_so_once() -> None:
    stopped = Result(kind="grasp", status=Status.INTERRUPTED, reason="interrupted; the accepted steps are kept", quantities={})
    with result_figure(stopped, (6.0, 3.0), where=" at 2 s") as figure:
        pass
    assert figure.get_supxlabel() == "INTERRUPTED at 2 s: the accepted steps are kept"
