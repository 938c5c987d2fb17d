"""The figure of an indentation in space: the cut through the tissue, for every part that is computed and every way to end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import colliding_words, text_of
from scenes import SOLVER, unmarked_figures

from tactsim.contact.annulus import Annulus
from tactsim.contact.tilted import Tilted
from tactsim.experiments.indentation.figures.indentation_3d import Indentation3DFigures
from tactsim.experiments.indentation.figures.section import Section
from tactsim.experiments.indentation.figures.section_3d import cut
from tactsim.experiments.indentation.scene import Indentation3dScene
from tactsim.mesh.axisymmetric import section_mesh
from tactsim.mesh.revolved import swept
from tactsim.plotting import figures_for
from tactsim.results import FieldFrame, Quantity, Result, Status, StepRecord

SECTION = section_mesh(8e-3, (0.0, -4e-3), lambda points: np.full(len(points), 2e-3))
TURNS = {"quarter": np.pi / 2, "half": np.pi, "whole": 2 * np.pi}


def made_up(symmetry="half", status=Status.CONVERGED):
    mesh = swept(SECTION, round(TURNS[symmetry] / np.pi * 4), TURNS[symmetry]).mesh
    fields = {"displacement [m]": 0.01 * mesh.nodes, "pressure [Pa]": 1e3 * np.arange(len(mesh.nodes)) / len(mesh.nodes)}
    frame = FieldFrame(4e-4, mesh.nodes, {"tetra10": mesh.elements}, fields, {"region [1]": mesh.regions.astype(float)})
    steps = tuple(
        StepRecord(k, 5, 1e-12, {"displacement": 1e-4 * k, "reaction_force": 0.1 * k**2, "tissue_rise": 5e-5 * k})
        for k in range(1, 5)
    )
    body = Tilted(body=Annulus(), tilt_y=0.0 if symmetry == "quarter" else 0.05)
    scene = Indentation3dScene(body=body, starting_height=0.0, recess=8e-4, solver=SOLVER, symmetry=symmetry, offset=0.0)
    quantities = {"pressure_around": Quantity([1e4, 2e4, 2e4, 1e4, 5e3, 4e3, 4e3, 5e3], "Pa", "")}
    return Result("indentation_3d", status, "because", quantities, steps=steps, frames=(frame,), title="A title", scene=scene)


@pytest.mark.parametrize(("symmetry", "sections"), [("quarter", 1), ("half", 2), ("whole", 2)])
def test_cut_is_the_section_once_on_each_side_that_is_computed(symmetry, sections):
    section = cut(made_up(symmetry).frames[-1])
    assert len(section.cells["triangle6"]) == sections * len(SECTION.elements)
    corners = section.points[section.cells["triangle6"][:, :3], :2]
    sides = corners[:, 1:] - corners[:, :1]
    area = np.abs(np.linalg.det(sides)).sum() / 2
    assert area == pytest.approx(sections * 8e-3 * 4e-3, rel=1e-12)
    edges, outline = Section(section).edges()
    middles = section.points[edges[:, 1]]
    np.testing.assert_allclose(middles, section.points[edges[:, [0, 2]]].mean(axis=1), atol=1e-15)
    assert outline.any()


@pytest.mark.parametrize("symmetry", list(TURNS))
def test_figure_shows_what_is_seen(symmetry):
    written = text_of(Indentation3DFigures().figure(made_up(symmetry)))
    for words in ("A title", "cut y = 0", "pressure in", "inner sensor", "displacement in"):
        assert words in written
    assert ("sectors of the annulus" in written) == (symmetry != "quarter")


def test_the_cut_goes_the_way_that_the_body_leans():
    """In the cut y = 0 of a body that leans about x nothing is pressed."""
    result = made_up("whole")
    leaning = result.scene.model_copy(update={"body": Tilted(body=Annulus(), tilt_x=0.1)})
    assert "cut y = 0" in text_of(Indentation3DFigures().figure(result))
    figure = Indentation3DFigures().figure(replace(result, scene=leaning))
    assert "cut x = 0" in text_of(figure)
    beside = leaning.model_copy(update={"offset": 1e-3})
    assert "cut y = 0" in text_of(Indentation3DFigures().figure(replace(result, scene=beside)))
    sensor = next(line for line in figure.axes[0].lines if len(line.get_xdata()) == 2)
    assert np.ptp(sensor.get_ydata()) == pytest.approx(3.0 * np.sin(0.1))
    along_y = cut(result.frames[-1], 1)
    assert len(along_y.cells["triangle6"]) == len(cut(result.frames[-1]).cells["triangle6"])


def test_failed_run_is_marked_and_fields_may_be_missing():
    failed = made_up(status=Status.FAILED)
    written = text_of(Indentation3DFigures().figure(replace(failed, frames=())))
    assert "FAILED" in written
    assert "because" in written
    assert "cut" not in written


def test_drawings_are_png_and_none_without_steps():
    drawings = figures_for(made_up())
    assert list(drawings) == ["indentation_3d.png"]
    assert drawings["indentation_3d.png"]().startswith(b"\x89PNG")
    assert unmarked_figures(made_up()) == []
    assert figures_for(replace(made_up(), steps=(), frames=())) == {}


@pytest.mark.parametrize("status", [Status.CONVERGED, Status.FAILED])
def test_the_pressure_around_begins_and_ends_as_it_is_and_its_mean_is_named(status):
    """The steps fell to zero at 0 and 360 degrees, as if nothing were pressed there."""
    figure = Indentation3DFigures().figure(made_up("whole", status))
    axis = next(a for a in figure.axes if "sectors" in a.get_title(loc="left"))
    (steps,) = axis.patches
    assert steps.get_path().vertices[:, 1].min() == 4.0
    assert "dotted: on all" in axis.get_title(loc="left")
    assert colliding_words(figure) == []
