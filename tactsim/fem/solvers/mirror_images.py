"""Planes that mirror a body onto itself, and the unknowns that stand for all of a state that is its own mirror image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from tactsim.array import Array
from tactsim.fem.assembly.body import Body

SAME_PLACE = 1e-9
"""Distance of a node from its image's place over the body's size up to which it is that image: far below any cell."""


@dataclass(frozen=True)
class Reflection:
    """The ``image`` (size,) of every unknown in a plane, and the ``sign`` (size,) with which a mirrored state has it there."""

    image: Array
    sign: Array


@dataclass(frozen=True)
class MirrorImages:
    """The states of a body that are their own mirror images, in terms of ``m`` of its unknowns.

    An unknown and its images form an orbit, for which its first stands. A reduced vector holds that one times the root of
    the orbit's length, so that products of vectors, and the symmetry of matrices, are kept.

    Attributes
    ----------
    first : (m,) the unknown that stands for each orbit
    orbit : (size,) number of every unknown's orbit
    sign : (size,) of every unknown relative to the first of its orbit; zero for displacements across a plane of nodes on it
    """

    first: Array
    orbit: Array
    sign: Array

    @cached_property
    def roots(self) -> Array:
        """Root (m,) of the length of each orbit."""
        return np.sqrt(np.bincount(self.orbit, np.abs(self.sign), len(self.first)))

    def reduced(self, vector: Array) -> Array:
        """The part (m,) of a vector (size,) that is its own mirror image."""
        return np.bincount(self.orbit, self.sign * vector, len(self.first)) / self.roots

    def whole(self, reduced: Array) -> Array:
        """The vector (size,) of a reduced one (m,)."""
        return self.sign * (reduced / self.roots)[self.orbit]


class ReducedMatrices:
    """What matrices of one pattern, each its own mirror image, do to reduced vectors; their rows of the first unknowns suffice.

    Parameters
    ----------
    images : of the vectors
    pattern : a matrix (size, size) of the pattern
    """

    def __init__(self, images: MirrorImages, pattern: csr_matrix):
        count = len(images.first)
        lengths = np.diff(pattern.indptr)[images.first]
        starts = np.repeat(pattern.indptr[images.first] - np.concatenate([[0], np.cumsum(lengths)[:-1]]), lengths)
        entries, rows = starts + np.arange(lengths.sum()), np.repeat(np.arange(count), lengths)
        entries, rows = (values[images.sign[pattern.indices[entries]] != 0] for values in (entries, rows))
        columns = pattern.indices[entries]
        orbits = images.orbit[columns]
        keys, self._places = np.unique(rows * np.int64(count) + orbits, return_inverse=True)
        self._entries = entries
        self._factors = images.sign[columns] * images.roots[rows] / images.roots[orbits]
        self._indices = (keys % count).astype(np.int32)
        self._indptr = np.concatenate([[0], np.cumsum(np.bincount(keys // count, minlength=count))]).astype(np.int32)

    def of(self, matrix: csr_matrix) -> csr_matrix:
        """The reduced matrix (m, m) of a matrix (size, size)."""
        data = np.bincount(self._places, self._factors * matrix.data[self._entries], len(self._indices))
        return csr_matrix((data, self._indices, self._indptr), shape=(len(self._indptr) - 1,) * 2)


def mirror_images(body: Body) -> MirrorImages | None:
    """What stands for the states of a body that are their own images in all the middle planes that mirror it; None without one.

    The planes mirror nodes, elements and materials. Whether they mirror what acts on the body is not known here.
    """
    reflections = [found for axis in range(body.space.dim) if (found := _reflection(body, axis)) is not None]
    return _orbits(reflections, body.space.size) if reflections else None


def _orbits(reflections: Sequence[Reflection], size: int) -> MirrorImages:
    """Orbits of the unknowns under reflections that commute."""
    images, signs = np.arange(size)[None], np.ones((1, size))
    for one in reflections:
        images = np.vstack([images, one.image[images]])
        signs = np.vstack([signs, signs * one.sign[images[: len(signs)]]])
    least = images.min(axis=0)
    fixed = (images == np.arange(size)) & (signs < 0)
    sign = signs[images.argmin(axis=0), np.arange(size)] * ~fixed.any(axis=0)
    first = np.flatnonzero((least == np.arange(size)) & (sign != 0))
    orbit = np.zeros(size, int)
    orbit[first] = np.arange(len(first))
    return MirrorImages(first, orbit[least], sign)


def _reflection(body: Body, axis: int) -> Reflection | None:
    """The reflection in the middle plane across an axis, if it mirrors the body onto itself."""
    space = body.space
    nodes = _mirrored_nodes(space.nodes, axis)
    if nodes is None:
        return None
    pressures = _mirrored_pressures(body, nodes)
    if pressures is None:
        return None
    across = np.ones((len(nodes), space.dim))
    across[:, axis] = -1
    displacements = (nodes[:, None] * space.dim + np.arange(space.dim)).ravel()
    image = np.concatenate([displacements, space.displacement_size + pressures])
    return Reflection(image, np.concatenate([across.ravel(), np.ones(len(pressures))]))


def _mirrored_nodes(nodes: Array, axis: int) -> Array | None:
    """The image (n,) of every node, or None where one has none."""
    low, high = nodes[:, axis].min(), nodes[:, axis].max()
    tolerance = SAME_PLACE * float(np.ptp(nodes, axis=0).max())
    mirrored = nodes.copy()
    mirrored[:, axis] = low + high - nodes[:, axis]
    if np.abs(np.sort(mirrored[:, axis]) - np.sort(nodes[:, axis])).max() > tolerance:
        return None
    distance, image = cKDTree(nodes).query(mirrored, distance_upper_bound=2 * tolerance)
    return image if np.isfinite(distance).all() else None


def _mirrored_pressures(body: Body, nodes: Array) -> Array | None:
    """The image of every pressure, given those of the nodes (n,), or None where an element has no image of the same material."""
    space = body.space
    corners = space.elements[:, : space.dim + 1]
    here, there = np.argsort(corners, axis=1), np.argsort(nodes[corners], axis=1)
    sorted_here, sorted_there = np.take_along_axis(corners, here, 1), np.take_along_axis(nodes[corners], there, 1)
    first, second = np.lexsort(sorted_here.T), np.lexsort(sorted_there.T)
    if not np.array_equal(sorted_here[first], sorted_there[second]):
        return None
    kinds = np.array([body.materials.index(material) for material in body.materials])[body.regions]
    if not np.array_equal(kinds[first], kinds[second]):
        return None
    image = np.empty(space.size - space.displacement_size, int)
    image[np.take_along_axis(space.pressures, there, 1)[second]] = np.take_along_axis(space.pressures, here, 1)[first]
    return image
