"""Whether a rigid body is its own mirror image, as a model of a part of the tissue takes it to be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tactsim.array import Array

SAMPLES = 400
"""Points at which distances are compared: two shapes that agree at so many are one."""
SAME_PLACE = 1e-6
"""Difference of two distances over the size looked at that counts as none: far below any element."""


def body_mirrors(distance: Callable[[Array], Array], axis: int, size: float, dim: int = 3) -> bool:
    """Whether the plane through the origin and normal to an axis mirrors a body, within ``size`` in m of the origin.

    ``distance`` gives the signed distance (n,) in m of the body from points (dim, n) in m.
    """
    points = np.random.default_rng(0).uniform(-size, size, (dim, SAMPLES))
    mirrored = points.copy()
    mirrored[axis] *= -1.0
    return bool(np.abs(distance(points) - distance(mirrored)).max() <= SAME_PLACE * size)
