"""Pieces of the surfaces of solids."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import Patch


def plane_patch(axis: int, value: float) -> Patch:
    """The plane where a coordinate has a value in m."""
    normal = np.eye(3)[axis]

    def project(points: Array) -> tuple[Array, Array]:
        nearest = np.array(points, float)
        nearest[:, axis] = value
        return nearest, np.broadcast_to(normal, nearest.shape)

    return project


def unit_vectors(vectors: Array) -> Array:
    """Vectors (..., 3) of length 1 in the directions of others; zero where those are zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def outward(vertices: Array, triangles: Array, centre: Array) -> Array:
    """Triangles (m, 3) of a surface that is star-shaped about ``centre``, turned outward."""
    a, b, c = (vertices[triangles[:, k]] - centre for k in range(3))
    inward = np.einsum("fi,fi->f", np.cross(b - a, c - a), a) < 0
    turned = triangles.copy()
    turned[inward] = turned[inward][:, [0, 2, 1]]
    return turned
