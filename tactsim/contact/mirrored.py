"""Whether a rigid body is its own mirror image, as a model of a part of the tissue takes it to be."""

from __future__ import annotations

import numpy as np

from tactsim.interfaces import RigidBody

SAMPLES = 400
"""Points at which distances are compared: two shapes that agree at so many are one."""
SAME_PLACE = 1e-6
"""Difference of two distances over the size looked at that counts as none: far below any element."""


def body_mirrors(body: RigidBody, axis: int, size: float) -> bool:
    """Whether the plane normal to an axis through the reference point mirrors a body in space, within ``size`` in m of it."""
    points = np.random.default_rng(0).uniform(-size, size, (3, SAMPLES))
    mirrored = points.copy()
    mirrored[axis] *= -1.0
    here, there = (body.signed_distance(places)[0] for places in (points, mirrored))
    return bool(np.abs(here - there).max() <= SAME_PLACE * size)
