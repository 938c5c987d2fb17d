"""The scale of a durometer and Hertz on it: the numbers of the errata, both ways, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.durometer import DurometerScale, hertz_force, hertz_modulus, hertz_reading
from tactsim.errors import CaseError, InvalidQuantity

SCALE = DurometerScale()
RADIUS = 1.19e-3


@pytest.mark.parametrize(("reading", "modulus", "step"), [(36, 135e3, 500), (1, 28e3, 500)])
def test_the_moduli_of_the_errata(reading, modulus, step):
    """Printed to three and two digits."""
    assert hertz_modulus(reading, SCALE, RADIUS) == pytest.approx(modulus, abs=step)
    assert hertz_modulus(reading, SCALE, 2 * RADIUS) != pytest.approx(modulus, abs=step), "the diameter is no radius"


def test_the_ends_of_the_scale():
    assert SCALE.depth(0) == SCALE.travel
    assert SCALE.depth(100) == 0
    assert SCALE.spring_force(SCALE.travel) == pytest.approx(0.203, rel=1e-14)  # round-off
    assert SCALE.spring_force(0.0) == pytest.approx(0.203 + 0.908, rel=1e-14)


@pytest.mark.parametrize("reading", [0.0, 1.0, 36.0, 99.0])
def test_reading_and_modulus_are_inverse(reading):
    modulus = hertz_modulus(reading, SCALE, RADIUS) * (1 + 1e-13)
    assert hertz_reading(modulus, SCALE, RADIUS) == pytest.approx(reading, abs=1e-8)  # 1e-12 of the travel, by 100
    assert hertz_reading(1.01 * modulus, SCALE, RADIUS) != pytest.approx(reading, abs=1e-8)


def test_soft_tissue_is_off_the_scale():
    assert hertz_reading(0.99 * hertz_modulus(0.0, SCALE, RADIUS), SCALE, RADIUS) is None
    assert hertz_reading(1e14, SCALE, RADIUS) == pytest.approx(100, abs=1e-3)


def test_force_of_hertz_by_hand():
    """16/9 of 9 Pa times sqrt(4 m) times 1 m^1.5."""
    np.testing.assert_allclose(hertz_force(np.array([0.0, 1.0]), 4.0, 9.0), [0.0, 32.0], rtol=1e-15)


@pytest.mark.parametrize("reading", [-0.1, 100.0, 101.0, float("nan")])
def test_a_reading_off_the_scale_is_refused(reading):
    with pytest.raises(InvalidQuantity, match="allowed are 0 to below 100"):
        hertz_modulus(reading, SCALE, RADIUS)


@pytest.mark.parametrize("modulus", [0.0, -1.0, float("nan"), float("inf"), 1e16])
def test_a_modulus_is_positive_and_that_of_a_solid(modulus):
    with pytest.raises(InvalidQuantity, match="Young's modulus"):
        hertz_reading(modulus, SCALE, RADIUS)


@pytest.mark.parametrize("change", [{"travel": 0.0}, {"force_at_zero": -0.2}, {"force_per_unit": float("nan")}, {"units": 3}])
def test_an_impossible_scale_is_refused(change):
    with pytest.raises(CaseError, match=next(iter(change))):
        DurometerScale(**change)
