"""How well tetrahedra are shaped, straight and curved."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np

from tactsim.array import Array
from tactsim.mesh.quadratic import EDGES, QuadraticMesh

TO_REGULAR = np.linalg.inv(np.array([[1.0, 0.5, 0.5], [0.0, np.sqrt(3) / 2, np.sqrt(3) / 6], [0.0, 0.0, np.sqrt(2 / 3)]]))


def regular_map(corners: Array, simplices: Array) -> Array:
    """Gradient (E, 3, 3) of the map from a regular tetrahedron of unit edge to each tetrahedron (E, 4)."""
    sides = corners[simplices[:, 1:]] - corners[simplices[:, :1]]
    return np.swapaxes(sides, 1, 2) @ TO_REGULAR


def mean_ratio(corners: Array, simplices: Array) -> Array:
    r"""Mean ratio :math:`3 \det(T)^{2/3} / |T|^2` of tetrahedra (E, 4): 1 if regular, 0 if flat, negative if inverted.

    Source: Liu & Joe 1994, BIT 34, 268-287, doi:10.1007/BF01955874.
    """
    map_ = regular_map(corners, simplices)
    determinant = np.linalg.det(map_)
    return 3 * np.sign(determinant) * np.abs(determinant) ** (2 / 3) / (map_**2).sum(axis=(1, 2))


def unstretched_ratio(corners: Array, simplices: Array) -> Array:
    """Mean ratio of tetrahedra (E, 4) in coordinates in which each is as long along every axis."""
    own = corners[simplices]
    length = np.ptp(own, axis=1)
    apart = own / np.where(length > 0, length, 1.0)[:, None]
    return mean_ratio(apart.reshape(-1, 3), np.arange(4 * len(own)).reshape(-1, 4))


def shape_gradients(barycentric: Array) -> Array:
    """Gradients (Q, 10, 3) of the quadratic functions on the reference tetrahedron at barycentric coordinates (Q, 4)."""
    slope = np.vstack([-np.ones(3), np.eye(3)])
    corner = (4 * barycentric - 1)[:, :, None] * slope
    pairs = [4 * (barycentric[:, [a]] * slope[b] + barycentric[:, [b]] * slope[a]) for a, b in EDGES[3]]
    return np.concatenate([corner, np.stack(pairs, axis=1)], axis=1)


def determinants(nodes: Array, elements: Array, barycentric: Array) -> Array:
    """Jacobians (E, Q) of quadratic tetrahedra (E, 10) at barycentric coordinates (Q, 4)."""
    slopes = np.moveaxis(shape_gradients(barycentric), -1, 0)
    places = np.ascontiguousarray(nodes[elements].T)
    (xa, xb, xc), (ya, yb, yc), (za, zb, zc) = slopes @ places[:, None]  # (Q, E) each: of coordinate x along direction a
    return (xa * (yb * zc - yc * zb) + xb * (yc * za - ya * zc) + xc * (ya * zb - yb * za)).T


@cache
def checked_points() -> Array:
    """Corners, middles of edges and of faces, and quadrature points of a tetrahedron, as barycentric coordinates (Q, 4)."""
    corners = np.eye(4)
    middles = np.array([(corners[a] + corners[b]) / 2 for a, b in EDGES[3]])
    faces = np.array([corners[list(face)].mean(axis=0) for face in itertools.combinations(range(4), 3)])
    return np.vstack([corners, middles, faces, _quadrature(2)[0]])


def _quadrature(order: int) -> tuple[Array, Array]:
    from skfem import ElementTetP2
    from skfem.quadrature import get_quadrature

    points, weights = get_quadrature(ElementTetP2(), order)
    return np.vstack([1 - points.sum(axis=0), points]).T, weights


def jacobian_ratio(nodes: Array, elements: Array) -> Array:
    """Least over greatest Jacobian of each quadratic tetrahedron (E, 10): 1 if straight, below 0 if inverted somewhere."""
    values = determinants(nodes, elements, checked_points())
    return values.min(axis=1) / np.abs(values).max(axis=1)


def region_volumes(mesh: QuadraticMesh, count: int) -> Array:
    """Volumes (count,) in m^3 of the regions, exact for the curved elements (the Jacobian is cubic)."""
    points, weights = _quadrature(3)
    return np.bincount(mesh.regions, determinants(mesh.nodes, mesh.elements, points) @ weights, minlength=count)
