"""The picture of a boundary value problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from pretence import pretended_result
from skfem import MeshTri
from small_problems import SIDE, SQUARE, asked, result_of

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.experiments.boundary_value.figures.boundary_value_problem import draw_body
from tactsim.experiments.boundary_value.figures.course import draw_course
from tactsim.experiments.boundary_value.scene import BoundaryValueScene
from tactsim.plotting.canvas import new_figure
from tactsim.results import FieldFrame, Status, StepRecord
from tactsim.results.fields import DISPLACEMENT, VON_MISES


def drawn(size: float, reach: float) -> Axes:
    """A square of a width in m whose stress in Pa decays from its upper left corner as under a punch of a radius in m."""
    along = np.append(0.0, np.geomspace(1e-4 * size, size, 30))
    mesh = MeshTri.init_tensor(along, size - along[::-1])
    corners = mesh.p.T[mesh.t.T]  # (triangle, corner, axis)
    nodes = np.concatenate([corners, (corners + np.roll(corners, -1, axis=1)) / 2], axis=1).reshape(-1, 2)
    points, cells = np.column_stack([nodes, np.zeros(len(nodes))]), np.arange(len(nodes)).reshape(-1, 6)
    middles = points[cells[:, :3]].mean(axis=1)
    stress = 1e3 / (1 + (np.hypot(middles[:, 0], size - middles[:, 1]) / reach) ** 2) if reach else np.zeros(len(cells))
    frame = FieldFrame(1.0, points, {"triangle6": cells}, {DISPLACEMENT: np.zeros_like(points)}, {VON_MISES: stress[:, None]})
    axis = new_figure(5, 4).add_subplot()
    draw_body(axis, frame, "axisymmetric")
    return axis


@pytest.mark.parametrize("reach", [0.0, 0.5, 1e9])
def test_a_body_that_is_stressed_in_large_parts_or_nowhere_is_shown_whole(reach: float) -> None:
    axis = drawn(1.0, reach)
    assert axis.get_xlim()[1] >= 1e3
    assert axis.get_title(loc="left") == "deformed, at 1 s"


def test_of_a_body_that_is_stressed_in_a_speck_this_part_is_shown() -> None:
    """A disc of 1 mm on a body of 1 m was one dark square."""
    axis = drawn(1.0, 1e-3)
    (left, right), (bottom, top) = axis.get_xlim(), axis.get_ylim()
    assert (right < 30, bottom > 970, top >= 1e3, left <= 0) == (True,) * 4
    assert axis.get_title(loc="left") == "deformed, at 1 s; the stressed part"
    (picture,) = axis.collections
    low, high = picture.get_clim()
    assert 0 < low < high < 1e3


def test_curves_are_told_apart_without_colour() -> None:
    *_, course = (axis for axis in BoundaryValueProblem.example().run().plot("boundary_value_problem").axes if axis.get_legend())
    curves = course.get_legend().get_lines()
    assert len({(curve.get_linestyle(), curve.get_marker()) for curve in curves}) == len(curves) > 1


def test_the_picture_of_a_speck_ends_where_the_body_does() -> None:
    """Half the picture of a disc on a half-space was empty."""
    axis = drawn(1.0, 1e-3)
    (left, right), (bottom, top) = axis.get_xlim(), axis.get_ylim()
    assert -0.2 * (right - left) < left <= 0
    assert 1e3 <= top < 1e3 + 0.2 * (top - bottom)


@pytest.mark.parametrize(
    ("asked", "label", "largest"),
    [
        ({"force": "N"}, "force in kN", 2.0),
        ({"force": "N", "force_at_end": "N"}, "value in kN", 2.0),
        ({"force": "N", "slip": "m"}, "quantity / its largest magnitude", 1.0),
    ],
)
def test_a_single_course_is_drawn_in_its_unit(asked: dict[str, str], label: str, largest: float) -> None:
    """A force over its own largest magnitude says nothing."""
    values = [{"time": float(k), "force": 1e3 * k, "force_at_end": 1e3 * k, "slip": 2e-6 * k} for k in (1, 2)]
    steps = tuple(StepRecord(k, 1, 0.0, value) for k, value in enumerate(values, 1))
    result = replace(pretended_result(Status.CONVERGED, "done", ()), steps=steps)
    axis = new_figure(5, 4).add_subplot()
    draw_course(axis, result, BoundaryValueScene.model_construct(asked=asked))
    assert axis.get_ylabel() == label
    (curve,) = [line for line in axis.lines if len(line.get_xdata()) == 2 and line.get_marker() == "."]
    assert np.max(curve.get_ydata()) == largest


def test_the_bar_says_where_its_colours_end():
    steep, even = ([one for one in axis.figure.axes if one is not axis] for axis in (drawn(1.0, 0.5), drawn(1.0, 0.0)))
    assert steep[0].get_xlabel().endswith("one value for each element\n(colours: 1st to 99th percentile of what is seen)")
    assert "percentile" not in even[0].get_xlabel()


def test_the_rigid_body_is_drawn_where_it_came_to() -> None:
    """The picture left it out."""
    sides = [{"kind": "displacement", "face": "left", "x": 0.0}, {"kind": "displacement", "face": "bottom", "y": 0.0}]
    plane = {"face": "top", "side": "top", "body": {"kind": "plane"}, "y": -0.1 * SIDE}
    common = {"dimension": "plane_strain", "geometry": SQUARE, "conditions": sides, "steps": 2}
    result = result_of(**common, contacts=[plane], asked=asked("contact_force", component="y"))
    (touching,) = result.scene_as(BoundaryValueScene).touching
    assert (touching.place[1], touching.reached[1]) == pytest.approx((SIDE, 0.9 * SIDE))
    axis = result.plot("boundary_value_problem").axes[0]
    assert axis.get_title(loc="left").endswith("; grey: rigid")
    (filled,) = [one for one in axis.collections if isinstance(one, ContourSet)]
    lowest = min(path.vertices[:, 1].min() for path in filled.get_paths())
    assert lowest == pytest.approx(900.0 * SIDE, abs=10.0 * SIDE), "mm, as fine as its distance is sampled"
    earlier = result.scene_as(BoundaryValueScene).model_copy(update={"touching": [touching.model_copy(update={"reached": None})]})
    assert "rigid" not in replace(result, scene=earlier).plot("boundary_value_problem").axes[0].get_title(loc="left")
