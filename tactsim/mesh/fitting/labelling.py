"""Which part of a block each tetrahedron belongs to, and which triangles lie between the parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import FACES, Patch, Solid
from tactsim.mesh.fitting.constrained import Constraints, block_patches
from tactsim.mesh.quadratic import row_numbers
from tactsim.mesh.solid import unit_vectors

OUTSIDE = -1
"""Label outside the block; the tissue is 0, inclusion k is k, and the space in a hollow inclusion k is -1 - k."""
_SIDES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
SWEEPS = 5


@dataclass(frozen=True)
class Surfaces:
    """The surfaces between the parts of a block.

    Attributes
    ----------
    size : (3,) of the block in m
    solids : the solids of each inclusion, the outer one first
    """

    size: Array
    solids: Sequence[tuple[Solid, ...]]

    @property
    def patches(self) -> list[Patch]:
        """The faces of the block, then the patches of every solid."""
        return [*block_patches(self.size), *(patch for group in self.solids for solid in group for patch in solid.patches)]

    def labels(self, points: Array) -> Array:
        """Labels (n,) of points (n, 3)."""
        labels = np.zeros(len(points), np.int64)
        for number, (outer, *hollow) in enumerate(self.solids, 1):
            low, high = outer.bounds()
            near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
            within = near[outer.inside(points[near])]
            labels[within] = number
            for space in hollow:
                labels[within[space.inside(points[within])]] = -1 - number
        labels[((points < 0) | (points > self.size)).any(axis=1)] = OUTSIDE
        return labels

    def columns(self, first: int, second: int) -> Array:
        """Numbers (k,) of the patches that may lie between two labels."""
        if OUTSIDE in (first, second):
            return np.arange(len(FACES))
        counts = [[len(solid.patches) for solid in group] for group in self.solids]
        number, depth = (-1 - min(first, second), 1) if min(first, second) < 0 else (max(first, second), 0)
        start = len(FACES) + sum(map(sum, counts[: number - 1])) + sum(counts[number - 1][:depth])
        return np.arange(start, start + counts[number - 1][depth])


@dataclass(frozen=True)
class Interfaces:
    """Triangles (F, 3) between parts of different label, corners ascending, and the patch (F,) on which each lies."""

    triangles: Array
    patch: Array

    def constraints(self, count: int, surfaces: Surfaces) -> Constraints:
        """What ``count`` corners must stay on."""
        patches = surfaces.patches
        on = np.zeros((count, len(patches)), bool)
        for k in range(3):
            on[self.triangles[:, k], self.patch] = True
        return Constraints(patches, on, surfaces.size)


def interfaces(corners: Array, simplices: Array, labels: Array, surfaces: Surfaces) -> Interfaces:
    """The triangles between tetrahedra (E, 4) of different labels (E,), of which one at least is kept."""
    triangles, pairs = _pairs(simplices, labels)
    chosen = (pairs[:, 0] != pairs[:, 1]) & (pairs.max(axis=1) >= 0)
    triangles, pairs = triangles[chosen], pairs[chosen]
    patch, all_patches = np.zeros(len(triangles), np.int64), surfaces.patches
    for pair in np.unique(pairs, axis=0):
        members = np.flatnonzero((pairs == pair).all(axis=1))
        columns = surfaces.columns(int(pair[0]), int(pair[1]))
        patch[members] = columns[_misfit(corners[triangles[members]], [all_patches[c] for c in columns]).argmin(axis=0)]
    return Interfaces(triangles, patch)


def tidied(simplices: Array, labels: Array) -> Array:
    """Labels (E,) after giving every tetrahedron that three or four neighbours of one other label enclose that label."""
    neighbours = neighbours_of(simplices)
    tidy = labels.copy()
    for _ in range(SWEEPS):
        around = np.where(neighbours >= 0, tidy[neighbours], OUTSIDE)
        around.sort(axis=1)
        majority = np.where(around[:, 0] == around[:, 2], around[:, 0], around[:, 3])
        three = (around[:, 0] == around[:, 2]) | (around[:, 1] == around[:, 3])
        change = three & (majority != tidy) & (majority != OUTSIDE) & (tidy != OUTSIDE)
        if not change.any():
            break
        tidy[change] = majority[change]
    return tidy


def _misfit(triangles: Array, patches: Sequence[Patch]) -> Array:
    """How far triangles (n, 3, 3) are from lying on each patch (p, n), in m: distance of corners plus turn of the normal."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.sqrt(np.linalg.norm(normal, axis=1))
    normal = unit_vectors(normal)
    misfits = []
    for patch in patches:
        near, across = patch(triangles.mean(axis=1))
        distance = np.linalg.norm(near - triangles.mean(axis=1), axis=1)
        misfits.append(distance + 0.5 * length * (1 - np.abs((normal * across).sum(axis=1))))
    return np.array(misfits)


def _pairs(simplices: Array, labels: Array) -> tuple[Array, Array]:
    """Triangles (F, 3) and the labels (F, 2), ascending, of the tetrahedra on their sides; OUTSIDE where there is none."""
    faces = np.sort(np.concatenate([simplices[:, list(side)] for side in _SIDES]), axis=1)
    _, first, number = np.unique(row_numbers(faces), return_index=True, return_inverse=True)
    triangles = faces[first]
    owner = np.tile(labels, 4)
    order = np.argsort(number, kind="stable")
    start = np.searchsorted(number[order], np.arange(len(triangles) + 1))
    pairs = np.full((len(triangles), 2), OUTSIDE)
    pairs[:, 0] = owner[order[start[:-1]]]
    double = np.diff(start) > 1
    pairs[double, 1] = owner[order[start[:-1][double] + 1]]
    return triangles, np.sort(pairs, axis=1)


def neighbours_of(simplices: Array) -> Array:
    """Numbers (E, 4) of the tetrahedra across the sides, -1 where there is none."""
    faces = np.sort(np.stack([simplices[:, list(side)] for side in _SIDES], axis=1), axis=2).reshape(-1, 3)
    _, number = np.unique(row_numbers(faces), return_inverse=True)
    order = np.argsort(number, kind="stable")
    same = np.flatnonzero(np.diff(number[order]) == 0)
    neighbours = np.full(len(faces), -1)
    a, b = order[same], order[same + 1]
    neighbours[a], neighbours[b] = b // 4, a // 4
    return neighbours.reshape(-1, 4)
