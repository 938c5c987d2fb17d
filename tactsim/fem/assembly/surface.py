"""Tractions on a boundary: nodal forces and tangent from values at its quadrature points."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.assembly.space import SurfacePoints


class SurfaceAssembly:
    """Adds tractions given per reference area at surface points to the equilibrium of a body."""

    def __init__(self, points: SurfacePoints, pattern: Pattern, dim: int):
        self.points = points
        self.unknowns = (points.nodes[:, :, None] * dim + np.arange(dim)).reshape(len(points.nodes), -1)
        values = points.values[: points.per_facet]
        self._products = np.einsum("qa,qb->qab", values, values).reshape(len(values), -1)
        self._pattern, self.size, self._dim = pattern, pattern.size, dim

    def force(self, traction: Array) -> Array:
        """External nodal forces (size,) in N of tractions (d, n) in Pa."""
        weighted = np.einsum("n,na,dn->nad", self.points.weights, self.points.values, traction)
        return np.bincount(self.unknowns.ravel(), weighted.ravel(), self.size)

    def largest_force(self, traction: Array) -> Array:
        """Nodal forces (size,) in N that tractions of sizes (n,) in Pa could make in any one direction, whatever their signs."""
        bound = np.einsum("n,na,n->na", self.points.weights, np.abs(self.points.values), traction)
        return np.bincount(self.unknowns.ravel(), np.repeat(bound, self._dim, axis=1).ravel(), self.size)

    def add_stiffness(self, data: Array, derivative: Array) -> Array:
        """The tangent entries ``data`` (nnz,) of the whole body, from which the derivative of the force is taken in place.

        ``derivative`` (d, d, n) in Pa/m is that of the traction with respect to the points.
        """
        weighted = (-self.points.weights * derivative).reshape(-1, self.points.per_facet)
        places, positions = self._places
        data[places] += np.bincount(positions, (weighted @ self._products).ravel(), len(places))
        return data

    def total(self, traction: Array) -> Array:
        """Resultant (d,) in N."""
        return traction @ self.points.weights

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """Places of the surface's entries in the tangent, each once, and which of them each facet's entries take."""
        facets, dim = self.unknowns[:: self.points.per_facet], self._dim
        nodes = facets.shape[1] // dim
        places = self._pattern.between(facets).reshape(len(facets), nodes, dim, nodes, dim)
        return np.unique(places.transpose(2, 4, 0, 1, 3).ravel(), return_inverse=True)
