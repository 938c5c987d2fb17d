"""The figure of an indentation, for every way a run can end, drawn from memory and from disk."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import text_of
from scenes import SOLVER, unmarked_figures

from tactsim.contact.annulus import Annulus
from tactsim.experiments.indentation.figures.indentation import IndentationFigures
from tactsim.experiments.indentation.scene import ContactProfile, IndentationScene
from tactsim.plotting import figures_for
from tactsim.results import FieldFrame, Quantity, Result, Status, StepRecord


def made_up(status=Status.CONVERGED):
    points = np.array([[0, 0, 0], [4, 0, 0], [0, -4, 0], [2, 0, 0], [2, -2, 0], [0, -2, 0]]) * 1e-3
    elements = np.array([[0, 2, 1, 5, 4, 3]])
    fields = {"displacement [m]": np.zeros((6, 3)), "pressure [Pa]": np.linspace(-1e3, 9e3, 6)}
    frame = FieldFrame(1e-3, points, {"triangle6": elements}, fields)
    steps = tuple(
        StepRecord(k, 5, 1e-12, {"displacement": 1e-4 * k, "reaction_force": 0.1 * k**2, "tissue_rise": 5e-5 * k})
        for k in range(1, 5)
    )
    quantities = {
        "threshold_displacement": Quantity(4e-4, "m", ""),
        "threshold_force": Quantity(1.6, "N", ""),
        "threshold_pressure": Quantity(75450.0, "Pa", ""),
    }
    scene = IndentationScene(body=Annulus(), recess=2e-4, starting_height=0.0, solver=SOLVER)
    return Result("indentation", status, "because", quantities, steps=steps, frames=(frame,), title="A title", scene=scene)


def test_threshold_and_title_are_reported():
    written = text_of(IndentationFigures().figure(made_up()))
    for words in ("A title", "threshold", "75.45 kPa", "1.6 N", "pressure in kPa", "displacement in"):
        assert words in written
    assert "FAILED" not in written


def test_a_colour_bar_says_what_lies_beyond_its_colours():
    plain = made_up()
    (frame,) = plain.frames
    singular = {**frame.point_data, "pressure [Pa]": np.array([7.2e4, 1e3, 1e3, 2e3, 3e3, -5e2])}
    written = text_of(IndentationFigures().figure(replace(plain, frames=(replace(frame, point_data=singular),))))
    assert "arrows: what lies beyond them, up to 72 kPa" in written
    even = np.full(6, 1e3)
    level = replace(plain, frames=(replace(frame, point_data={**frame.point_data, "pressure [Pa]": even}),))
    assert "arrows" not in text_of(IndentationFigures().figure(level))


def test_the_contact_pressure_is_drawn_to_a_percentile_and_what_lies_beyond_is_said():
    plain = made_up()
    radius = np.linspace(0.05, 4.0, 80) * 1e-3
    pressure = np.where((radius > 1.5e-3) & (radius < 3e-3), 2e4, 0.0)
    pressure[np.searchsorted(radius, 2.99e-3) - 1] = 2e5
    area = np.where(pressure > 1e5, 1e-3, 1.0) * radius
    profile = ContactProfile(radius=tuple(radius), pressure=tuple(pressure), area=tuple(area))
    figure = IndentationFigures().figure(replace(plain, scene=plain.scene.model_copy(update={"contact": profile})))
    axis = next(axis for axis in figure.axes if "contact pressure" in axis.get_ylabel())
    assert "in kPa" in axis.get_ylabel()
    assert axis.get_ylim()[1] == pytest.approx(23)
    np.testing.assert_allclose(axis.lines[0].get_xydata(), 1e-3 * np.column_stack([1e6 * radius, pressure]))
    assert axis.get_title("left") == "mean on each element, to the 99th percentile; 200 kPa at 2.95 mm"
    even = profile.model_copy(update={"pressure": tuple(np.minimum(pressure, 2e4))})
    figure = IndentationFigures().figure(replace(plain, scene=plain.scene.model_copy(update={"contact": even})))
    assert "mean on each element" in [axis.get_title("left") for axis in figure.axes]


@pytest.mark.parametrize("status", [Status.FAILED, Status.INTERRUPTED])
def test_a_run_that_did_not_end_well_is_marked(status):
    written = text_of(IndentationFigures().figure(replace(made_up(status), quantities={})))
    assert f"{status.upper()} after a displacement" in written
    assert "because" in written


def test_labels_of_a_run_that_stopped_early_lie_on_nothing():
    early = replace(made_up(Status.FAILED), quantities={}, scene=scene_with(8e-4))
    figure = IndentationFigures().figure(early)
    figure.canvas.draw()
    section, curve = figure.axes[0], next(axis for axis in figure.axes if "force on the body" in axis.get_ylabel())
    (sensor,) = [text for text in section.texts if "inner sensor" in text.get_text()]
    assert sensor.get_window_extent().y1 <= section.get_window_extent().y1 + 1, "not on the title"
    assert "stopped (cross) at 400 µm; 4 accepted steps" in curve.get_title(loc="left")
    rise = next(axis for axis in figure.axes if "rise" in axis.get_ylabel())
    points = [*drawn_points(curve), *drawn_points(rise)]
    for text in curve.texts:
        assert not any(text.get_window_extent().contains(*point) for point in points), text.get_text()


def scene_with(recess):
    return IndentationScene(body=Annulus(), recess=recess, starting_height=0.0, solver=SOLVER)


def drawn_points(axis):
    """Pixels of all lines of an axis, closely spaced."""
    for line in axis.lines:
        x, y = line.get_xydata().T
        fine = np.linspace(0, len(x) - 1, 400)
        at = [np.interp(fine, np.arange(len(x)), side) for side in (x, y)]
        yield from axis.transData.transform(np.transpose(at))


def test_rise_reaches_the_recess_on_its_own_axis():
    figure = IndentationFigures().figure(made_up())
    rise = next(axis for axis in figure.axes if "rise" in axis.get_ylabel())
    np.testing.assert_allclose(rise.lines[0].get_ydata()[-1], 0.2)
    assert 0.2 < rise.get_ylim()[1] < 0.3


def test_png_by_name_and_nothing_without_steps():
    drawings = figures_for(made_up())
    assert list(drawings) == ["indentation.png"]
    assert drawings["indentation.png"]().startswith(b"\x89PNG")
    assert unmarked_figures(made_up()) == []
    assert figures_for(replace(made_up(), steps=(), frames=())) == {}
    assert list(figures_for(replace(made_up(), steps=()))) == ["sketch.png"]
    assert figures_for(replace(made_up(), kind="unheard_of")) == {}
