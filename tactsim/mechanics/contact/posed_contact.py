"""A rigid body at a place, touching a tissue surface: the bridge between the contact law at a point and Newton."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.traction import ContactIterate, ContactPair, ContactState, ContactTraction
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
        """A pair whose surfaces have not met yet."""
        points = reference - place[:, None]
        return cls(surface, reference, pair, place, ContactState.untouched(points, pair.body.signed_distance(points)[1]))

    def moved(self, place: Array, pair: ContactPair) -> PosedContact:
        """The same history with the body at another place and another regularisation."""
        return replace(self, place=place, pair=pair)

    def committed(self, displacement: Array) -> PosedContact:
        """The pair after a step was accepted at displacements (d, n) of the points."""
        return replace(self, state=self.at(displacement).commit(self.state, self.pair), begin=None)

    def grown(self, start: PosedContact, distance: float) -> PosedContact:
        """The pair after a step from ``start`` along ``distance`` in m, with the growth of its forces."""
        if distance == 0.0:
            return replace(self, growth=None, grown_over=0.0)
        pressure, tangential = self.state.pressure - start.state.pressure, self.state.tangential - start.state.tangential
        return replace(self, growth=ContactIterate(pressure / distance, tangential / distance), grown_over=distance)

    def expected(self, distance: float) -> PosedContact:
        """The pair with the multipliers that it should have further on by ``distance`` in m."""
        pressure, tangential = self.state.pressure, self.state.tangential
        if self.growth is not None:
            pressure = np.maximum(0.0, pressure + distance * self.growth.pressure)
            tangential = np.where(pressure > 0, tangential + distance * self.growth.tangential, 0.0)
        return replace(self, state=replace(self.state, pressure=pressure, tangential=tangential, multiplier=pressure))

    def warm_started(self, now: ContactTraction) -> PosedContact:
        """The pair for a solution whose first iterate has these forces."""
        return replace(self, begin=now.iterate())

    def holding(self, displacement: Array) -> PosedContact:
        """The pair with its forces and limits of friction at displacements (d, n) of the points: Newton starts from the forces,
        the limits stay."""
        now = self.at(displacement)
        return replace(self.warm_started(now), pair=self.pair.with_held_limit(now.pressure))

    def augmented(self, now: ContactTraction, share: float = 1.0) -> PosedContact:
        """The pair before the step, with a ``share`` of the forces ``now`` in its multipliers."""
        return replace(self, state=self.state.augmented(now, share))

    def on(self, surface: SurfaceAssembly, reference: Array, displacement: Array) -> PosedContact:
        """The same contact on the finer points of another mesh: forces interpolated along the surface, by the undeformed radius.

        ``displacement`` (2, m) are those of the new points at the accepted state.
        """
        old = np.argsort(self.reference[0])
        fields = np.vstack([self.state.pressure, self.state.tangential, self.state.creep + np.zeros_like(self.reference)])
        pressure, *others = (np.interp(reference[0], self.reference[0, old], values[old]) for values in fields)
        tangential, creep = np.split(np.array(others), 2)
        points = reference + displacement - self.place[:, None]
        normals = self.pair.body.signed_distance(points)[1]
        traction = tangential - np.einsum("in,in->n", tangential, normals) * normals
        state = ContactState(pressure, traction, points, normals, creep=creep)
        return replace(self, surface=surface, reference=reference, state=state)

    def gap(self, displacement: Array) -> Array:
        """Gap (n,) in m at displacements (d, n) of the points, negative where they are in the body."""
        return self.pair.body.signed_distance(self._points(displacement))[0]

    def at(self, displacement: Array) -> ContactTraction:
        """Contact that holds at displacements (d, n) of the points."""
        return self.pair.converged(self._points(displacement), self.state)

    def start(self) -> ContactIterate:
        """Newton starts from the forces of the last accepted step, or those of a solution to be made exact."""
        return self.pair.iterate(self.state) if self.begin is None else self.begin

    def iterate_at(self, displacement: Array) -> ContactIterate:
        """The forces that hold at displacements (d, n) of the points."""
        return self.at(displacement).iterate()

    def converged(self, displacement: Array) -> Array:
        """Traction (d, n) in Pa."""
        return self.at(displacement).traction

    def rounding(self, displacement: Array) -> Array:
        """Traction (n,) in Pa lost in the round-off of the positions, which the penalties magnify; none clear of the body."""
        along, across = np.abs(displacement).max(axis=0) + np.abs(self.place).max(), np.abs(self.reference).max(axis=0)
        gap = self.gap(displacement)
        lost = ROUND_OFF * (self.pair.penalty * along + self.pair.tangential_penalty * (along + across))
        return np.where((gap <= ROUND_OFF * (along + across)) | (self.state.multiplier > self.pair.penalty * gap), lost, 0.0)

    def linearised(self, displacement: Array, iterate: ContactIterate) -> ContactTraction:
        """Traction and derivative as the iterated forces decide."""
        return self.pair.linearised(self._points(displacement), self.state, iterate)

    def advanced(self, now: ContactTraction, iterate: ContactIterate, step: Array, damping: float) -> ContactIterate:
        """The iterated forces after a damped step."""
        full = self.pair.advanced(now, step)
        return ContactIterate(
            iterate.pressure + damping * (full.pressure - iterate.pressure),
            iterate.tangential + damping * (full.tangential - iterate.tangential),
        )

    def _points(self, displacement: Array) -> Array:
        return self.reference + displacement - self.place[:, None]
