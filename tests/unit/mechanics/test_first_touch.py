"""Where a body that moves straight first touches points."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.annulus import Annulus
from tactsim.contact.sphere import Sphere
from tactsim.contact.tilted import Tilted
from tactsim.mechanics.contact.first_touch import first_touch

DOWN = np.array([0.0, 0.0, -1.0])


def test_a_sphere_beside_a_point_touches_it_where_pythagoras_says():
    body, away = Sphere(radius=5e-3), 3e-3
    points = np.array([[away], [0.0], [0.0]])
    place = first_touch(body, points, begin=-20e-3 * DOWN, direction=DOWN, size=10e-3)
    assert place is not None
    lowest = body.signed_distance(np.array([[0.0], [0.0], [0.0]]))[0][0]
    assert lowest == pytest.approx(0.0, abs=1e-15), "the reference point of a sphere is its lowest"
    assert place[2] == pytest.approx(-5e-3 + 4e-3, abs=1e-14)
    assert body.signed_distance(points - place[:, None])[0][0] == pytest.approx(0.0, abs=1e-16)


def test_a_leaning_annulus_touches_with_its_lower_edge_first():
    flat = np.array([[x, y, 0.0] for x in np.linspace(-8e-3, 8e-3, 161) for y in np.linspace(-8e-3, 8e-3, 161)]).T
    body = Tilted(body=Annulus(), tilt_y=0.1)
    place = first_touch(body, flat, begin=-30e-3 * DOWN, direction=DOWN, size=16e-3)
    assert place is not None
    assert 2e-3 * np.sin(0.1) < place[2] < 3e-3 * np.sin(0.1)
    gap = body.signed_distance(flat - place[:, None])[0]
    assert gap.min() == pytest.approx(0.0, abs=1e-16)
    assert flat[0, gap.argmin()] > 2e-3, "a positive tilt about y lowers the edge towards x"


def test_a_body_that_passes_beside_the_points_touches_nothing():
    points = np.array([[20e-3], [0.0], [0.0]])
    assert first_touch(Sphere(radius=5e-3), points, begin=-20e-3 * DOWN, direction=DOWN, size=10e-3) is None
