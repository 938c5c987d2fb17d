"""Nested refinement of triangles where a deformed mesh is too coarse, with exact transfer of quadratic fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

_ENDS = np.array([[0, 1], [1, 2], [0, 2]])


@dataclass(frozen=True)
class Refinement:
    """A refined mesh and where its parts come from.

    Attributes
    ----------
    mesh : the children; their nodes lie on the geometry of their parents
    nodal : (n_new, n_old) values of a P2 field at the new nodes from the old nodal values: exact, the spaces are nested
    parents : (E_new,) number of the parent
    barycentric : (E_new, 3, 3) of each child's corners in its parent
    """

    mesh: QuadraticMesh
    nodal: scipy.sparse.csr_matrix
    parents: Array
    barycentric: Array

    def facets_on(self, coarse: QuadraticMesh, facets: Array) -> Array:
        """Boundary facets (F, 3) of the refined mesh that lie on some boundary facets (F, 3) of the coarse one."""
        boundary, owner = coarse.boundary_facets()
        wanted = np.isin(boundary[:, 2], facets[:, 2])
        sides = 3 * owner[wanted] + _opposite(coarse.elements[owner[wanted]], boundary[wanted])
        fine, child = self.mesh.boundary_facets()
        inside = np.arange(3) == _opposite(self.mesh.elements[child], fine)[:, None]
        along = np.where(inside[:, :, None], 0.0, self.barycentric[child]).sum(axis=1)
        return fine[np.isin(3 * self.parents[child] + along.argmin(axis=1), sides) & (along.min(axis=1) == 0)]


def refined(mesh: QuadraticMesh, marked: Array, shape: Array) -> Refinement:
    """Split marked triangles (and what conformity asks for) across edges that are longest in ``shape``.

    Parameters
    ----------
    mesh : straight or curved quadratic triangles
    marked : element numbers
    shape : (n, 2) node positions in m, such as the deformed ones, in which "longest" is judged
    """
    corners = mesh.corner_count
    bits = {f"bit{k}": np.flatnonzero(np.arange(len(mesh.elements)) >> k & 1) for k in range(len(mesh.elements).bit_length())}
    from skfem import MeshTri

    coarse = MeshTri(shape[:corners].T.copy(), mesh.elements[:, :3].T.copy(), sort_t=False).with_subdomains(bits)
    fine = coarse.refined(marked)
    parents = np.zeros(fine.nelements, np.int64)
    for name, members in fine.subdomains.items():
        parents[members] |= 1 << int(name.removeprefix("bit"))
    simplices = fine.t.T.astype(np.int64)
    barycentric = _barycentric(mesh.elements[parents], simplices, coarse.p.T, fine.p.T)
    mirrored = np.linalg.det(barycentric) < 0
    simplices[mirrored] = simplices[mirrored][:, [0, 2, 1]]
    barycentric[mirrored] = barycentric[mirrored][:, [0, 2, 1]]
    reference = _transfer(simplices, mesh.elements[parents], _quadratic(barycentric), (fine.nvertices, len(mesh.nodes)))
    straight = quadratic_mesh(reference @ mesh.nodes, simplices, mesh.regions[parents])
    nodes = np.concatenate([barycentric, barycentric[:, _ENDS].mean(axis=2)], axis=1)
    nodal = _transfer(straight.elements, mesh.elements[parents], _quadratic(nodes), (len(straight.nodes), len(mesh.nodes)))
    return Refinement(straight.moved(nodal @ mesh.nodes), nodal, parents, barycentric)


def _opposite(elements: Array, facets: Array) -> Array:
    """Local number of the corner of each element (F, 6) that its facet (F, 3) leaves out."""
    return (elements[:, :3, None] != facets[:, None, :2]).all(axis=2).argmax(axis=1)


def _barycentric(parents: Array, children: Array, old: Array, new: Array) -> Array:
    """Barycentric coordinates (E, 3, 3) of the children's corners, each a corner of the parent or the middle of an edge."""
    corners = old[parents[:, :3]]
    candidates = np.concatenate([corners, corners[:, _ENDS].mean(axis=2)], axis=1)
    coordinates = np.vstack([np.eye(3), np.eye(3)[_ENDS].mean(axis=1)])
    distance = np.linalg.norm(new[children][:, :, None] - candidates[:, None], axis=3)
    return coordinates[distance.argmin(axis=2)]


def _quadratic(barycentric: Array) -> Array:
    """P2 shape functions (..., 6) at barycentric coordinates (..., 3)."""
    ends = barycentric[..., _ENDS]
    return np.concatenate([barycentric * (2 * barycentric - 1), 4 * ends[..., 0] * ends[..., 1]], axis=-1)


def _transfer(children: Array, parents: Array, values: Array, size: tuple[int, int]) -> scipy.sparse.csr_matrix:
    """Rows for each new node from one of its elements: ``values`` (E, new, old) in the parents' numbering."""
    new, first = np.unique(children, return_index=True)
    element, local = np.divmod(first, children.shape[1])
    columns, entries = parents[element], values[element, local]
    rows = np.repeat(new, columns.shape[1])
    return scipy.sparse.csr_matrix((entries.ravel(), (rows, columns.ravel())), shape=size)
