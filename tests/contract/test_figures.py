"""Every kind of experiment with figures: names of files, and nothing drawn of a result that has no data."""

from __future__ import annotations

from pathlib import PurePath

import pytest

from tactsim.errors import TactsimError
from tactsim.interfaces import Experiment, ResultFigures
from tactsim.plotting import figures_for
from tactsim.registry import kinds
from tactsim.results.result import Result, Status

FIGURES = kinds(ResultFigures)


@pytest.mark.parametrize("kind", sorted(FIGURES))
def test_figures_belong_to_an_experiment_and_are_listed_without_drawing(kind: str) -> None:
    assert kind in kinds(Experiment)
    empty = Result(kind=kind, status=Status.FAILED, reason="nothing was accepted")
    try:
        drawings = figures_for(empty)
    except (TactsimError, KeyError) as error:
        pytest.fail(f"the figures of {kind} need data that a failed result lacks: {error!r}")
    assert all(PurePath(name).name == name and name.endswith(".png") for name in drawings)


def test_a_kind_without_figures_has_none() -> None:
    assert figures_for(Result(kind="unheard_of", status=Status.CONVERGED, reason="")) == {}
