"""Whether friction can hold a block between faces of jaws that lean towards each other."""

from __future__ import annotations

import math

import numpy as np

from tactsim.contact.jaw import Jaw
from tactsim.contact.traction import PROBED
from tactsim.interfaces import ContactLaw
from tactsim.units import format_quantity

ROUNDING = 1e-9
"""Angle in rad between two faces that is none."""


def sliding_out(upper: Jaw, lower: Jaw, law: ContactLaw) -> str | None:
    """In words that no friction of this law holds a block between the flat faces of two jaws; None if it may.

    The block is in equilibrium under the two forces of the jaws only if these lie on one line. Each leans from the normal of its
    face by the angle of friction at most, so that the normals may lean by twice that angle from each other.
    """
    normals = upper.rotation[:, 2], lower.rotation[:, 2]
    angle = math.atan2(float(np.linalg.norm(np.cross(*normals))), -float(np.dot(*normals)))
    pressures = np.array(PROBED)
    most = 2 * math.atan(float((law.traction_limit(pressures) / pressures).max()))
    if angle <= most + ROUNDING:
        return None
    leaning, held = (format_quantity(value, "rad") for value in (angle, most))
    return (
        f"the faces of the jaws lean by {leaning} towards each other, and friction holds a block up to {held}, so that it slides "
        "out; allowed: up to that, which is twice the angle of friction"
    )
