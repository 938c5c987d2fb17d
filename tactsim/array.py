"""The type of an array, and the choice of a few of its many entries."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
"""An array of numpy; docstrings say shape and unit."""


def evenly_spaced(count: int, most: int) -> Array:
    """Numbers (n,) of at most ``most`` of ``count`` entries, counted from 0: evenly spaced, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).round().astype(int))
