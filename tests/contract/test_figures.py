"""Every kind of experiment with figures: names of files, nothing drawn of a result without data, and a mark if a run failed."""

from __future__ import annotations

import ast
from pathlib import Path, PurePath

import pytest

import tactsim
from tactsim.errors import TactsimError
from tactsim.interfaces import Experiment, ResultFigures
from tactsim.plotting import figures_for
from tactsim.registry import kinds
from tactsim.results.result import Result, Status

FIGURES = kinds(ResultFigures)
WITHOUT_RESULT = {"confusion.py": {"titled_figure"}}
"""The table of ``tactsim data confusion`` is that of a store."""


@pytest.mark.parametrize("kind", sorted(FIGURES))
def test_figures_belong_to_an_experiment_and_are_listed_without_drawing(kind: str) -> None:
    assert kind in kinds(Experiment)
    empty = Result(kind=kind, status=Status.FAILED, reason="nothing was accepted")
    try:
        drawings = figures_for(empty)
    except (TactsimError, KeyError) as error:
        pytest.fail(f"the figures of {kind} need data that a failed result lacks: {error!r}")
    assert all(PurePath(name).name == name and name.endswith(".png") for name in drawings)


@pytest.mark.parametrize("kind", sorted(FIGURES))
def test_no_figure_of_a_result_is_made_without_its_mark(kind: str) -> None:
    """`result_figure` alone makes them; test_experiments.py and the tests of the longer kinds ask their figures for the mark."""
    module = Path(tactsim.__file__).parents[1] / FIGURES[kind].__module__.replace(".", "/")
    files = [module.with_suffix(".py")] if module.name == "figures" else sorted(module.parent.glob("*.py"))
    makers = {"Figure", "FigureCanvasAgg", "new_figure", "styled", "titled_figure"}
    for path in files:
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        called = {getattr(node.func, "id", getattr(node.func, "attr", "")) for node in nodes if isinstance(node, ast.Call)}
        assert called & makers <= WITHOUT_RESULT.get(path.name, set()), path.name


def test_a_kind_without_figures_has_none() -> None:
    assert figures_for(Result(kind="unheard_of", status=Status.CONVERGED, reason="")) == {}
