"""Tractions on a boundary: nodal forces and tangent from values at its quadrature points."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.assembly.space import SurfacePoints


class SurfaceAssembly:
    """Adds tractions given per reference area at surface points to the equilibrium of a body."""

    def __init__(self, points: SurfacePoints, pattern: Pattern, dim: int):
        self.points = points
        self.unknowns = (points.nodes[:, :, None] * dim + np.arange(dim)).reshape(len(points.nodes), -1)
        width = self.unknowns.shape[1]
        facets = self.unknowns[:: points.per_facet]
        rows = np.repeat(facets[:, :, None], width, axis=2)
        places = pattern.positions(rows, rows.transpose(0, 2, 1)).reshape(len(facets), width // dim, dim, width // dim, dim)
        self._places, self._positions = np.unique(places.transpose(2, 4, 0, 1, 3).ravel(), return_inverse=True)
        values = points.values[: points.per_facet]
        self._products = np.einsum("qa,qb->qab", values, values).reshape(len(values), -1)
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
        return self.add_stiffness(np.zeros(self._entries), derivative)

    def add_stiffness(self, data: Array, derivative: Array) -> Array:
        """The tangent entries ``data`` of the whole body with those of ``stiffness`` added to them, in place."""
        weighted = (-self.points.weights * derivative).reshape(-1, self.points.per_facet)
        data[self._places] += np.bincount(self._positions, (weighted @ self._products).ravel(), len(self._places))
        return data

    def total(self, traction: Array) -> Array:
        """Resultant (d,) in N."""
        return traction @ self.points.weights
