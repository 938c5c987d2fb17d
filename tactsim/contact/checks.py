"""Whether a rigid body and a contact law return what is asked of them: shapes, and normals along which the distance grows."""

from __future__ import annotations

from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import ContactLaw, RigidBody

STEP = 1e-6
"""Along the normal, over the extent of the points: the distance of an exact body grows by as much."""
PRESSURES = np.array([0.0, 1e3, 1e5])
"""In Pa."""


def checked_normals(body: RigidBody, points: Array) -> Array:
    """Normals (d, n) of a body at points (d, n) in m.

    Refuses one whose signed distance there has other shapes, or falls along its normal at most of them.

    Raises
    ------
    InvalidQuantity
        Naming the class and what is wrong.
    """
    name, shape = f"signed_distance of {type(body).__name__}", points.shape
    returned: Any = body.signed_distance(points)
    needed = ((shape[1],), shape, (shape[0], *shape))
    shapes = tuple(map(np.shape, returned)) if isinstance(returned, tuple) else type(returned).__name__
    if shapes != needed:
        words = f"distance, normal and Hessian of the shapes {needed[0]}, {needed[1]} and {needed[2]}"
        raise InvalidQuantity(f"{name} must return {words} at points {shape}; it returned {shapes}")
    distance, normal, _ = returned
    step = STEP * float(np.ptp(points, axis=1).max())
    farther = body.signed_distance(points + step * normal)[0]
    if np.median(farther - distance) < step / 2:
        raise InvalidQuantity(f"{name} does not grow along its normal, which must be the unit vector out of the body")
    return np.asarray(normal)


def check_law(law: ContactLaw) -> None:
    """Refuse a law whose limit of the tangential traction, or its slope, is no array of the pressures' shape, or is negative.

    Raises
    ------
    InvalidQuantity
        Naming the class and what is wrong.
    """
    for method in ("traction_limit", "traction_limit_slope"):
        returned = getattr(law, method)(PRESSURES)
        name = f"{method} of {type(law).__name__}"
        if np.shape(returned) not in ((), PRESSURES.shape) or np.asarray(returned).dtype.kind not in "fiub":
            raise InvalidQuantity(f"{name} must return numbers of the shape of the pressures; it returned {returned!r:.60}")
        if not (np.asarray(returned) >= 0).all():
            raise InvalidQuantity(f"{name} is negative or no number under pressures of 0 to 100 kPa: {returned!r:.60}")
