"""Grids of cells mapped onto blocks, rings, discs and balls, with the names of their faces. They repeat by construction.

Each cell has a corner in its middle, so that no element has all its corners on the boundary: a pressure of P1 beside a
displacement of P2 is stable then whatever is held (Boffi, Brezzi & Fortin 2013, doi:10.1007/978-3-642-36519-5, section 8.6).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.mesh.affordable import PER_TETRAHEDRON, check_along, check_unknowns
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh
from tactsim.mesh.structured_block import ON_SIDE, grid, product, twelfths

PER_TRIANGLE = 4.5
"""Unknowns of a triangle: 2 nodes of two displacements, half a corner with a pressure (Euler's formula)."""


@dataclass(frozen=True)
class Domain:
    """A mesh, its faces and its planes of symmetry.

    Attributes
    ----------
    mesh : quadratic triangles or tetrahedra
    faces : name -> facets (F, 3) or (F, 6) by node numbers, outward oriented
    mirrors : names of the faces that are planes of symmetry of the whole body, each with the axis that it is normal to
    """

    mesh: QuadraticMesh
    faces: dict[str, Array]
    mirrors: dict[str, int]

    def mapped(self, place: Callable[[Array], Array]) -> Domain:
        """The same grid with its nodes (n, d) at other places; the middles of edges follow, so that curves are true."""
        return replace(self, mesh=self.mesh.moved(place(self.mesh.nodes)))

    def closed(self, first: str, last: str) -> Domain:
        """The same cells, of a section whose face ``last`` lies on the ``first``, as a ring without ends."""
        ends = [np.unique(self.faces[name]) for name in (first, last)]
        kept, gone = (nodes[np.lexsort(self.mesh.nodes[nodes].T)] for nodes in ends)
        stays = np.ones(len(self.mesh.nodes), bool)
        stays[gone] = False
        numbers = np.cumsum(stays) - 1
        numbers[gone] = numbers[kept]
        mesh = QuadraticMesh(self.mesh.nodes[stays], numbers[self.mesh.elements], self.mesh.regions)
        faces = {name: numbers[facets] for name, facets in self.faces.items() if name not in (first, last)}
        return Domain(mesh, faces, self.mirrors)


def spaced(length: float, cells: int, ratio: float = 1.0) -> Array:
    """Coordinates (cells + 1,) from 0 to ``length`` in m; the last cell is ``ratio`` times as long as the first, growing evenly.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    check_along(cells, "cells")
    growth = ratio ** (1 / (cells - 1)) if cells > 1 else 1.0
    steps = growth ** np.arange(cells)
    line = np.concatenate([[0.0], np.cumsum(steps)]) * (length / steps.sum())
    line[-1] = length
    return line


def grid_domain(lines: Sequence[Array], faces: Sequence[tuple[str, str]], mirrors: Mapping[str, int] | None = None) -> Domain:
    """A rectangle or a block of cells between ascending coordinates (n,) in m, one array for each axis.

    Parameters
    ----------
    lines : two or three arrays
    faces : names of the first and the last face along each axis; sides of one name are one face
    mirrors : as in `Domain`

    Raises
    ------
    InputError
        If the cells are too many.
    """
    counts = [len(line) - 1 for line in lines]
    elements = float(np.prod(counts, dtype=float)) * (4 if len(lines) == 2 else 12)
    check_unknowns((PER_TRIANGLE if len(lines) == 2 else PER_TETRAHEDRON) * elements, f"cells {counts}")
    mesh = _crossed(lines) if len(lines) == 2 else _twelve_to_a_cell(lines)
    facets, _ = mesh.boundary_facets()
    named: dict[str, Array] = {}
    for axis, (line, names) in enumerate(zip(lines, faces, strict=True)):
        for end, name in zip((line[0], line[-1]), names, strict=True):
            on = np.abs(mesh.nodes[facets][..., axis] - end) <= ON_SIDE * (line[-1] - line[0])
            named[name] = np.concatenate([named.get(name, facets[:0]), facets[on.all(axis=1)]])
    return Domain(mesh, named, dict(mirrors or {}))


def _crossed(lines: Sequence[Array]) -> QuadraticMesh:
    """Four triangles for each cell, around its middle."""
    nx, ny = (len(line) for line in lines)
    corners = product(lines)
    index = np.arange(nx * ny).reshape(nx, ny)
    around = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    middles = len(corners) + np.arange(len(around))
    triangles = [np.stack([around[:, k], around[:, (k + 1) % 4], middles], axis=1) for k in range(4)]
    return quadratic_mesh(np.vstack([corners, corners[around].mean(axis=1)]), np.concatenate(triangles))


def _twelve_to_a_cell(lines: Sequence[Array]) -> QuadraticMesh:
    """Twelve tetrahedra for each cell, around its middle."""
    corners = product(lines)
    simplices, corners = twelfths(grid([len(line) - 1 for line in lines]), corners, np.arange(len(corners)))
    return quadratic_mesh(corners, simplices)


def disc(nodes: Array) -> Array:
    r"""Places (n, 2) in the unit disc of nodes (n, 2) in the square between -1 and 1, whose sides become the circle.

    .. math:: x = u \sqrt{1 - v^2 / 2}, \quad y = v \sqrt{1 - u^2 / 2}
    """
    u, v = nodes.T
    return np.column_stack([u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)])
