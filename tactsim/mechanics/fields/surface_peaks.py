"""Places on quadratic edges and triangles at which the height, the last coordinate, can be largest."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array

_EDGES = ((0, 1, 3), (1, 2, 4), (0, 2, 5))
_TINY = 1e-300


def surface_peaks(facets: Array) -> Array:
    """Points (n, 3) in m: the nodes of facets (F, 6, 3), and where the third coordinate is stationary on an edge or inside.

    The largest height of each facet is that of one of its points.
    """
    peaks = [facets.reshape(-1, 3)]
    for edge in _EDGES:
        peaks.append(edge_peaks(*(facets[:, k] for k in edge)))
    peaks.append(_inner(facets))
    return np.vstack(peaks)


def edge_peaks(first: Array, second: Array, middle: Array) -> Array:
    """Points (n, d) in m of edges, given their ends and mid-side nodes (n, d) in m, where the height is stationary, or an end."""
    slope, bend = 4 * middle - 3 * first - second, 2 * first + 2 * second - 4 * middle
    at = np.clip(_ratio(-slope[:, -1], 2 * bend[:, -1]), 0.0, 1.0)[:, None]
    return np.asarray(first + at * (slope + at * bend))


def _inner(facets: Array) -> Array:
    """Stationary points (n, 3) of the height inside facets."""
    a, b, c, ab, bc, ca = (facets[:, k] for k in range(6))
    s, t = 4 * ab - 3 * a - b, 4 * ca - 3 * a - c
    ss, tt, st = 2 * a + 2 * b - 4 * ab, 2 * a + 2 * c - 4 * ca, 4 * (a + bc - ab - ca)
    determinant = 4 * ss[:, 2] * tt[:, 2] - st[:, 2] ** 2
    x = _ratio(st[:, 2] * t[:, 2] - 2 * tt[:, 2] * s[:, 2], determinant)
    y = _ratio(st[:, 2] * s[:, 2] - 2 * ss[:, 2] * t[:, 2], determinant)
    inside = (x > 0) & (y > 0) & (x + y < 1)
    x, y = x[inside, None], y[inside, None]
    parts = (a, s, t, ss, tt, st)
    a, s, t, ss, tt, st = (part[inside] for part in parts)
    return a + x * s + y * t + x**2 * ss + y**2 * tt + x * y * st


def _ratio(numerator: Array, denominator: Array) -> Array:
    flat = np.abs(denominator) < _TINY
    return np.where(flat, 0.0, numerator / np.where(flat, 1.0, denominator))
