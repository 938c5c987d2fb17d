"""Edges of a block that roll onto a jaw need two elements between the face under the jaw and the free face beside it.

A single tetrahedron with a side in either face would have to become flat as the free face turns onto the jaw. Nearly
incompressible tissue does not let it: the edge sticks, and then snaps.
"""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import FACES
from tactsim.mesh.fitting.labelling import Interfaces

_UNDER, _BESIDE = ([number for number, (_, axis, _) in enumerate(FACES) if (axis == 2) == flat] for flat in (True, False))
"""Patches under the jaws, and those of the free faces."""


def side_patches(simplices: Array, walls: Interfaces) -> Array:
    """Patch (E, 4) on which the side of a tetrahedron opposite to each of its corners lies, -1 if on none."""
    table = {tuple(triangle): int(patch) for triangle, patch in zip(walls.triangles.tolist(), walls.patch, strict=True)}
    sides = np.sort(np.stack([np.delete(simplices, k, axis=1) for k in range(4)], axis=1), axis=2)
    patches = np.full((len(simplices), 4), -1)
    for element in np.flatnonzero(np.isin(simplices, walls.triangles).sum(axis=1) >= 3):
        patches[element] = [table.get(tuple(side), -1) for side in sides[element].tolist()]
    return patches


def without_wedges(corners: Array, simplices: Array, labels: Array, walls: Interfaces) -> tuple[Array, Array, Array, Interfaces]:
    """The mesh with no tetrahedron that has a side under a jaw and a side in a free face.

    The edge between the two corners that it does not share with the edge of the block is bisected, in every
    tetrahedron that has it. ``corners`` (n, 3) are in m, ``simplices`` (E, 4) corner numbers, ``labels`` (E,); the results alike.
    """
    while len(edges := _opposite_edges(simplices, walls)):
        for edge in edges:
            corners, middle = np.vstack([corners, corners[edge].mean(axis=0)]), len(corners)
            simplices, labels = _halved(simplices, labels, edge, middle)
            triangles, patch = _halved(walls.triangles, walls.patch, edge, middle)
            walls = Interfaces(np.sort(triangles, axis=1), patch)
    return corners, simplices, labels, walls


def _opposite_edges(simplices: Array, walls: Interfaces) -> Array:
    """Ends (n, 2) of the edges opposite to those of the block along which one tetrahedron lies alone."""
    patches = side_patches(simplices, walls)
    under, beside = (np.isin(patches, faces) for faces in (_UNDER, _BESIDE))
    wedges = under.any(axis=1) & beside.any(axis=1)
    ends = [np.take_along_axis(simplices[wedges], side[wedges].argmax(axis=1)[:, None], axis=1) for side in (under, beside)]
    return np.unique(np.sort(np.hstack(ends), axis=1), axis=0)


def _halved(cells: Array, numbers: Array, edge: Array, middle: int) -> tuple[Array, Array]:
    """Cells (n, k) and their numbers (n,) with two in place of each that has an edge (2,); the order of corners stays."""
    has = np.isin(cells, edge).sum(axis=1) == 2
    halves = [np.where(cells[has] == end, middle, cells[has]) for end in edge]
    return np.vstack([cells[~has], *halves]), np.concatenate([numbers[~has], numbers[has], numbers[has]])
