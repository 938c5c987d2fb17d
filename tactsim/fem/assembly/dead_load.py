"""Loads that keep their direction and their size per reference area or volume, whatever the body does."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body


def weight_of(body: Body, per_volume: Array) -> Array:
    """Nodal forces (size,) in N of a force (d,) in N/m^3 of the reference volume."""
    space, points = body.space, body.points
    shares = np.einsum("eq,qa->ea", points.weights, points.values)
    volumes = np.bincount(space.elements.ravel(), shares.ravel(), len(space.nodes))
    return np.concatenate([np.outer(volumes, per_volume).ravel(), np.zeros(space.size - space.displacement_size)])


class DeadLoad:
    """Nodal ``forces`` (size,) in N that no displacement changes; ``entries`` is the number of those of the tangent.

    Those of a traction on a surface come from `SurfaceAssembly.force`, those of a weight from `weight_of`. On an
    axisymmetric body the radial components push outwards all around.
    """

    def __init__(self, forces: Array, entries: int):
        self._forces, self._entries = forces, entries

    def at(self, factor: float) -> FactoredLoad:
        """The same load times a factor."""
        return FactoredLoad(factor * self._forces, self._entries)


class FactoredLoad:
    """Nodal forces (size,) in N that no displacement changes."""

    def __init__(self, force: Array, entries: int):
        self._force, self._entries = force, entries

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at any displacements."""
        return self._force

    def stiffness(self, displacement: Array) -> Array:
        """Tangent entries: none."""
        return np.zeros(self._entries)
