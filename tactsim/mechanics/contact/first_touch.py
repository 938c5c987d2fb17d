"""Where a rigid body that moves straight on first touches a surface."""

from __future__ import annotations

from tactsim.array import Array
from tactsim.interfaces import RigidBody

TOUCH = 1e-15
"""Gap at touch over the size of what is touched."""
MISSED = 100.0
"""Distance over that size after which a body has passed."""
MOST_APPROACHES = 1000
"""Steps of the approach; each is as long as the gap, which shrinks fast unless the body misses the surface."""


def first_touch(body: RigidBody, points: Array, *, begin: Array, direction: Array, size: float) -> Array | None:
    """Place (d,) in m of a body's reference point at which it first touches points (d, n); None if it passes beside them.

    It moves from ``begin`` (d,) in m, clear of the points and not far from them, along the unit vector ``direction``; ``size`` in
    m is that of the touched body.
    """
    distance = 0.0
    for _ in range(MOST_APPROACHES):
        place = begin + distance * direction
        gap = float(body.signed_distance(points - place[:, None])[0].min())
        if gap <= TOUCH * size:
            return place
        distance += gap
        if distance > MISSED * size:
            break
    return None
