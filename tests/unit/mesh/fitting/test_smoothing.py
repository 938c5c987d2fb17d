"""Corners are moved until the worst tetrahedron is better, also where one begins flat or turned inside out."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.mesh.fitting import smoothing
from tactsim.mesh.fitting.smoothing import smoothed
from tactsim.mesh.quality import mean_ratio
from tactsim.mesh.structured_block import grid, product, twelfths

CELLS = grid((1, 1, 1))
CUBE = product([np.array([0.0, 1.0])] * 3)


def around(middle: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """A cube of twelve tetrahedra around a corner that may be anywhere."""
    simplices, corners = twelfths(CELLS, CUBE, np.arange(8))
    return np.vstack([corners[:8], [middle]]), simplices


def projectors(points: np.ndarray) -> np.ndarray:
    """Only the corner within the cube may move."""
    free = np.zeros((len(points), 3, 3))
    free[8] = np.eye(3)
    return free


@pytest.mark.parametrize("middle", [(0.5, 0.5, 1.0), (0.7, 0.4, 1.0), (0.4, 0.6, 1.05), (0.6, 0.3, 0.9)])
def test_a_flat_or_inverted_tetrahedron_is_mended(middle):
    corners, simplices = around(middle)
    better = smoothed(corners, simplices, projectors, lambda points: points)
    assert mean_ratio(better, simplices).min() > 0.4
    np.testing.assert_allclose(better[8], 0.5, atol=0.1)


def test_without_a_barrier_of_the_mean_a_flat_one_has_no_energy(monkeypatch):
    monkeypatch.setattr(smoothing, "LEAST_BARRIER", 0.0)
    corners, simplices = around((0.5, 0.5, 1.0))
    with pytest.raises(RuntimeWarning):
        smoothed(corners, simplices, projectors, lambda points: points)
