"""Prescribed unknowns, eliminated in place so that the sparse pattern, and its symbolic analysis, never change."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern


class Constraints:
    """Unknowns with prescribed values, which the initial guess holds and Newton does not change.

    ``reactions_count`` says whether the forces that hold them are among those that residuals are measured by.
    """

    def __init__(self, fixed: Array, pattern: Pattern, *, reactions_count: bool = True):
        self.fixed, self.reactions_count = np.unique(fixed), reactions_count
        held = np.zeros(pattern.size, bool)
        held[self.fixed] = True
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        self._cleared = np.flatnonzero(held[rows] | held[pattern.indices])
        self._diagonal = pattern.positions(self.fixed, self.fixed)

    def apply(self, data: Array) -> Array:
        """Clear rows and columns of the fixed unknowns in the tangent entries, in place, and put one on their diagonal."""
        data[self._cleared] = 0.0
        data[self._diagonal] = 1.0
        return data

    def free(self, residual: Array) -> Array:
        """Copy of a residual with the fixed rows cleared."""
        out = residual.copy()
        out[self.fixed] = 0.0
        return out

    def largest(self, forces: Array) -> float:
        """Largest of the forces (size,) or (m,) of the first unknowns that residuals are measured by."""
        counted = forces if self.reactions_count else np.delete(forces, self.fixed[self.fixed < len(forces)])
        return float(np.abs(counted).max())
