"""Where a rigid body that moves straight on first touches a surface."""

from __future__ import annotations

from collections.abc import Callable

from tactsim.array import Array
from tactsim.interfaces import RigidBody

FAR = 2.0
"""Distance from which a rigid body approaches, over the size of what it is to touch."""
TOUCH = 1e-15
"""Gap at touch over the size of what is touched: round-off."""
MISSED = 100.0
"""Distance over that size after which a body has passed."""
MOST_APPROACHES = 1000
"""Steps of the approach; each is as long as the gap, which shrinks fast unless the body misses the surface."""


def first_touch(body: RigidBody, points: Array, *, begin: Array, direction: Array, size: float) -> Array | None:
    """Place (d,) in m of a body's reference point at which it first touches points (d, n); None if it passes beside them.

    It moves from ``begin`` (d,) in m, clear of the points and not far from them, along the unit vector ``direction``; ``size`` in
    m is that of the touched body.
    """

    def gap_after(distance: float) -> float:
        return float(body.signed_distance(points - (begin + distance * direction)[:, None])[0].min())

    distance, touches = distance_to_touch(gap_after, size)
    return begin + distance * direction if touches else None


def distance_to_touch(gap_after: Callable[[float], float], size: float, most: int = MOST_APPROACHES) -> tuple[float, bool]:
    """How far in m something moves straight on until it touches, and whether it does within ``most`` steps.

    ``gap_after`` gives the least gap in m after a distance in m, which is the length of the next step (sphere tracing: Hart 1996,
    doi:10.1007/s003710050084); ``size`` in m is that of what is touched.
    """
    distance = 0.0
    for _ in range(most):
        gap = gap_after(distance)
        if gap <= TOUCH * size:
            return distance, True
        distance += gap
        if distance > MISSED * size:
            break
    return distance, False
