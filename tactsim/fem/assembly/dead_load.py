"""Loads that keep their direction and their size per reference area or volume, whatever the body does."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.body_part import BodyPart


def weight_of(body: Body, per_volume: Array) -> Array:
    """Nodal forces (size,) in N of a force (d,) in N/m^3 of the reference volume."""
    space, points = body.space, body.points
    shares = np.einsum("eq,qa->ea", points.weights, points.values)
    volumes = np.bincount(space.elements.ravel(), shares.ravel(), len(space.nodes))
    return np.concatenate([np.outer(volumes, per_volume).ravel(), np.zeros(space.size - space.displacement_size)])


class DeadLoad:
    """Nodal ``forces`` (size,) in N that no displacement changes.

    Those of a traction on a surface come from `SurfaceAssembly.force`, those of a weight from `weight_of`. On an
    axisymmetric body the radial components push outwards all around.
    """

    def __init__(self, forces: Array):
        self._forces = forces

    def at(self, factor: float) -> DeadLoad:
        """The same load times a factor."""
        return DeadLoad(factor * self._forces)

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at any displacements."""
        return self._forces

    def add_stiffness(self, data: Array, displacement: Array) -> None:
        """Add nothing to ``data`` (nnz,), as the force does not change with displacements (n, d)."""

    def of_part(self, part: BodyPart) -> DeadLoad:
        """The share of the forces that a part of the body bears."""
        return DeadLoad(part.share(self._forces))
