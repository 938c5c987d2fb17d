"""A straight-sided or curved mesh of quadratic triangles or tetrahedra as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError

FLAT = 1e-12
"""Determinant of an element's sides over a power of the longest below which it is flat: round-off of its coordinates."""
EDGES = {2: ((0, 1), (1, 2), (0, 2)), 3: ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))}
"""Corners at the ends of the edges of a triangle and of a tetrahedron, in the order of the nodes in the middle of these."""
FACETS = {
    2: ((0, 1, 3), (1, 2, 4), (2, 0, 5)),
    3: ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6)),
}
"""Nodes of the sides of a quadratic triangle and tetrahedron as seen from outside: corners, then the middles between them."""
MIRROR = {2: [0, 2, 1, 5, 4, 3], 3: [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]}
"""Order of the nodes with which an element that is inside out is put right."""


@dataclass(frozen=True)
class QuadraticMesh:
    """Nodes, elements and regions; corner nodes are numbered before mid-edge nodes.

    Attributes
    ----------
    nodes : (n, d) coordinates in m
    elements : (E, 6) triangles or (E, 10) tetrahedra by node number, in the order of VTK, positively oriented
    regions : (E,) region number of each element
    """

    nodes: Array
    elements: Array
    regions: Array

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return int(self.nodes.shape[1])

    @property
    def corner_count(self) -> int:
        """Number of corner nodes."""
        return int(self.elements[:, : self.dim + 1].max()) + 1

    def edges(self) -> tuple[Array, Array]:
        """Edges (m, 2) by their corners, ascending, and the node in the middle of each (m,)."""
        pairs = np.concatenate([np.sort(self.elements[:, list(edge)], axis=1) for edge in EDGES[self.dim]])
        _, first = np.unique(row_numbers(pairs), return_index=True)
        return pairs[first], self.elements[:, self.dim + 1 :].T.ravel()[first]

    def boundary_facets(self) -> tuple[Array, Array]:
        """Facets of one element only, outward oriented: node numbers (F, 3) edges or (F, 6) triangles, and their elements."""
        facets = np.concatenate([self.elements[:, list(facet)] for facet in FACETS[self.dim]])
        owner = np.tile(np.arange(len(self.elements)), len(FACETS[self.dim]))
        keys = np.sort(facets[:, : self.dim], axis=1)
        _, first, counts = np.unique(row_numbers(keys), return_index=True, return_counts=True)
        chosen = np.sort(first[counts == 1])
        return facets[chosen], owner[chosen]

    def moved(self, nodes: Array) -> QuadraticMesh:
        """The same mesh with other node coordinates (n, d) in m."""
        return QuadraticMesh(nodes, self.elements, self.regions)


def row_numbers(rows: Array) -> Array:
    """A number (n,) for each row (n, k) of whole numbers from zero on, in the order of the rows: numbers are sorted faster."""
    return np.ravel_multi_index(tuple(rows.T), (int(rows.max(initial=0)) + 1,) * rows.shape[1])


def quadratic_mesh(corners: Array, simplices: Array, regions: Array | None = None) -> QuadraticMesh:
    """Straight-sided quadratic mesh of simplices (E, d + 1) on corner coordinates (n, d); orientation is put right.

    Raises
    ------
    InputError
        If there is no element, one is flat, a coordinate is not finite or an index has no coordinates.
    """
    dim = corners.shape[1]
    if not len(simplices):
        raise InputError("the mesh has no elements")
    if simplices.min() < 0 or simplices.max() >= len(corners):
        raise InputError(f"element indices run from {simplices.min()} to {simplices.max()}; allowed: 0 to {len(corners) - 1}")
    if not np.isfinite(corners).all():
        raise InputError("the mesh has node coordinates that are not finite numbers")
    used, simplices = np.unique(simplices, return_inverse=True)
    corners, simplices = corners[used], simplices.reshape(-1, dim + 1)
    edges = np.concatenate([np.sort(simplices[:, list(edge)], axis=1) for edge in EDGES[dim]])
    _, first, number = np.unique(row_numbers(edges), return_index=True, return_inverse=True)
    middles = len(corners) + number.reshape(len(EDGES[dim]), -1).T
    elements = np.hstack([simplices, middles]).astype(np.int64)
    sides = corners[simplices[:, 1:]] - corners[simplices[:, :1]]
    volume = np.linalg.det(np.moveaxis(sides, 1, 2))
    flat = np.abs(volume) <= FLAT * np.linalg.norm(sides, axis=2).max(axis=1) ** dim
    if flat.any():
        raise InputError(f"element {int(np.flatnonzero(flat)[0])} of the mesh is flat")
    mirrored = volume < 0
    elements[mirrored] = elements[mirrored][:, MIRROR[dim]]
    nodes = np.vstack([corners, corners[edges[first]].mean(axis=1)])
    return QuadraticMesh(nodes, elements, np.zeros(len(elements), np.int64) if regions is None else np.asarray(regions))
