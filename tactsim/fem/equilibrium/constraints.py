"""Prescribed unknowns, eliminated in place so that the sparse pattern, and its symbolic analysis, never change."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern


class Constraints:
    """Unknowns with prescribed values, which the initial guess holds and Newton does not change.

    ``counts`` (size,) says how many times each unknown's force counts where residuals are measured; by default once.
    """

    def __init__(self, fixed: Array, pattern: Pattern, *, counts: Array | None = None):
        self.fixed, self._pattern, self._counts = np.unique(fixed), pattern, counts

    def apply(self, data: Array) -> Array:
        """Clear rows and columns of the fixed unknowns in the tangent entries, in place, and put one on their diagonal."""
        cleared, diagonal = self._places
        data[cleared] = 0.0
        data[diagonal] = 1.0
        return data

    def free(self, residual: Array) -> Array:
        """Copy of a residual with the fixed rows cleared."""
        out = residual.copy()
        out[self.fixed] = 0.0
        return out

    def counted(self, forces: Array) -> Array:
        """Forces (size,), or (m,) of the first unknowns, as often as they count."""
        return forces if self._counts is None else forces * self._counts[: len(forces)]

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """Places in the tangent of the entries of fixed rows and columns, and of those on the diagonal."""
        pattern, held = self._pattern, np.zeros(self._pattern.size, bool)
        held[self.fixed] = True
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        return np.flatnonzero(held[rows] | held[pattern.indices]), pattern.diagonal[self.fixed]
