"""The figures of grasps of unusual shapes: no words on each other or beyond the border, whatever is grasped."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from drawn import colliding_words, text_of
from scenes import Unrendered, grasp_scene

from tactsim.experiments.grasp.figures import view as grasp_view
from tactsim.experiments.grasp.figures.grasp import maps_figure, section_figure
from tactsim.experiments.grasp.figures.maps import MapsLayout
from tactsim.experiments.grasp.figures.view import VIEW
from tactsim.experiments.grasp.scene import SimulatedGrasp
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.structured_block import structured_block
from tactsim.plotting.canvas import LONGEST_TITLE
from tactsim.results import FieldFrame, Quantity, Result, Status, StepRecord

CELLS = (8, 8, 4)
PRESSURE = 3e3
FORCES = {"jaw_force_upper_z": 3.0, "jaw_force_lower_z": -3.0}


@dataclass(frozen=True)
class Shape:
    """Sides of a block and place and radius of a lump in it, in mm, and the taxels."""

    block: tuple[float, float, float]
    layout: TaxelLayout
    lump: tuple[float, float, float]
    radius: float


SHAPES = {
    "usual": Shape((40, 40, 20), TaxelLayout(), (20, 20, 12), 5.0),
    "wide and thin": Shape((120, 120, 6), TaxelLayout(), (60, 60, 3), 1.5),
    "wide": Shape((60, 40, 20), TaxelLayout(rows=3, columns=5), (10, 10, 12), 4.0),
    "deep": Shape((15, 60, 15), TaxelLayout(rows=6, columns=1, pitch=9e-3, size=8e-3), (7.5, 40, 9), 3.0),
    "tall": Shape((20, 20, 60), TaxelLayout(rows=2, columns=2, pitch=9e-3, size=8e-3), (10, 10, 45), 4.0),
    "one row": Shape((60, 15, 15), TaxelLayout(rows=1, columns=6, pitch=9e-3, size=8e-3), (40, 7.5, 9), 3.0),
    "many taxels": Shape((40, 40, 20), TaxelLayout(rows=16, columns=16, pitch=2.4e-3, size=2.1e-3), (15, 25, 12), 5.0),
    "at the right side": Shape((60, 15, 15), TaxelLayout(rows=1, columns=6, pitch=9e-3, size=8e-3), (57, 7.5, 9), 1.0),
    "one taxel": Shape((20, 20, 10), TaxelLayout(rows=1, columns=1), (12, 8, 6), 1.0),
}

QUICK = ("wide and thin", "many taxels")
"""Shapes that the quick tests draw: the widest, the highest and the one of most words."""


def grasped(shape: Shape, *, pressure: float = PRESSURE, cells: tuple[int, int, int] = CELLS) -> Result:
    """A lump in a block of a shape, pressed alike everywhere."""
    size, centre = 1e-3 * np.array(shape.block), 1e-3 * np.array(shape.lump)
    x, y, z = centre.tolist()
    closing = 0.05 * float(size[2])
    mesh = structured_block(size.tolist(), cells).mesh
    middles = mesh.nodes[mesh.elements[:, :4]].mean(axis=1)
    away = np.linalg.norm(middles - centre, axis=1)
    inside = (away <= max(1e-3 * shape.radius, float(away.min()))).astype(float)
    moved = np.zeros(mesh.nodes.shape)
    moved[:, 2] = closing * (1 - 2 * mesh.nodes[:, 2] / size[2])
    fields = {"displacement [m]": moved, "pressure [Pa]": np.full(len(mesh.nodes), pressure)}
    frame = FieldFrame(1.0, mesh.nodes, {"tetra10": mesh.elements}, fields, {"region [1]": inside})
    across = np.full((shape.layout.rows, shape.layout.columns), pressure)
    quantities = {"displacement": Quantity(closing, "m", "")}
    for side in JAWS:
        quantities[f"taxel_pressure_{side}"] = Quantity(across.tolist(), "Pa", "")
        quantities[f"taxel_force_{side}"] = Quantity((across * shape.layout.area).tolist(), "N", "")
    jaw = {"width": 1.25 * float(size[0]), "depth": 1.25 * float(size[1])}
    lump = Sphere(center=(x, y, z), radius=1e-3 * shape.radius)
    scene = grasp_scene(size.tolist(), shape.layout, [lump], closing=closing, **jaw)
    steps = tuple(StepRecord(k, 4, 1e-12, {"time": 0.5 * k, "displacement": 0.5 * k * closing} | FORCES) for k in (1, 2))
    return Result("grasp", Status.CONVERGED, "", quantities, steps=steps, frames=(frame,), title="A grasp", scene=scene)


@pytest.mark.parametrize("shape", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in SHAPES])
def test_words_keep_clear_of_each_other(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grasp_view, "Rendering", Unrendered)
    result = grasped(SHAPES[shape])
    figures = dict(result.plot())
    assert len(figures) == 5
    if shape != QUICK[-1]:
        del figures["grasp_history"]  # the same of every block; most words are those of many taxels
    figures |= {"sketch": replace(result, status=Status.INTERRUPTED, steps=()).plot("sketch")}
    assert {name: found for name, figure in figures.items() if (found := colliding_words(figure))} == {}


def test_a_failed_run_and_a_long_title_leave_the_maps_as_large_as_they_are() -> None:
    """The foot took its room from the maps, whose pressures then ran into one another."""
    result = grasped(SHAPES["usual"], pressure=3.86e6)
    failed = replace(result, status=Status.FAILED, reason="it did not converge, for many reasons " * 9, title="t" * LONGEST_TITLE)
    widths = []
    for shown in (result, failed):
        figure = maps_figure(shown)
        assert colliding_words(figure) == []
        widths.append(figure.axes[0].get_window_extent().width)
    assert widths[1] > 0.85 * widths[0]


def test_wide_maps_stand_below_each_other_and_their_letters_grow_with_them() -> None:
    layouts = {name: MapsLayout.of(grasped(shape).scene_as(SimulatedGrasp)) for name, shape in SHAPES.items()}
    assert {name for name, layout in layouts.items() if layout.rows == 2} == {"one row", "at the right side"}
    figure = maps_figure(grasped(SHAPES["one row"]))
    sizes = {float(text.get_fontsize()) for axis in figure.axes for text in axis.texts if text.get_text().endswith("kPa")}
    assert min(sizes) > 7.0


@pytest.mark.parametrize(("pressure", "words"), [(3.86e6, "310 N"), (86.0, "7.0 mN"), (0.5, "40 µN")])
def test_forces_have_no_powers_of_ten(pressure: float, words: str) -> None:
    shown = text_of(maps_figure(grasped(SHAPES["usual"], pressure=pressure)))
    assert "e+" not in shown
    assert "e-" not in shown
    assert f" {words}" in f" {shown}"


def test_the_name_of_a_small_inclusion_stands_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grasp_view, "Rendering", Unrendered)
    result = grasped(SHAPES["wide and thin"], cells=(60, 30, 2))
    section = section_figure(result)
    section.draw_without_rendering()
    axis = section.axes[0]
    name = next(text for text in axis.texts if text.get_text() == "sphere 1")
    (frame,) = result.frames
    lump = frame.points[frame.cells["tetra10"][frame.cell_data["region [1]"] > 0]]
    assert axis.transData.inverted().transform(name.get_window_extent())[0, 0] > 1e3 * lump[..., 0].max()
    beside = section_figure(grasped(SHAPES["at the right side"], cells=(60, 8, 4)))
    beside.draw_without_rendering()
    (name,) = (text for text in beside.axes[0].texts if text.get_text() == "sphere 1")
    assert name.get_window_extent().x1 < beside.axes[0].transData.transform((56.0, 0.0))[0]
    view = result.plot(VIEW.removesuffix(".png"))
    assert {text.get_horizontalalignment() for a in view.axes for text in a.texts if text.get_text() == "sphere 1"} == {"left"}
