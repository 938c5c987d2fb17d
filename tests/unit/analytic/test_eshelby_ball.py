"""The field around a ball in strained tissue against what defines it: equilibrium, bonding, and the strain inside."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.eshelby_ball import displacement_by_ball, eshelby_contrast

RADIUS = 2e-3
STRAIN = np.array([[0.02, 0.013, -0.004], [0.013, 0.01, 0.006], [-0.004, 0.006, -0.03]])
RATIOS = (0.0, 0.3, 4.0, 1e9)
STEP, FINE = 1e-2 * RADIUS, 1e-6 * RADIUS
"""In m, of central differences: for second derivatives, with an error of 1e-4 and round-off of 1e-12, and for first ones."""


def directions(count: int = 40) -> np.ndarray:
    """Unit vectors (n, 3) at random."""
    vectors = np.random.default_rng(1).standard_normal((count, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def displacement(places: np.ndarray, ratio: float) -> np.ndarray:
    """Of tissue or ball (n, 3) in m, the uniform strain included."""
    return places @ STRAIN + displacement_by_ball(places, RADIUS, STRAIN, ratio)


def gradient(places: np.ndarray, ratio: float) -> np.ndarray:
    """Of the displacement (n, 3, 3), its derivative last."""
    steps = FINE * np.eye(3)
    return np.stack(
        [(displacement(places + step, ratio) - displacement(places - step, ratio)) / (2 * FINE) for step in steps], axis=2
    )


def pressure(places: np.ndarray, ratio: float) -> np.ndarray:
    """Pressure (n,) in the tissue over its shear modulus, zero far away: what the Laplacian of the field is the gradient of."""
    distance = np.linalg.norm(places, axis=1)
    along = (places * (places @ STRAIN)).sum(axis=1)
    return -2 * float(eshelby_contrast(np.array(ratio))) * RADIUS**3 * along / distance**5


@pytest.mark.parametrize("ratio", RATIOS)
def test_the_tissue_is_in_equilibrium_and_keeps_its_volume(ratio: float) -> None:
    places = directions() * np.linspace(1.1, 4.0, 40)[:, None] * RADIUS
    at = gradient(places, ratio)
    size = np.abs(at).max()
    assert np.trace(at, axis1=1, axis2=2) == pytest.approx(np.zeros(40), abs=1e-7 * size)
    steps = STEP * np.eye(3)
    around = sum(displacement(places + step, ratio) + displacement(places - step, ratio) for step in steps)
    laplacian = (around - 6 * displacement(places, ratio)) / STEP**2
    slope = np.stack([(pressure(places + s, ratio) - pressure(places - s, ratio)) / (2 * STEP) for s in steps], axis=1)
    assert laplacian == pytest.approx(slope, abs=2e-3 * np.abs(slope).max())


@pytest.mark.parametrize("ratio", RATIOS)
def test_the_ball_is_bonded_and_the_traction_is_the_same_on_both_sides(ratio: float) -> None:
    normals = directions()
    surface = RADIUS * normals
    just_outside = displacement(surface * (1 + 1e-9), ratio)
    assert just_outside == pytest.approx(displacement(surface * (1 - 1e-9), ratio), abs=1e-8 * RADIUS)
    if ratio > 1e6:
        assert displacement(0.7 * surface, ratio) == pytest.approx(np.zeros((40, 3)), abs=1e-6 * RADIUS * np.abs(STRAIN).max())
        return
    outside, inside = gradient(surface * (1 + 2 * FINE / RADIUS), ratio), gradient(surface * 0.5, ratio)
    tissue = np.einsum("nij,nj->ni", outside + outside.transpose(0, 2, 1), normals) - pressure(surface, ratio)[:, None] * normals
    ball = ratio * np.einsum("nij,nj->ni", inside + inside.transpose(0, 2, 1), normals)
    jump = tissue - ball
    jump -= (jump * normals).sum(axis=1).mean() * normals  # the ball's own pressure, which is uniform
    assert jump == pytest.approx(np.zeros((40, 3)), abs=1e-4 * np.abs(STRAIN).max()), (
        "2e-6 of the radius off the surface, from where the strain grows by some 20 times its size for each radius"
    )


@pytest.mark.parametrize(("ratio", "share"), [(0.0, 5 / 3), (1.0, 1.0), (6.0, 1 / 3), (1e12, 0.0)])
def test_the_strain_inside_is_uniform_and_that_of_eshelby(ratio: float, share: float) -> None:
    places = directions() * np.linspace(0.0, 0.9, 40)[:, None] * RADIUS
    assert displacement(places, ratio) == pytest.approx(share * places @ STRAIN, abs=1e-11 * RADIUS)


def test_far_away_nothing_is_left_of_the_ball() -> None:
    far = 100 * RADIUS * directions()
    assert np.abs(displacement_by_ball(far, RADIUS, STRAIN, 50.0)).max() < 3e-4 * np.abs(far @ STRAIN).max() / 100
