"""Tractions on a boundary: nodal forces and tangent from values at its quadrature points."""

from __future__ import annotations

import numpy as np

from tactsim.fem.pattern import Pattern
from tactsim.fem.space import SurfacePoints

Array = np.ndarray


class SurfaceAssembly:
    """Adds tractions given per reference area at surface points to the equilibrium of a body."""

    def __init__(self, points: SurfacePoints, pattern: Pattern, dim: int):
        self.points = points
        self.unknowns = (points.nodes[:, :, None] * dim + np.arange(dim)).reshape(len(points.nodes), -1)
        width = self.unknowns.shape[1]
        rows = np.repeat(self.unknowns[:, :, None], width, axis=2)
        self._positions = pattern.positions(rows, rows.transpose(0, 2, 1))
        self._entries = len(pattern.indices)
        self.size, self._dim = pattern.size, dim

    def force(self, traction: Array) -> Array:
        """External nodal forces (size,) in N of tractions (d, n) in Pa."""
        weighted = np.einsum("n,na,dn->nad", self.points.weights, self.points.values, traction)
        return np.bincount(self.unknowns.ravel(), weighted.ravel(), self.size)

    def largest_force(self, traction: Array) -> Array:
        """Nodal forces (size,) in N that tractions of sizes (n,) in Pa could make in any one direction, whatever their signs."""
        bound = np.einsum("n,na,n->na", self.points.weights, np.abs(self.points.values), traction)
        return np.bincount(self.unknowns.ravel(), np.repeat(bound, self._dim, axis=1).ravel(), self.size)

    def stiffness(self, derivative: Array) -> Array:
        """Tangent entries, minus the derivative of the external force, for d(traction)/dx of shape (d, d, n) in Pa/m."""
        values = self.points.values
        blocks = np.einsum("n,na,nb,ijn->naibj", -self.points.weights, values, values, derivative, optimize=True)
        return np.bincount(self._positions.ravel(), blocks.ravel(), self._entries)

    def total(self, traction: Array) -> Array:
        """Resultant (d,) in N."""
        return traction @ self.points.weights
