"""A rigid body at a place, touching a tissue surface: the bridge between the contact law at a point and Newton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.contact.checks import check_law, checked_normals
from tactsim.contact.traction import ContactIterate, ContactPair, ContactState, ContactTraction, at_points
from tactsim.fem.assembly.surface import SurfaceAssembly

ROUND_OFF = 4 * np.finfo(float).eps
"""Relative error of a position after interpolation and subtraction."""


@dataclass(frozen=True)
class PosedContact:
    """One contact pair on one surface, the body's reference point at ``place``.

    ``reference`` (d, n) are the undeformed surface points in m, ``place`` (d,) the body's reference point, ``state`` what the
    last accepted step left, ``growth`` how its forces grew per m of the body's displacement in Pa/m, if that is known, and
    ``grown_over`` that displacement in m, ``begin`` forces that Newton starts from, if not from those of the state.
    """

    surface: SurfaceAssembly
    reference: Array
    pair: ContactPair
    place: Array
    state: ContactState
    growth: ContactIterate | None = None
    begin: ContactIterate | None = None
    grown_over: float = 0.0

    @classmethod
    def apart(cls, surface: SurfaceAssembly, reference: Array, pair: ContactPair, place: Array) -> PosedContact:
        """A pair whose surfaces have not met yet: points at ``reference`` (d, n) in m, the body at ``place`` (d,) in m.

        Raises
        ------
        InvalidQuantity
            If the body or the law returns what cannot be used.
        """
        points = reference - place[:, None]
        normals = checked_normals(pair.body, points)
        check_law(pair.law)
        return cls(surface, reference, pair, place, ContactState.untouched(points, normals))

    def of_part(self, surface: SurfaceAssembly, points: Array) -> PosedContact:
        """The same pair on a part of the surface, of which the ``points`` (m,) are these; how its forces grew is left behind."""
        begin = None if self.begin is None else at_points(self.begin, points)
        pair, state = at_points(self.pair, points), at_points(self.state, points)
        return PosedContact(surface, self.reference[:, points], pair, self.place, state, begin=begin)

    def gap(self, displacement: Array) -> Array:
        """Gap (n,) in m at displacements (d, n) of the points, negative where they are in the body."""
        return self.pair.body.signed_distance(self._points(displacement))[0]

    def at(self, displacement: Array) -> ContactTraction:
        """Contact that holds at displacements (d, n) of the points."""
        return self.pair.converged(self._points(displacement), self.state)

    def start(self) -> ContactIterate:
        """Newton starts from the forces of the last accepted step, or those of a solution to be made exact."""
        return ContactIterate(self.state.pressure, self.state.tangential) if self.begin is None else self.begin

    def iterate_at(self, displacement: Array) -> ContactIterate:
        """The forces that hold at displacements (d, n) of the points."""
        return self.at(displacement).iterate()

    def converged(self, displacement: Array) -> Array:
        """Traction (d, n) in Pa."""
        return self.at(displacement).traction

    def rounding(self, displacement: Array, pressed: Array | bool = False) -> Array:
        """Traction (n,) in Pa lost in the round-off of the positions, which the penalties magnify; none clear of the body.

        ``pressed`` (n,) are points that press whatever their gap says.
        """
        along, across = np.abs(displacement).max(axis=0) + np.abs(self.place).max(), np.abs(self.reference).max(axis=0)
        lost = ROUND_OFF * (self.pair.penalty * along + self.pair.tangential_penalty * (along + across))
        gap = self.gap(displacement)
        touching = (gap <= ROUND_OFF * (along + across)) | (self.state.multiplier > self.pair.penalty * gap)
        return np.where(touching | pressed, lost, 0.0)

    def linearised(self, displacement: Array, iterate: ContactIterate) -> ContactTraction:
        """Traction and derivative at displacements (d, n) in m of the points, as the iterated forces decide."""
        return self.pair.linearised(self._points(displacement), self.state, iterate)

    def advanced(self, now: ContactTraction, iterate: ContactIterate, step: Array, damping: float) -> ContactIterate:
        """The iterated forces after the points moved by ``damping``, a share, of a ``step`` (d, n) in m."""
        full = self.pair.advanced(now, step)
        return ContactIterate(
            iterate.pressure + damping * (full.pressure - iterate.pressure),
            iterate.tangential + damping * (full.tangential - iterate.tangential),
        )

    def _points(self, displacement: Array) -> Array:
        return self.reference + displacement - self.place[:, None]
