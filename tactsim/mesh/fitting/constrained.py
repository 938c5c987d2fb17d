"""Nodes that must stay on surfaces: planes, curved patches, and the edges where several of them meet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.solid import FACES, Patch
from tactsim.mesh.solid import plane_patch, unit_vectors

STEPS = 40
ROUND_OFF = 1e-12
"""Distance from a patch, over the size of the block, at which a node counts as on it."""
PARALLEL = 1e-3
"""Singular value of unit normals below which two patches count as one."""
SHARP = 0.85
"""Cosine of the angle between a triangle and its patch below which there is a sharp edge between."""


@dataclass(frozen=True)
class Constraints:
    """Which patches every node lies on.

    Attributes
    ----------
    patches : the six faces of the block in the order of FACES, then those of the inclusions
    on : (n, P) whether a node must lie on a patch
    size : (3,) of the block in m
    held : (n,) whether a node keeps its place, as at a sharp edge of a surface; None holds no node
    """

    patches: Sequence[Patch]
    on: Array
    size: Array
    held: Array | None = None

    def _groups(self) -> Iterator[tuple[Array, Array]]:
        """Nodes (k,) and the patches that they share."""
        sets, number = np.unique(self.on, axis=0, return_inverse=True)
        for index, members in enumerate(sets):
            if members.any():
                yield np.flatnonzero(number.reshape(-1) == index), np.flatnonzero(members)

    def restored(self, points: Array) -> Array:
        """Points (n, 3) in m moved onto all their patches, exactly on the faces of the block.

        Raises
        ------
        InputError
            If a node does not reach a common point of its patches.
        """
        moved = np.array(points, float)
        for nodes, patches in self._groups():
            x = moved[nodes]
            if len(patches) == 1:
                moved[nodes] = self.patches[patches[0]](x)[0]
                continue
            for _ in range(STEPS):
                normals, distance = self._at(x, patches)
                if np.abs(distance).max() < ROUND_OFF * self.size.max():
                    break
                x = x - np.einsum("nij,nj->ni", np.linalg.pinv(normals, rcond=PARALLEL), distance)
            if np.abs(self._at(x, patches)[1]).max() > 1e-6 * self.size.max():
                raise InputError("a node between surfaces finds no common point of them; take smaller elements")
            moved[nodes] = x
        for column, (_, axis, end) in enumerate(FACES):
            moved[self.on[:, column], axis] = self.size[axis] * end
        return moved

    def directions(self, points: Array) -> Array:
        """Projectors (n, 3, 3) on the directions in which nodes may move."""
        projectors = np.tile(np.eye(3), (len(points), 1, 1))
        for nodes, patches in self._groups():
            normals, _ = self._at(points[nodes], patches)
            projectors[nodes] -= np.linalg.pinv(normals, rcond=PARALLEL) @ normals
        if self.held is not None:
            projectors[self.held] = 0.0
        return projectors

    def holding_edges(self, points: Array, triangles: Array, patch: Array) -> Constraints:
        """The same, with the nodes held at which a triangle (F, 3) is turned far from the patch (F,) that it lies on."""
        held = np.zeros(len(points), bool)
        for column in np.unique(patch):
            on_it = triangles[patch == column]
            a, b, c = (points[on_it[:, k]] for k in range(3))
            normal = unit_vectors(np.cross(b - a, c - a))
            for k in range(3):
                across = self.patches[column](points[on_it[:, k]])[1]
                held[on_it[np.abs((normal * across).sum(axis=1)) < SHARP, k]] = True
        return replace(self, held=held)

    def _at(self, x: Array, patches: Array) -> tuple[Array, Array]:
        """Normals (n, p, 3) of patches and signed distances (n, p) of points (n, 3) from them."""
        nearest = [self.patches[patch](x) for patch in patches]
        normals = np.stack([normal for _, normal in nearest], axis=1)
        return normals, np.stack([((x - near) * normal).sum(axis=1) for near, normal in nearest], axis=1)


def block_patches(size: Array) -> list[Patch]:
    """The planes of the faces of a block of size (3,) in m, in the order of FACES."""
    return [plane_patch(axis, size[axis] * end) for _, axis, end in FACES]
