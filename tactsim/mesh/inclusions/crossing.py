"""Whether triangles of one surface cross each other."""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array

MOST_PAIRS = 3_000_000
"""Pairs of near triangles that are tested at most; a surface of very uneven triangles is tested only in part."""


def crossing_pair(vertices: Array, triangles: Array) -> tuple[int, int] | None:
    """Numbers of two triangles (m, 3) without a common vertex of which an edge of one pierces the other; None if none do."""
    corners = vertices[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    pairs = _near_pairs(corners)
    overlap = ((low[pairs[:, 0]] <= high[pairs[:, 1]]) & (low[pairs[:, 1]] <= high[pairs[:, 0]])).all(axis=1)
    pairs = pairs[overlap]
    apart = (triangles[pairs[:, 0]][:, :, None] != triangles[pairs[:, 1]][:, None, :]).all(axis=(1, 2))
    pairs = pairs[apart]
    for first, second in (pairs.T, pairs.T[::-1]):
        for k in range(3):
            hit = _pierces(corners[first, k], corners[first, (k + 1) % 3], corners[second])
            if hit.any():
                found = int(np.flatnonzero(hit)[0])
                return int(first[found]), int(second[found])
    return None


def _near_pairs(corners: Array) -> Array:
    """Pairs (p, 2) of triangles whose bounding spheres meet, largest triangles first."""
    centres = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    tree, found, total = scipy.spatial.cKDTree(centres), [np.zeros((0, 2), np.int64)], 0
    order = np.argsort(-radius)
    for start in range(0, len(order), 2000):
        chunk = order[start : start + 2000]
        neighbours = tree.query_ball_point(centres[chunk], radius[chunk] + radius[chunk[0]])
        first = np.repeat(chunk, [len(n) for n in neighbours])
        second = np.concatenate([np.asarray(n, np.int64) for n in neighbours])
        smaller = (radius[second] < radius[first]) | ((radius[second] == radius[first]) & (second < first))
        meeting = np.linalg.norm(centres[first] - centres[second], axis=1) <= radius[first] + radius[second]
        found.append(np.stack([first, second], axis=1)[smaller & meeting])
        total += len(found[-1])
        if total > MOST_PAIRS:
            break
    return np.concatenate(found)


def _pierces(start: Array, end: Array, triangles: Array) -> Array:
    """Whether segments between points (n, 3) pierce the inside of triangles (n, 3, 3).

    Source: Moeller & Trumbore 1997, Journal of Graphics Tools 2, 21-28, doi:10.1080/10867651.1997.10487468.
    """
    a, along = triangles[:, 0], end - start
    ab, ac = triangles[:, 1] - a, triangles[:, 2] - a
    across = np.cross(along, ac)
    determinant = (ab * across).sum(axis=1)
    scale = np.linalg.norm(along, axis=1) * np.linalg.norm(ab, axis=1) * np.linalg.norm(ac, axis=1)
    steep = np.abs(determinant) > 1e-12 * scale
    inverse = 1 / np.where(steep, determinant, 1.0)
    offset = start - a
    u = (offset * across).sum(axis=1) * inverse
    turned = np.cross(offset, ab)
    v = (along * turned).sum(axis=1) * inverse
    t = (ac * turned).sum(axis=1) * inverse
    margin = 1e-9
    return steep & (u > margin) & (v > margin) & (u + v < 1 - margin) & (t > margin) & (t < 1 - margin)
