"""Prescribed unknowns, and nodes prescribed along one direction, eliminated in place: the sparse pattern, and its symbolic
analysis, never change."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern


@dataclass(frozen=True)
class Slides:
    r"""Nodes held along one direction in the plane of the first two axes, :math:`n \cdot u = d`, and free to slide across it.

    Attributes
    ----------
    first : (k,) numbers of their unknowns along the first axis; those along the second follow each
    normals : (2, k) unit vectors n
    distances : (k,) displacements d in m along them
    """

    first: Array
    normals: Array
    distances: Array

    @property
    def unknowns(self) -> Array:
        """Numbers (2 k,) of their unknowns along both axes."""
        return np.concatenate([self.first, self.first + 1])

    def along(self, values: Array) -> Array:
        """Components (k,) along the normals of values (size,) of all unknowns."""
        return np.asarray(self.normals[0] * values[self.first] + self.normals[1] * values[self.first + 1])

    def add(self, values: Array, along: Array) -> None:
        """Add components (k,) along the normals to values (size,), in place."""
        values[self.first] += self.normals[0] * along
        values[self.first + 1] += self.normals[1] * along


class Constraints:
    """Unknowns with prescribed values, which the initial guess holds and Newton does not change.

    ``counts`` (size,) says how many times each unknown's force counts where residuals are measured; by default once. What
    ``slides`` hold is prescribed, too.
    """

    def __init__(self, fixed: Array, pattern: Pattern, *, counts: Array | None = None, slides: Slides | None = None):
        self.fixed, self._pattern, self._counts, self._slides = np.unique(fixed), pattern, counts, slides

    def apply(self, data: Array) -> Array:
        """Clear rows and columns of what is held in the tangent entries (nnz,), in place, and put one on its diagonal."""
        cleared, diagonal = self._places
        data[cleared] = 0.0
        data[diagonal] = 1.0
        if self._slides is not None:
            self._clear_normals(data, self._slides)
        return data

    def free(self, residual: Array) -> Array:
        """Copy of a residual (size,) without the forces on what is held."""
        out = residual.copy()
        out[self.fixed] = 0.0
        if self._slides is not None:
            self._slides.add(out, -self._slides.along(out))
        return out

    def counted(self, forces: Array) -> Array:
        """Forces (size,), or (m,) of the first unknowns, as often as they count."""
        return forces if self._counts is None else forces * self._counts[: len(forces)]

    def _clear_normals(self, data: Array, slides: Slides) -> None:
        r"""Replace the entries K by :math:`P K P + n n^T` with :math:`P = 1 - n n^T`: the rows of a node have one structure, and
        its columns follow each other."""
        pattern, normals = self._pattern, slides.normals
        lengths = np.diff(pattern.indptr)[slides.first]
        row = np.repeat(pattern.indptr[slides.first] - np.cumsum(lengths) + lengths, lengths) + np.arange(lengths.sum())
        place = np.full(pattern.size, -1)
        place[slides.first] = np.arange(len(slides.first))
        column = np.flatnonzero(place[pattern.indices] >= 0)
        rows = row, row + np.repeat(lengths, lengths), np.repeat(normals, lengths, axis=1)
        columns = column, column + 1, normals[:, place[pattern.indices[column]]]
        for first, second, normal in (rows, columns):
            along = normal[0] * data[first] + normal[1] * data[second]
            data[first] -= normal[0] * along
            data[second] -= normal[1] * along
        for k, i in ((0, 0), (0, 1), (1, 0), (1, 1)):
            data[pattern.positions(slides.first + k, slides.first + i)] += normals[k] * normals[i]

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """Places in the tangent of the entries of fixed rows and columns, and of those on the diagonal."""
        pattern, held = self._pattern, np.zeros(self._pattern.size, bool)
        held[self.fixed] = True
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        return np.flatnonzero(held[rows] | held[pattern.indices]), pattern.diagonal[self.fixed]
