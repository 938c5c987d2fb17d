"""A body that comes from any side: its distance is that of the upright one, seen in its own axes."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.plane import Plane
from tactsim.contact.sphere import Sphere
from tactsim.contact.turned import Turned

AXES = [(0.0, 1.0), (1.0, 0.0), (-0.6, 0.8), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (2 / 3, -2 / 3, 1 / 3)]


@pytest.mark.parametrize("axis", AXES)
def test_the_axis_is_where_the_body_points_to(axis):
    turned = Turned.of(Plane(), axis)
    turn, away = turned.rotation, np.array(axis)
    np.testing.assert_allclose(turn @ np.eye(len(axis))[-1], away, atol=1e-15)
    np.testing.assert_allclose(turn @ turn.T, np.eye(len(axis)), atol=1e-15)
    assert np.linalg.det(turn) == pytest.approx(1.0, abs=1e-14)
    distance, normal, _ = turned.signed_distance(-2e-3 * away[:, None])
    assert distance == pytest.approx(2e-3)
    np.testing.assert_allclose(normal[:, 0], -away, atol=1e-15)


@pytest.mark.parametrize("axis", AXES)
def test_a_sphere_that_is_turned_keeps_its_curvature(axis):
    points = np.random.default_rng(5).normal(size=(len(axis), 50)) * 1e-3
    turned = Turned.of(Sphere(radius=2e-3), axis)
    step = 1e-9
    for k in range(len(axis)):
        shift = np.zeros((len(axis), 1))
        shift[k] = step
        above, below = turned.signed_distance(points + shift), turned.signed_distance(points - shift)
        now = turned.signed_distance(points)
        np.testing.assert_allclose((above[0] - below[0]) / (2 * step), now[1][k], atol=1e-6)
        np.testing.assert_allclose((above[1] - below[1]) / (2 * step), now[2][:, k], atol=1e-2)


def test_an_axis_that_is_no_unit_vector_is_refused():
    with pytest.raises(ValueError, match="unit vector"):
        Turned.of(Plane(), (1.0, 1.0))
