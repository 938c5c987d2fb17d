"""Where an event is located: within its tolerance, with few equilibria, and whatever the curve looks like."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.fem.paths.event import crossing


def located(curve, bracket, tolerance, *, earlier=()):
    """The place and the number of calls."""
    places = []

    def value(place):
        places.append(place)
        return curve(place)

    known = {place: curve(place) for place in (*earlier, *bracket)}
    place = crossing(value, known, bracket, tolerance)
    assert not places or place == places[-1]
    return place, len(places)


def test_the_path_before_makes_the_first_estimate_one_of_third_order():
    """A rise into the hole of an annulus: 0.8 mm at 2.24 mm, a step of 0.15 mm, located to 8 nm."""

    def rise(place):
        return 0.32 * place + 0.017 * place**2 - 0.8

    exact = (-0.32 + np.sqrt(0.32**2 + 4 * 0.017 * 0.8)) / (2 * 0.017)
    bracket = (exact - 0.1, exact + 0.05)
    place, solutions = located(rise, bracket, 8e-6, earlier=(exact - 0.25,))
    assert abs(place - exact) <= 8e-6
    assert solutions <= 2, "each is a Newton solution of some seven systems"


@pytest.mark.parametrize(
    ("curve", "root"),
    [
        (lambda x: x**9 - 1e-6, 1e-6 ** (1 / 9)),
        (lambda x: np.cbrt(x - 0.3), 0.3),
        (lambda x: -1.0 if x < 0.77 else 1.0, 0.77),
        (lambda x: max(x - 0.999, 1e-3 * (x - 0.999)), 0.999),
    ],
)
def test_curves_that_mislead_an_interpolation_are_bracketed(curve, root):
    place, calls = located(curve, (0.0, 1.0), 1e-6)
    assert place == pytest.approx(root, abs=2e-6)
    assert calls < 60


def test_a_root_at_the_end_needs_no_solution():
    assert located(lambda x: x - 1.0, (0.0, 1.0), 1e-9) == (1.0, 0)
