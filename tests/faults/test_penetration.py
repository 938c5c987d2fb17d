"""Penetration that takes force away is refused, estimated and never called a success."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest
from pydantic import ValidationError

from tactsim.experiments.annulus.closed_form import ClosedForm
from tactsim.experiments.durometer.durometer import Durometer
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.indentation_3d import Indentation3D
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.experiments.switch_probe.switch_probe import SwitchProbe
from tactsim.mechanics.outcome.success import judged, sufficient_tolerance
from tactsim.results.result import Status, StepRecord

pytestmark = pytest.mark.usefixtures("one_thread")
COARSE = {"finest": 0.1e-3, "growth": 1.0, "adaptive": False}
SHALLOW = {"stop": "displacement", "displacement": 0.2e-3, "mesh": COARSE}
SMOOTH = {"kind": "coulomb", "friction": 0.0}
BALL = {"body": {"kind": "sphere", "radius": 3e-3}, "recess": None, "contact": SMOOTH}
SPECIMEN = {"material": "icf_stable", "thickness": 4e-3, "radius": 8e-3}
PRESS = {"control": "force", "pieces": [{"kind": "ramp", "to": 0.05, "duration": 1.0}]}


def changed(kind, **changes):
    return kind.model_validate(kind.example().model_dump() | changes)


@cache
def result_of(kind, text):
    return kind.model_validate_json(text).run()


def run(kind, **changes):
    """The result of a changed example, computed once for all tests that ask for it."""
    return result_of(kind, changed(kind, **changes).model_dump_json())


def force_and_error(kind, tolerance, **changes):
    result = run(kind, penetration_tolerance=tolerance, **changes)
    return result.steps[-1].values["reaction_force"], result.quantities["penetration_force_error"].value


@pytest.mark.parametrize("tolerance", [1.0, 1e-3, 1e-4])
def test_a_tolerance_as_large_as_the_displacement_is_refused(tolerance):
    with pytest.raises(
        ValidationError, match=r"penetration_tolerance: .* is not small beside the .*; allowed: at most .*, a tenth"
    ):
        changed(Indentation, penetration_tolerance=tolerance, **SHALLOW)


@pytest.mark.parametrize(
    ("kind", "changes", "length"),
    [
        (Indentation, {"displacement": 3e-3, "penetration_tolerance": 21e-6}, "body's fillet of 200 µm"),
        (Indentation, {"body": {"kind": "annulus", "fillet": 0.0}, "penetration_tolerance": 151e-6}, "width of the contact"),
        (
            Indentation,
            {
                "specimen": SPECIMEN | {"layers": [{"thickness": 50e-6, "material": "b1a_stable"}]},
                "penetration_tolerance": 6e-6,
            },
            "thickness of the thinnest layer of 50 µm",
        ),
        (TimedIndentation, {"penetration_tolerance": 11e-6}, "displacement of 100 µm"),
        (TimedIndentation, {"loading": PRESS, "penetration_tolerance": 1.0}, "body's fillet"),
        (Indentation3D, {"penetration_tolerance": 1e-3}, "body's fillet"),
        (Grasp, {"penetration_tolerance": 101e-6}, "closing of 1 mm|fillet of 1 mm"),
        (Grasp, {"loading": PRESS, "penetration_tolerance": 1.0}, "fillet of 1 mm"),
        (Durometer, {"penetration_tolerance": 120e-6}, "indentor's radius of 1.19 mm"),
    ],
)
def test_the_length_that_bounds_the_tolerance_is_named(kind, changes, length):
    with pytest.raises(ValidationError, match=f"penetration_tolerance: .*{length}"):
        changed(kind, **changes)


def test_a_tenth_of_every_length_is_allowed():
    assert changed(Indentation, displacement=3e-3, penetration_tolerance=20e-6).tolerance == 20e-6
    assert changed(Grasp, penetration_tolerance=100e-6).tolerance == 100e-6


def test_no_default_exceeds_what_a_small_displacement_allows():
    assert changed(Indentation, stop="displacement", displacement=2e-6).tolerance == pytest.approx(4e-9)
    assert Indentation.example().tolerance == pytest.approx(1e-4 * 3e-3)
    closing = {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-6, "duration": 1.0}]}
    assert changed(Grasp, loading=closing).tolerance == pytest.approx(10e-9)
    assert changed(SwitchProbe, depth=1e-4).penetration == pytest.approx(0.2e-6)


def test_a_run_that_loses_force_to_penetration_fails_and_reports_what_to_take():
    result = run(Indentation, penetration_tolerance=2e-5, **SHALLOW)
    assert result.status is Status.FAILED
    assert "% of the force by its estimate" in result.reason
    assert "allowed: 0.5 %; take penetration_tolerance: at most " in result.reason
    assert run(Indentation, penetration_tolerance=1e-6, **SHALLOW).status is Status.CONVERGED


@pytest.mark.parametrize(
    ("kind", "changes", "tight", "loose"),
    [
        pytest.param(Indentation, SHALLOW, 1e-7, (1e-6, 5e-6, 2e-5), marks=pytest.mark.slow),
        (Indentation, SHALLOW | {"contact": SMOOTH}, 1e-7, (2e-5,)),
        pytest.param(Indentation, SHALLOW | BALL, 1e-7, (5e-6, 2e-5), marks=pytest.mark.slow),
        (Grasp, {"contact": SMOOTH}, 1e-7, (4e-6, 1e-5)),
    ],
)
def test_the_estimate_has_the_size_of_the_error(kind, changes, tight, loose):
    true, _ = force_and_error(kind, tight, **changes)
    for tolerance in loose:
        force, estimated = force_and_error(kind, tolerance, **changes)
        assert estimated == pytest.approx(1 - force / true, rel=1 / 3), "first order in the penetration, secants for slopes"


def test_under_a_force_the_estimate_is_the_error_of_the_displacement():
    held = {"loading": {"control": "force", "pieces": [{"kind": "jump", "to": 40e-3, "duration": 1.0}]}, "contact": SMOOTH}
    held |= {"specimen": SPECIMEN, "mesh": COARSE, "time": {"per_decade": 0}}
    results = [run(TimedIndentation, penetration_tolerance=tolerance, **held) for tolerance in (1e-7, 1e-5)]
    exact, deeper = (result.steps[-1].values["displacement"] for result in results)
    error = results[1].quantities["penetration_force_error"].value
    assert error > 0.01
    assert results[1].status is Status.FAILED
    assert error == pytest.approx((deeper - exact) / deeper, rel=0.5), "a single step has secants for its slopes"


GOOD = {
    "displacement": 1e-3,
    "reaction_force": 1.0,
    "max_penetration": 1e-7,
    "min_volume_ratio": 0.9,
    "penetration_force_error": 1e-4,
}


@pytest.mark.parametrize(
    ("values", "residual", "words"),
    [
        ({"reaction_force": math.nan}, 1e-12, "the reaction force is nan"),
        ({"penetration_force_error": math.inf}, 1e-12, "the penetration force error is inf"),
        ({}, 1e-3, r"the residual is 1\.0e-03"),
        ({}, math.nan, "the residual is nan"),
        ({"min_volume_ratio": 0.0}, 1e-12, "inside out"),
        ({"max_penetration": 2e-6}, 1e-12, "the penetration is 2 µm; allowed: 1 µm"),
        ({"penetration_force_error": 6e-3}, 1e-12, "takes away 0.60 % of the force"),
        ({"penetration_force_error": 6e-3, "max_penetration": 0.0}, 1e-12, "takes away 0.60 % of the force"),
    ],
)
def test_one_place_says_no(values, residual, words):
    bad = StepRecord(2, 3, residual, GOOD | values)
    for reported in ([bad], [replace(bad, step=1, values=GOOD, residual=1e-12), bad]):
        status, reason = judged(Status.CONVERGED, "displacement reached", reported, 1e-6)
        assert status is Status.FAILED
        assert words.replace("\\", "") in reason
    assert judged(Status.INTERRUPTED, "stopped", [bad], 1e-6) == (Status.INTERRUPTED, "stopped")


def test_one_place_says_yes():
    assert judged(Status.CONVERGED, "done", [StepRecord(1, 3, 1e-12, GOOD)], 1e-6) == (Status.CONVERGED, "done")
    assert judged(Status.CONVERGED, "done", [], 1e-6) == (Status.CONVERGED, "done")


def test_the_advised_tolerance_is_enough_and_has_one_digit():
    assert sufficient_tolerance(1e-5, 1.0, 0.02) == pytest.approx(2e-6)
    assert sufficient_tolerance(0.0, 1e-5, 0.02) == sufficient_tolerance(-1.0, 1e-5, 0.02) == pytest.approx(2e-6)
    assert 0 < sufficient_tolerance(1.0, 1.0, 1.0) < 1e-4


def test_unloading_to_nothing_is_measured_by_the_largest_force():
    pieces = [{"kind": "ramp", "to": 1e-3, "duration": 1.0}, {"kind": "ramp", "to": 1e-6, "duration": 1.0}]
    result = run(Grasp, loading={"control": "displacement", "pieces": pieces}, contact=SMOOTH)
    assert result.status is Status.CONVERGED, result.reason
    assert result.steps[-1].values["reaction_force"] < 0.01 * result.steps[1].values["reaction_force"]


def layered(control, value):
    loading = {"control": control, "pieces": [{"kind": "jump", "to": value, "duration": 1.0}]}
    return changed(ClosedForm, thickness=1e-3, loading=loading)


def test_a_closed_form_does_not_press_through_its_layer():
    with pytest.raises(ValidationError, match=r"displacement 30 mm must be smaller than the thickness of the layer, 1 mm"):
        layered("displacement", 30e-3)
    result = layered("force", 1e5).run()
    assert result.status is Status.FAILED
    assert "allowed: less than the thickness of the layer, 1 mm" in result.reason
    assert layered("displacement", 0.1e-3).run().status is Status.CONVERGED
