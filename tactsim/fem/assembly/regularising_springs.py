"""Springs on every node: far weaker than the tissue, against rigid-body motion while no contact holds the body, or as strong as
the drag that holds back a sudden motion."""

from __future__ import annotations

from copy import copy

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body

WEAKNESS = 1e-8
"""Stiffness of all springs together over that of the body."""


class AnchoredSprings:
    """Springs on every node, in proportion to its volume, without force at the unknowns ``rest`` (size,).

    ``strength`` is the stiffness of all springs together over that of the body: its shear modulus times its size, or in plane
    strain times the metre of depth.
    """

    def __init__(self, body: Body, strength: float, rest: Array):
        space = body.space
        volume = np.bincount(space.elements.ravel(), np.repeat(body.points.weights.sum(axis=1), space.elements.shape[1]))
        size = 1.0 if space.measure == "plane_strain" else float(np.ptp(space.nodes, axis=0).max())
        softest = min(material.shear_modulus for material in body.materials)
        self._body, self._rest = body, rest
        self._stiffness = np.zeros(space.size)
        self._stiffness[: space.displacement_size] = np.repeat(strength * softest * size * volume / volume.sum(), space.dim)
        self._tangent: Array | None = None

    def of_part(self, body: Body, unknowns: Array, sides: Array) -> AnchoredSprings:
        """The springs of a part ``body``, whose ``unknowns`` (size',) have these numbers in the whole and are shared with so many
        ``sides`` (size',), its own among them."""
        springs = copy(self)
        springs._body, springs._rest, springs._tangent = body, self._rest[unknowns], None
        springs._stiffness = self._stiffness[unknowns] / sides
        return springs

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d) in m."""
        force = -self._stiffness
        force[: displacement.size] *= displacement.ravel() - self._rest[: displacement.size]
        return force

    def stiffness(self, displacement: Array) -> Array:
        """Tangent entries, the same array at all displacements."""
        if self._tangent is None:
            pattern = self._body.pattern
            self._tangent = np.zeros(len(pattern.indices))
            self._tangent[pattern.diagonal] = self._stiffness
        return self._tangent

    def total(self, displacement: Array) -> Array:
        """Resultant (d,) in N of the springs on the body."""
        return self.force(displacement)[: displacement.size].reshape(displacement.shape).sum(axis=0)


class RegularisingSprings(AnchoredSprings):
    """Springs to the undeformed places; their relative error is of the order of ``WEAKNESS``."""

    def __init__(self, body: Body):
        super().__init__(body, WEAKNESS, np.zeros(body.space.size))
