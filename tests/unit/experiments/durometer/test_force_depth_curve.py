"""The force-depth curve: Hertz's own curve reads what Hertz reads; its ends are reported."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.analytic.durometer import DurometerScale, hertz_force, hertz_modulus, hertz_reading
from tactsim.errors import InputError, InvalidQuantity
from tactsim.experiments.durometer.force_depth_curve import ForceDepthCurve
from tactsim.results import Result, Status, StepRecord

SCALE, RADIUS = DurometerScale(), 1.19e-3
INTERPOLATION = 2e-4
"""Of the force between 40 points of a power 1.5."""


def hertzian(travel=SCALE.travel, radius=RADIUS):
    depth = np.linspace(0, travel, 41)
    return ForceDepthCurve(depth, hertz_force(depth, radius, 1.0))


@pytest.mark.parametrize("reading", [0.5, 20.0, 60.0, 90.0])
def test_it_reads_what_hertz_reads(reading):
    modulus = hertz_modulus(reading, SCALE, RADIUS)
    expected = hertz_reading(modulus, SCALE, RADIUS)

    def check(curve):
        assert curve.modulus(reading, SCALE) == pytest.approx(modulus, rel=INTERPOLATION)
        assert curve.reading(modulus, SCALE) == pytest.approx(expected, abs=100 * INTERPOLATION)

    check(hertzian())
    assert_kills(check, radius=(hertzian(radius=1.01 * RADIUS),))


def test_it_bottoms_out():
    assert hertzian().reading(1e3, SCALE) is None


def test_a_curve_that_ends_early_says_so():
    short = hertzian(1e-3)
    assert short.reading(2e6, SCALE) > 60
    with pytest.raises(InputError, match="ends at 1 mm"):
        short.reading(20e3, SCALE)
    with pytest.raises(InvalidQuantity, match="the curve ends at 1 mm"):
        short.modulus(20, SCALE)
    with pytest.raises(InvalidQuantity, match="allowed are 0"):
        short.modulus(float("nan"), SCALE)


def test_a_run_without_steps_makes_no_curve():
    step = StepRecord(1, 3, 0.0, {"displacement": 1e-4, "reaction_force": 0.1})
    with pytest.raises(InputError, match="from 1 accepted steps of the durometer: because"):
        ForceDepthCurve.of(Result("durometer", Status.FAILED, "because", steps=(step,)), 1e3)
