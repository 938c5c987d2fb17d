"""A body bounded by triangles: nearest points, inside test and the checks that make these well defined."""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.solid import Solid, Triangles
from tactsim.mesh.inclusions.crossing import crossing_pair
from tactsim.mesh.quadratic import row_numbers
from tactsim.mesh.solid import unit_vectors

FIRST_CANDIDATES = 12
CHUNK = 20_000
"""Points whose nearest triangles are searched at a time, which bounds the memory."""


class TriangulatedSolid(Solid):
    """The inside of a closed surface of triangles; pseudonormals at the nearest point decide the sign of the distance.

    Raises
    ------
    InputError
        If the surface is open, in several pieces, not consistently oriented, empty inside or crosses itself.

    Source of the inside test: Baerentzen & Aanaes 2005, IEEE TVCG 11, 243-253, doi:10.1109/TVCG.2005.49.
    """

    def __init__(self, vertices: Array, triangles: Array, name: str):
        check_closed(triangles, len(vertices), name)
        corners = vertices[triangles]
        content = float(np.einsum("fi,fi->", np.cross(corners[:, 0], corners[:, 1]), corners[:, 2]) / 6)
        extent = np.ptp(vertices, axis=0)
        if abs(content) < 1e-6 * extent.max() ** 3:
            raise InputError(f"{name}: the surface encloses no volume")
        self.vertices, self.faces = vertices, triangles if content > 0 else triangles[:, [0, 2, 1]]
        pair = crossing_pair(vertices, self.faces)
        if pair is not None:
            raise InputError(f"{name}: the surface crosses itself at triangles {pair[0]} and {pair[1]}")
        self._volume = abs(content)
        self._prepare()
        self.patches = (self.project,)

    def _prepare(self) -> None:
        corners = self.vertices[self.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self._normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        self._centres = corners.mean(axis=1)
        self._reach = float(np.linalg.norm(corners - self._centres[:, None], axis=2).max())
        self._tree = scipy.spatial.cKDTree(self._centres)
        self._at_vertex = _vertex_normals(corners, self._normals, self.faces, len(self.vertices))
        self._at_edge = _edge_normals(self._normals, self.faces)

    def project(self, points: Array) -> tuple[Array, Array]:
        """Nearest points and pseudonormals there, both (n, 3)."""
        parts = [self._project(points[k : k + CHUNK]) for k in range(0, max(len(points), 1), CHUNK)]
        return np.vstack([near for near, _ in parts]), np.vstack([normal for _, normal in parts])

    def _project(self, points: Array) -> tuple[Array, Array]:
        near, face, weights = np.empty_like(points), np.zeros(len(points), np.int64), np.empty_like(points)
        waiting, count = np.arange(len(points)), FIRST_CANDIDATES
        while len(waiting):
            count = min(count, len(self.faces))
            reach, candidates = self._tree.query(points[waiting], k=np.arange(1, count + 1))
            nearest, which, distance, bary = _nearest(points[waiting], self.vertices[self.faces[candidates]])
            near[waiting], weights[waiting] = nearest, bary
            face[waiting] = candidates[np.arange(len(waiting)), which]
            decided = (reach[:, -1] - self._reach >= distance) | (count == len(self.faces))
            waiting, count = waiting[~decided], 4 * count
        return near, self._pseudonormals(face, weights)

    def _pseudonormals(self, face: Array, weights: Array) -> Array:
        """Normal of the face, edge or vertex on which barycentric weights (n, 3) put a point."""
        zero = weights < 1e-9
        normals = self._normals[face].copy()
        for k in range(3):
            on_edge = zero[:, k] & (zero.sum(axis=1) == 1)
            normals[on_edge] = self._at_edge[face[on_edge], k]
            at = ~zero[:, k] & (zero.sum(axis=1) == 2)
            normals[at] = self._at_vertex[self.faces[face[at], k]]
        return normals

    def signed_distance(self, points: Array) -> Array:
        """Distance (n,) in m of points (n, 3), negative inside."""
        near, normal = self.project(points)
        offset = points - near
        return np.copysign(np.linalg.norm(offset, axis=1), (offset * normal).sum(axis=1))

    def triangles(self, edge: float) -> Triangles:
        """The triangles as they are; the mesher divides them."""
        return self.vertices, self.faces

    def volume(self) -> float:
        """Volume in m^3, by the divergence theorem."""
        return self._volume

    def centroid(self) -> Array:
        """Centre (3,) of its volume in m: of tetrahedra between a vertex and the triangles, those seen from behind negative."""
        origin = self.vertices[0]
        corners = self.vertices[self.faces] - origin
        volumes = np.linalg.det(corners) / 6
        return np.asarray(origin + volumes @ corners.sum(axis=1) / 4 / self._volume)

    def bounds(self) -> Array:
        """Lowest and highest coordinates (2, 3) in m."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])


def check_closed(triangles: Array, count: int, name: str) -> None:
    """Refuse triangles (m, 3) on ``count`` vertices that do not bound one body.

    Raises
    ------
    InputError
        Naming the surface and whether it is open, inconsistently oriented or in several pieces.
    """
    if len(triangles) < 4:
        raise InputError(f"{name}: {len(triangles)} triangles cannot bound a body")
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, uses = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    if (uses != 2).any():
        raise InputError(
            f"{name}: the surface is not closed: {int((uses == 1).sum())} edges belong to one triangle and "
            f"{int((uses > 2).sum())} to more than two; allowed: every edge to exactly two"
        )
    _, directed = np.unique(edges, axis=0, return_counts=True)
    if (directed != 1).any():
        raise InputError(f"{name}: {int((directed > 1).sum())} edges join triangles of opposite orientation")
    used = np.unique(triangles)
    graph = scipy.sparse.csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    pieces = len(np.unique(scipy.sparse.csgraph.connected_components(graph, directed=False)[1][used]))
    if pieces > 1:
        raise InputError(f"{name}: the surface has {pieces} pieces; allowed: one")


def _nearest(points: Array, corners: Array) -> tuple[Array, Array, Array, Array]:
    """Nearest point (n, 3) on the nearest of candidate triangles (n, k, 3, 3), its number, distance and barycentric weights."""
    weights = nearest_weights(points[:, None], corners)
    near = np.einsum("nkc,nkci->nki", weights, corners)
    distance = np.linalg.norm(near - points[:, None], axis=2)
    which = distance.argmin(axis=1)
    rows = np.arange(len(points))
    return near[rows, which], which, distance[rows, which], weights[rows, which]


def nearest_weights(points: Array, corners: Array) -> Array:
    """Barycentric weights (..., 3) of the point of each triangle (..., 3, 3) that is nearest to points (..., 3)."""
    a, b, c = (corners[..., k, :] for k in range(3))
    ab, ac, ap = b - a, c - a, points - a
    d00, d01, d11 = (ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1)
    d20, d21 = (ap * ab).sum(-1), (ap * ac).sum(-1)
    determinant = np.maximum(d00 * d11 - d01**2, 1e-300)
    v, w = (d11 * d20 - d01 * d21) / determinant, (d00 * d21 - d01 * d20) / determinant
    best = np.stack([1 - v - w, v, w], axis=-1)
    nearest = np.where((best >= 0).all(axis=-1), 0.0, np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        start, side = corners[..., i, :], corners[..., j, :] - corners[..., i, :]
        share = np.clip(((points - start) * side).sum(-1) / np.maximum((side * side).sum(-1), 1e-300), 0.0, 1.0)
        distance = np.linalg.norm(start + share[..., None] * side - points, axis=-1)
        on_edge = np.zeros(best.shape)
        on_edge[..., i], on_edge[..., j] = 1 - share, share
        closer = distance < nearest
        best, nearest = np.where(closer[..., None], on_edge, best), np.where(closer, distance, nearest)
    return best


def _vertex_normals(corners: Array, normals: Array, faces: Array, count: int) -> Array:
    """Sum of the normals of the faces at each vertex, weighted by their angles there; unit vectors (count, 3)."""
    total = np.zeros((count, 3))
    for k in range(3):
        a = corners[:, (k + 1) % 3] - corners[:, k]
        b = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
        np.add.at(total, faces[:, k], angle[:, None] * normals)
    return unit_vectors(total)


def _edge_normals(normals: Array, faces: Array) -> Array:
    """Mean of the normals of the two faces at the edge opposite to each corner (m, 3, 3)."""
    edges = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2)
    _, number = np.unique(row_numbers(edges.reshape(-1, 2)), return_inverse=True)
    total = np.zeros((number.max() + 1, 3))
    np.add.at(total, number, np.repeat(normals, 3, axis=0))
    return unit_vectors(total[number].reshape(len(faces), 3, 3))
