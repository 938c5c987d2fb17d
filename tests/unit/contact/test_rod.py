"""The rod: a sphere below its centre, a cylinder above, and no size that is not one."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.rod import Rod
from tactsim.contact.sphere import Sphere
from tactsim.errors import CaseError

RADIUS = 1.19e-3


def points(low, high):
    generator = np.random.default_rng(1)
    return np.stack([generator.uniform(0, 2, 200), generator.uniform(low, high, 200)]) * RADIUS


def test_the_end_is_a_sphere():
    below = points(-1, 0.999)
    for mine, its in zip(Rod().signed_distance(below), Sphere(radius=RADIUS).signed_distance(below), strict=True):
        np.testing.assert_allclose(mine, its, rtol=1e-9, atol=1e-18)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(
            Rod().signed_distance(below)[0], Sphere(radius=1.01 * RADIUS).signed_distance(below)[0], rtol=1e-9
        )


def test_the_shank_is_a_cylinder():
    above = points(1, 9)
    distance, normal, hessian = Rod().signed_distance(above)
    np.testing.assert_allclose(distance, above[0] - RADIUS, atol=1e-15)
    np.testing.assert_allclose(normal, np.array([1.0, 0.0])[:, None] * np.ones(200), atol=1e-12)
    assert (hessian == 0).all()


@pytest.mark.parametrize("radius", [0.0, -1e-3, float("nan"), float("inf")])
def test_a_radius_is_positive(radius):
    with pytest.raises(CaseError, match="radius"):
        Rod(radius=radius)


def test_the_end_is_a_sphere_on_the_axis_too():
    """Its curvature across x and y is one there; that across y was zero."""
    below = np.array([[0.0], [0.0], [-1e-4]])
    for mine, its in zip(Rod().signed_distance(below), Sphere(radius=RADIUS).signed_distance(below), strict=True):
        np.testing.assert_allclose(mine, its, rtol=1e-12, atol=1e-18)
