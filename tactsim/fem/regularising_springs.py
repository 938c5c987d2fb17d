"""Springs far weaker than the tissue that suppress rigid-body motion while no contact holds the body."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.fem.body import Body

WEAKNESS = 1e-8
"""Stiffness of all springs together over that of the body: its shear modulus times its size."""


class RegularisingSprings:
    """Springs to ground on every node, in proportion to its volume; their relative error is of the order of ``WEAKNESS``."""

    def __init__(self, body: Body):
        space = body.space
        volume = np.bincount(space.elements.ravel(), np.repeat(body.points.weights.sum(axis=1), space.elements.shape[1]))
        size = float(np.ptp(space.nodes, axis=0).max())
        softest = min(material.shear_modulus for material in body.materials)
        self._stiffness = np.zeros(space.size)
        self._stiffness[: space.displacement_size] = np.repeat(WEAKNESS * softest * size * volume / volume.sum(), space.dim)
        unknowns = np.arange(space.size)
        self._positions = body.pattern.positions(unknowns, unknowns)
        self._entries, self._split = len(body.pattern.indices), space.displacement_size

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d) in m."""
        force = -self._stiffness
        force[: self._split] *= displacement.ravel()
        return force

    def stiffness(self, displacement: Array) -> Array:
        """Tangent entries."""
        data = np.zeros(self._entries)
        data[self._positions] = self._stiffness
        return data

    def total(self, displacement: Array) -> Array:
        """Resultant (d,) in N of the springs on the body."""
        return self.force(displacement)[: self._split].reshape(displacement.shape).sum(axis=0)
