"""Flat tetrahedra are refused, but those that are only stretched along the axes may be ten times as flat."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import ConvergenceError
from tactsim.mesh.fitting.curving import LEAST_QUALITY, LEAST_STRETCHED, _check_shapes
from tactsim.mesh.quality import mean_ratio

REGULAR = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.9, 0.0], [0.5, 0.3, 0.8]])
ONE = np.array([[0, 1, 2, 3]])
TURN = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])


def thinned(share: float, *, turned: bool = False) -> np.ndarray:
    """The regular one, as thin along two axes as makes this mean ratio; turned out of the axes if asked."""
    thin = 1.0
    while mean_ratio(REGULAR * [1.0, thin, thin], ONE)[0] > share:
        thin *= 0.98
    corners = REGULAR * [1.0, thin, thin]
    return corners @ TURN.T if turned else corners


def test_what_is_stretched_along_the_axes_may_be_flatter() -> None:
    for share in (1.1 * LEAST_QUALITY, 1.1 * LEAST_STRETCHED):
        _check_shapes(thinned(share), ONE)
    with pytest.raises(ConvergenceError, match=f"allowed: {LEAST_STRETCHED}"):
        _check_shapes(thinned(0.9 * LEAST_STRETCHED), ONE)


def test_what_is_flat_otherwise_may_not() -> None:
    _check_shapes(thinned(1.1 * LEAST_QUALITY, turned=True), ONE)
    with pytest.raises(ConvergenceError, match=f"allowed: {LEAST_QUALITY}"):
        _check_shapes(thinned(0.9 * LEAST_QUALITY, turned=True), ONE)


def test_the_worst_of_many_is_the_one_that_is_told() -> None:
    corners = np.concatenate([thinned(1.1 * LEAST_STRETCHED), thinned(0.5 * LEAST_QUALITY, turned=True)])
    with pytest.raises(ConvergenceError, match=f"allowed: {LEAST_QUALITY}"):
        _check_shapes(corners, np.array([[0, 1, 2, 3], [4, 5, 6, 7]]))
