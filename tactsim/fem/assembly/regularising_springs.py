"""Springs on every node: far weaker than the tissue, against rigid-body motion while no contact holds the body, or as strong as
the drag that holds back a sudden motion."""

from __future__ import annotations

from copy import copy

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.body_part import BodyPart

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

    def of_part(self, part: BodyPart) -> AnchoredSprings:
        """The springs of a part of the body; of one on a plane between parts, its share."""
        springs = copy(self)
        springs._body, springs._rest, springs._stiffness = part.body, self._rest[part.unknowns], part.share(self._stiffness)
        return springs

    def force(self, displacement: Array) -> Array:
        """External nodal forces (size,) in N at nodal displacements (n, d) in m."""
        force = -self._stiffness
        force[: displacement.size] *= displacement.ravel() - self._rest[: displacement.size]
        return force

    def add_stiffness(self, data: Array, displacement: Array) -> None:
        """Add the stiffness of the springs to the diagonal of the tangent, entries (nnz,)."""
        data[self._body.pattern.diagonal] += self._stiffness


class RegularisingSprings(AnchoredSprings):
    """Springs to the undeformed places; their relative error is of the order of ``WEAKNESS``."""

    def __init__(self, body: Body):
        super().__init__(body, WEAKNESS, np.zeros(body.space.size))
