"""Evenly spread points on a sphere."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array


def sphere_points(count: int, lowest: float = -1.0) -> Array:
    """Points (count, 3) of the unit sphere above the height ``lowest``, in [-1, 1), along a spiral from the top.

    Source: Gonzalez 2010, Mathematical Geosciences 42, 49-64, doi:10.1007/s11004-009-9257-x (Fibonacci lattice).
    """
    step = np.arange(count) + 0.5
    height, angle = 1 - (1 - lowest) * step / count, np.pi * (1 + np.sqrt(5)) * step
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
