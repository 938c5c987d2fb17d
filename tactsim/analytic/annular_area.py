"""Area of an annulus."""

from __future__ import annotations

import math


def annular_area(inner_radius: float, outer_radius: float) -> float:
    """Area in m^2 between two circles of radii in m."""
    return math.pi * (outer_radius**2 - inner_radius**2)
