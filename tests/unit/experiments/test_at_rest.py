"""What a case would compute, before anything is solved: its mesh, its bodies and a sketch of them."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from tactsim.case.loading import load_case
from tactsim.case.model import Case
from tactsim.errors import InputError
from tactsim.fem.equilibrium.newton import Problem
from tactsim.interfaces import Experiment
from tactsim.mechanics.models.specimen import Layer
from tactsim.registry import kind_class
from tactsim.results.result import Status


def at_rest(kind: str) -> Case:
    """The example of a kind as a case."""
    return Case(schema="tactsim/case/1", title="A design", experiment=kind_class(Experiment, kind).example())


@pytest.mark.parametrize("kind", ["indentation", "indentation_3d", "timed_indentation", "grasp", "boundary_value_problem"])
def test_nothing_is_solved_and_the_sketch_is_the_only_figure(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Problem, "solve", lambda *_, **__: pytest.fail("solved"))
    result = at_rest(kind).at_rest()
    assert result.at_rest
    assert result.status is Status.INTERRUPTED
    assert not result.quantities
    assert result.title == "A design"
    assert result.provenance
    assert len(result.frames) == 1
    assert not result.frames[0].point_data["displacement [m]"].any()
    figures = result.plot()
    assert list(figures) == ["sketch"]
    figure = figures["sketch"]
    words = [text.get_text() for axis in figure.axes for text in (axis.title, axis._left_title)]
    assert any("elements" in title for title in words)
    assert any("at rest" in title for title in words)
    assert not any("INTERRUPTED" in text.get_text() for text in figure.texts)
    assert figure._supxlabel is None
    assert any(isinstance(drawn, LineCollection) for axis in figure.axes for drawn in axis.collections)


def test_layers_are_named_from_the_top() -> None:
    case = at_rest("indentation")
    layer = Layer(thickness=0.5e-3, material="lump")
    specimen = case.experiment.specimen.model_copy(update={"layers": (layer,)})
    layered = case.experiment.model_copy(update={"specimen": specimen})
    (legend,) = (axis.get_legend() for axis in layered.at_rest().plot("sketch").axes)
    assert [text.get_text() for text in legend.get_texts()] == ["layer 1", "tissue below"]


def test_doubts_are_told() -> None:
    case = at_rest("grasp")
    block = case.experiment.block.model_copy(update={"tissue": {"kind": "neo_hookean", "c10": 1e-3}})
    soft = case.experiment.model_copy(update={"block": block})
    assert soft.doubts()
    assert set(soft.doubts()) <= set(soft.at_rest().warnings)


def test_what_acts_on_a_body_stands_in_its_sketch() -> None:
    case = load_case("published_plate_on_plane")
    figure = case.at_rest().plot("sketch")
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "right: displacement x = 0 m",
        "point (40 mm, 0 m): displacement x = 0 m, y = 0 m",
        "top: pressure 50 MPa",
        "left: pressure 150 MPa",
        "rigid body 1: plane",
    ]
    marked = [one for one in figure.axes[0].collections if isinstance(one, LineCollection)]
    ends = [np.concatenate([path.vertices for path in one.get_paths()]) for one in marked]
    assert [set(np.round(places[:, axis], 9)) for places, axis in zip(ends, (0, 1, 0), strict=True)] == [{40.0}, {40.0}, {0.0}]
    figure.canvas.draw()
    title = figure._suptitle.get_window_extent()
    assert not title.overlaps(legend.get_window_extent())
    turned = load_case("published_torsion").at_rest().plot("sketch")
    assert [text.get_text() for text in turned.legends[0].get_texts()] == ["bottom: rotation 0°", "top: rotation 45°"]


def test_a_kind_without_a_mesh_has_nothing_to_show() -> None:
    with pytest.raises(InputError, match="film_test: nothing to show at rest"):
        kind_class(Experiment, "film_test").example().at_rest()
