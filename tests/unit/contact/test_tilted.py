"""A tilted annulus: its distance against brute force over points of its surface, its rotation, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact.annulus import Annulus
from tactsim.contact.tilted import Tilted
from tactsim.errors import CaseError

RING = Annulus(height=5e-3)
LEANING = Tilted(body=RING, tilt_x=0.1, tilt_y=-0.2)
SPACING = 2e-5


def profile(ring, spacing):
    """Points (n, 2) around the filleted rectangle of the section, at most ``spacing`` apart."""
    radius, low, high = ring.fillet, np.array([ring.inner_radius, 0.0]), np.array([ring.outer_radius, ring.height])
    outline = []
    for k, (r, z) in enumerate([(high[0], low[1]), (high[0], high[1]), (low[0], high[1]), (low[0], low[1])]):
        centre = np.clip([r, z], low + radius, high - radius)
        angle = np.linspace(-np.pi / 2, 0, int(radius * np.pi / 2 / spacing) + 2) + k * np.pi / 2
        outline.append(centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    corners = np.vstack(outline)
    after = np.roll(corners, -1, axis=0)
    return np.vstack(
        [
            a + np.linspace(0, 1, int(np.linalg.norm(b - a) / spacing) + 2)[:-1, None] * (b - a)
            for a, b in zip(corners, after, strict=True)
        ]
    )


def axis_of(body):
    """Unit vector of the leaning axis, by turning z about x and then about y."""
    about_x = np.array([0.0, -np.sin(body.tilt_x), np.cos(body.tilt_x)])
    c, s = np.cos(body.tilt_y), np.sin(body.tilt_y)
    return np.array([c * about_x[0] + s * about_x[2], about_x[1], -s * about_x[0] + c * about_x[2]])


def brute_distance(body, points):
    """Unsigned distance (n,) in m: in the half-plane through the leaning axis and each point, to the nearest profile point."""
    axis = axis_of(body)
    along = axis @ points
    away = np.linalg.norm(points - along * axis[:, None], axis=0)
    outline = profile(body.body, SPACING)
    return np.hypot(away[:, None] - outline[:, 0], along[:, None] - outline[:, 1]).min(axis=1)


def test_distance_is_that_of_brute_force():
    points = np.random.default_rng(4).uniform(-5e-3, 5e-3, (3, 300))
    distance = LEANING.signed_distance(points)[0]
    expected = brute_distance(LEANING, points)
    bound = SPACING**2 / (8 * np.maximum(expected, SPACING))  # a point half a spacing away along a straight side
    assert (np.abs(np.abs(distance) - expected) <= bound + SPACING / 20).all()
    upright = Tilted(body=RING).signed_distance(points)[0]
    assert not (np.abs(np.abs(upright) - expected) <= 3 * (bound + SPACING / 20)).all()


def test_points_inside_are_negative():
    middle = (RING.inner_radius + RING.outer_radius) / 2
    inside = LEANING.rotation @ np.array([middle, 0.0, 0.5e-3])
    assert LEANING.signed_distance(inside[:, None])[0][0] == pytest.approx(-0.5e-3, rel=1e-12)


def test_rotation_leans_the_axis_and_lowers_the_edge_on_its_side():
    leaning = Tilted(body=RING, tilt_y=0.1)
    np.testing.assert_allclose(leaning.rotation[:, 2], [np.sin(0.1), 0.0, np.cos(0.1)], atol=1e-15)
    edge = leaning.rotation @ np.array([RING.outer_radius, 0.0, 0.0])
    assert edge[2] == pytest.approx(-RING.outer_radius * np.sin(0.1))
    np.testing.assert_allclose(LEANING.rotation @ LEANING.rotation.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(LEANING.rotation[:, 2], axis_of(LEANING), atol=1e-15)


def test_own_coordinates_undo_the_rotation():
    points = np.random.default_rng(5).normal(size=(3, 7))
    np.testing.assert_allclose(LEANING.own_coordinates(LEANING.rotation @ points), points, atol=1e-14)


@pytest.mark.parametrize("tilt", ["40 deg", "-0.6 rad", "1 mm"])
def test_large_tilts_and_other_units_are_refused(tilt):
    with pytest.raises(CaseError):
        Tilted(body=RING, tilt_x=tilt)
