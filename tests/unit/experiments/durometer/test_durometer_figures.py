"""The figure of a durometer for every way a run can end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn import covered_lines, text_of
from scenes import SOLVER, unmarked_figures

from tactsim.analytic.durometer import DurometerScale
from tactsim.contact.sphere import Sphere
from tactsim.experiments.durometer.figures.durometer import DurometerFigures, _past_the_reading
from tactsim.experiments.durometer.scene import DurometerScene
from tactsim.plotting import figures_for
from tactsim.results import FieldFrame, Quantity, Result, Status, StepRecord

READ = {"reading": 63.05, "reading_low": 62.86, "reading_high": 63.25, "depth": 0.92e-3, "spring_force": 0.775}


def made_up(**quantities):
    steps = tuple(
        StepRecord(k, 5, 1e-12, {"displacement": 5e-4 * k, "reaction_force": 0.2 * k**1.5, "hertz_force": 0.15 * k**1.5})
        for k in range(1, 6)
    )
    pressed = {"body": Sphere(radius=1e-3), "starting_height": 0.0, "recess": None, "solver": SOLVER}
    scene = DurometerScene(**pressed, scale=DurometerScale(), youngs_modulus=1e4)
    reported = {name: Quantity(value, "1", "") for name, value in quantities.items()}
    return Result("durometer", Status.CONVERGED, "because", reported, steps=steps, title="A title", scene=scene)


def test_the_reading_is_reported_with_its_interval():
    written = text_of(DurometerFigures().figure(made_up(**READ)))
    for words in ("A title", "63.0", "(62.9 to 63.2)", "spring", "Hertz", "reading", "depth of the indentor in mm"):
        assert words in written
    assert "bottoms out" not in written
    assert "FAILED" not in written


QUICK = ((0.2e-3, 1.0), (0.9e-3, 1.9), (2.4e-3, 1.0))
"""At both ends of the scale, and where curves beyond it lie in the corner at the top right."""
PLACES = [(depth, reach) for depth in (0.2e-3, 0.9e-3, 1.6e-3, 2.4e-3) for reach in (1.0, 1.9)]


@pytest.mark.parametrize(
    ("depth", "reach"), [place if place in QUICK else pytest.param(*place, marks=pytest.mark.slow) for place in PLACES]
)
def test_no_curve_runs_through_the_legend(depth, reach):
    """Where tissue and spring balance near either end of the scale or between, and where the tissue is pressed beyond it; Hertz
    may lie above or below."""
    scale = DurometerScale()
    balance = scale.force_at_zero + scale.force_per_unit * 100 * (1 - depth / scale.travel)
    for share in (0.6, 1.3):
        forces = [(part, balance * part**1.5) for part in reach * np.linspace(0.1, 1, 10)]
        values = [{"displacement": depth * part, "reaction_force": force, "hertz_force": share * force} for part, force in forces]
        steps = tuple(StepRecord(k, 5, 1e-12, one) for k, one in enumerate(values, 1))
        assert covered_lines(DurometerFigures().figure(replace(made_up(**READ), steps=steps))) == []


def test_off_the_scale_is_reported():
    assert "reading: below 0, the indentor bottoms out" in text_of(DurometerFigures().figure(made_up(reading=0.0)))
    assert "reading: none" in text_of(DurometerFigures().figure(made_up()))


@pytest.mark.parametrize("status", [Status.FAILED, Status.INTERRUPTED])
def test_a_run_that_did_not_end_well_is_marked(status):
    written = text_of(DurometerFigures().figure(replace(made_up(), status=status)))
    assert f"{status.upper()} after a displacement of 2.5 mm: because" in written


def test_png_by_name_and_nothing_without_steps():
    (name, draw), *rest = figures_for(made_up(**READ)).items()
    assert (name, rest) == ("durometer.png", [])
    assert draw().startswith(b"\x89PNG")
    assert unmarked_figures(made_up(**READ)) == []
    assert figures_for(replace(made_up(), steps=())) == {}


def test_a_section_deeper_than_the_reading_says_so():
    result = made_up(**READ)
    assert _past_the_reading(result) == ""
    frames = [FieldFrame(depth, np.zeros((1, 3)), {}, {}, {}) for depth in (2.5e-3, READ["depth"])]
    assert [_past_the_reading(replace(result, frames=(frame,))) for frame in frames] == [
        "past the reading, which is at 920 µm",
        "",
    ]
