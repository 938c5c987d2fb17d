"""Contact and friction traction at surface points against one rigid body.

The contact pressure (per reference area) is ``max(0, -penalty * gap)`` with a penalty so stiff that the penetration stays below
a stated tolerance. Friction is the return mapping of Simo & Laursen 1992 (doi:10.1016/0045-7949(92)90540-G): an elastic trial
traction from the slip since the last accepted step, cut back to the friction limit.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import ContactLaw, RigidBody

Record = TypeVar("Record", "ContactState", "ContactIterate", "ContactPair")

AT_LIMIT = 1e-9
"""A point slips if its tangential traction is within this part of the limit."""

PROBED = (1.0, 1e3, 1e6, 1e9)
"""Pressures in Pa at which a law is asked whether it has friction: one may begin at a threshold."""


@dataclass(frozen=True)
class ContactState:
    """What the last accepted step left at n surface points, in the body's frame.

    ``pressure`` (n,) and ``tangential`` (d, n) traction in Pa, ``points`` (d, n) positions in m,
    ``normals`` (d, n) of the rigid body there, ``multiplier`` (n,) pressure in Pa without any penetration, ``creep`` (d, n)
    elastic slip in m since the point touched, summed over the steps in which friction held it; exact stick has none.
    """

    pressure: Array
    tangential: Array
    points: Array
    normals: Array
    multiplier: Array | float = 0.0
    creep: Array | float = 0.0

    @property
    def traction(self) -> Array:
        """Traction (d, n) on the tissue in Pa."""
        return self.pressure * self.normals + self.tangential

    @classmethod
    def untouched(cls, points: Array, normals: Array) -> ContactState:
        """No contact yet; ``points`` (d, n) in m, ``normals`` (d, n)."""
        return cls(np.zeros(points.shape[1]), np.zeros_like(points), points, normals)

    def augmented(self, now: ContactTraction) -> ContactState:
        """The same step with the tractions of its last solution as multipliers (augmented Lagrangian)."""
        return ContactState(now.pressure, now.tangential, self.points, now.normal, now.pressure, self.creep)


@dataclass(frozen=True)
class ContactTraction:
    """Contact at n surface points: ``gap`` in m (negative is penetration), ``pressure`` and ``tangential`` traction on the
    tissue in Pa, ``normal`` of the body, ``derivative`` (d, d, n) of the whole traction with respect to the point in Pa/m,
    ``coupling`` the part of it that makes friction grow with the pressure.
    """

    gap: Array
    pressure: Array
    tangential: Array
    normal: Array
    points: Array
    derivative: Array
    coupling: Array

    @property
    def traction(self) -> Array:
        """Traction (d, n) on the tissue in Pa."""
        return self.pressure * self.normal + self.tangential

    def commit(self, before: ContactState, pair: ContactPair) -> ContactState:
        """The state that an accepted step from ``before`` leaves behind."""
        creep = np.where(self.pressure > 0, before.creep + self._sticking_displacement(before, pair), 0.0)
        return ContactState(self.pressure, self.tangential, self.points, self.normal, creep=creep)

    def iterate(self) -> ContactIterate:
        """Its tractions, as the first iterate of Newton."""
        return ContactIterate(self.pressure, self.tangential)

    def elastic_slip(self, state: ContactState, pair: ContactPair) -> Array:
        """Distance (n,) in m that sticking points have moved along the body since a state."""
        return np.asarray(np.linalg.norm(self._sticking_displacement(state, pair), axis=0))

    def _sticking_displacement(self, state: ContactState, pair: ContactPair) -> Array:
        """That displacement (d, n) in m, zero where a point does not stick."""
        displacement = self.points - state.points
        along = np.einsum("in,in->n", self.normal, displacement)
        held = (self.pressure > 0) & (
            np.linalg.norm(self.tangential, axis=0) < (1 - AT_LIMIT) * pair.traction_limit(self.pressure)
        )
        return np.where(held, displacement - along * self.normal, 0.0)


@dataclass(frozen=True)
class ContactIterate:
    """Contact tractions as separate unknowns of Newton: ``pressure`` (n,) and ``tangential`` (d, n) in Pa."""

    pressure: Array
    tangential: Array


@dataclass(frozen=True)
class ContactPair:
    """Tissue surface against one rigid body.

    ``penalty`` and ``tangential_penalty`` in Pa/m are regularisations, not properties of the tissue: the contact is closed to
    pressure / penalty and sticks to traction / tangential_penalty. They may be stiff because the contact tractions are separate
    unknowns of Newton, updated by their linearisation and condensed point by point (the mixed integration point method, Magisano,
    Leonetti & Garcea 2017, doi:10.1016/j.cma.2016.10.023); ``switch_stiffness`` in Pa/m weighs violated kinematics against forces
    when the state of a point is decided (primal-dual active set, Hüeber, Stadler & Wohlmuth 2008, doi:10.1137/060671061).
    ``friction_mask`` is 0 at points where the contact is frictionless whatever the law, 1 elsewhere. ``held_limit`` (n,) in Pa,
    if given, limits the tangential traction independently of the pressure (Tresca friction).
    """

    body: RigidBody
    law: ContactLaw
    penalty: Array | float = 1.0
    tangential_penalty: Array | float = 1.0
    switch_stiffness: float = 1.0
    friction_mask: Array | float = 1.0
    held_limit: Array | None = None

    def with_penalty(self, penalty: Array | float, tangential_penalty: Array | float, switch_stiffness: float) -> ContactPair:
        """The same pair with other penalties and another switch stiffness, all in Pa/m, the penalties of all points or (n,)."""
        return replace(self, penalty=penalty, tangential_penalty=tangential_penalty, switch_stiffness=switch_stiffness)

    def traction_limit(self, pressure: Array) -> Array:
        """Largest tangential traction (n,) in Pa under pressures (n,) in Pa."""
        if self.held_limit is not None:
            return self.held_limit
        return np.where(self.friction_mask == 0, 0.0, self.law.traction_limit(pressure))

    @property
    def has_friction(self) -> bool:
        """Whether friction may act at any point."""
        return any(self.traction_limit(np.full(1, pressure)).any() for pressure in PROBED)

    def limit_slope(self, pressure: Array) -> Array:
        """Derivative (n,) of the limit with respect to the pressure, dimensionless."""
        if self.held_limit is not None:
            return np.zeros_like(pressure)
        return self.friction_mask * self.law.traction_limit_slope(pressure)

    def with_held_limit(self, pressure: Array) -> ContactPair:
        """The same pair with the limits at pressures (n,) in Pa kept whatever the pressure becomes."""
        return replace(self, held_limit=self.traction_limit(pressure))

    def converged(self, points: Array, state: ContactState) -> ContactTraction:
        """Traction at points (d, n) in m by the return mapping, as at the end of a step."""
        gap, normal, hessian = self.body.signed_distance(points)
        pressure = np.maximum(0.0, state.multiplier - self.penalty * gap)
        trial, _ = self._elastic_trial(points, normal, hessian, state)
        none = np.zeros((len(points), *points.shape))
        return ContactTraction(gap, pressure, self.within_limit(trial, pressure), normal, points, none, none)

    def within_limit(self, tangential: Array, pressure: Array) -> Array:
        """Tangential traction (d, n) in Pa, cut back to its limit under pressures (n,) in Pa."""
        limit = np.where(pressure > 0, self.traction_limit(pressure), 0.0)
        size = np.linalg.norm(tangential, axis=0)
        return np.where(size > limit, limit / np.where(size > 0, size, 1.0), 1.0) * tangential

    def linearised(self, points: Array, state: ContactState, iterate: ContactIterate) -> ContactTraction:
        """Traction and derivative at points (d, n), each point open, sticking or slipping as the iterate decides.

        The pressure of a closed point may become negative during the iterations; the point opens in the next one. The traction of
        a slipping point has the direction of its elastic trial, unless that opposes the traction of the iterate.
        """
        gap, normal, hessian = self.body.signed_distance(points)
        closing = state.multiplier - self.penalty * gap
        closed = (iterate.pressure > 0) | (closing > 0)
        pressure = np.where(closed, closing, 0.0)
        weight = np.where(iterate.pressure > 0, iterate.pressure, np.maximum(pressure, 0.0))
        slope = np.where(closed, -self.penalty, 0.0) * normal
        trial, trial_slope = self._elastic_trial(points, normal, hessian, state)
        decider, decider_slope = self._decider(iterate.tangential, normal, hessian, trial, trial_slope)
        limit = self.traction_limit(weight)
        slips = closed & (np.linalg.norm(decider, axis=0) > limit)
        sticks = closed & ~slips
        forward = np.einsum("in,in->n", decider, trial) > 0
        decider, decider_slope = np.where(forward, trial, decider), np.where(forward, trial_slope, decider_slope)
        size = np.linalg.norm(decider, axis=0)
        direction = np.where(slips, decider / np.where(size > 0, size, 1.0), 0.0)
        across = np.eye(len(points))[:, :, None] - direction[:, None] * direction[None, :]
        spread = np.where(slips, limit, 0.0) / np.where(slips, size, 1.0)
        tangential_slope = spread * np.einsum("ijn,jkn->ikn", across, decider_slope) + np.where(sticks, trial_slope, 0.0)
        limit_slope = np.where(slips, self.limit_slope(weight), 0.0)
        coupling = limit_slope * direction[:, None] * slope[None, :]
        at_limit = np.where(slips, limit, 0.0) + limit_slope * (pressure - weight)
        tangential = np.where(slips, at_limit * direction, np.where(sticks, trial, 0.0))
        derivative = normal[:, None] * slope[None, :] + weight * hessian + (tangential_slope + coupling)
        return ContactTraction(gap, pressure, tangential, normal, points, derivative, coupling)

    def advanced(self, now: ContactTraction, step: Array) -> ContactIterate:
        """The iterate after moving the points by ``step`` (d, n), by the linearisation that ``now`` carries.

        The tangential part also gets what turns the pressure with the normal, p dn, though that is tangential by its direction
        alone: `_decider` and `linearised` turn the iterate anew. Newton needs fewer linear systems with it: 103, 237 and 109 for
        annulus_icf, annulus_convex and durometer_oo, and 107, 255 and 138 without.
        """
        along = np.einsum("in,in->n", now.normal, step)
        pressure = np.where(now.pressure != 0, now.pressure - self.penalty * along, 0.0)
        change = (
            np.einsum("ijn,jn->in", now.derivative, step) + self.penalty * np.where(now.pressure != 0, along, 0.0) * now.normal
        )
        return ContactIterate(np.maximum(pressure, 0.0), now.tangential + change)

    def _decider(self, previous: Array, normal: Array, hessian: Array, trial: Array, trial_slope: Array) -> tuple[Array, Array]:
        """Traction (d, n) whose size decides between stick and slip, and its derivative.

        It is the ``previous`` iterate's traction turned to the tangent plane, moved towards the elastic trial as the switch
        stiffness weighs it.
        """
        share = np.minimum(1.0, self.switch_stiffness / self.tangential_penalty)
        across = np.einsum("in,in->n", previous, normal)
        plane_slope = -across * hessian - normal[:, None] * np.einsum("in,ijn->jn", previous, hessian)[None, :]
        in_plane = previous - across * normal
        return in_plane + share * (trial - in_plane), (1 - share) * plane_slope + share * trial_slope

    def _elastic_trial(self, points: Array, normal: Array, hessian: Array, state: ContactState) -> tuple[Array, Array]:
        """Trial traction (d, n) if nothing slipped, and its derivative: the old one turned to the new tangent plane, minus
        the tangential penalty times the slip since then."""
        identity = np.eye(len(points))[:, :, None]
        displacement = points - state.points
        along = np.einsum("in,in->n", normal, displacement)
        slip = displacement - along * normal
        slip_slope = identity - normal[:, None] * normal[None, :]
        slip_slope = slip_slope - along * hessian - normal[:, None] * np.einsum("in,ijn->jn", displacement, hessian)[None, :]
        old, both = state.tangential, normal + state.normals
        cosine = np.maximum(1.0 + np.einsum("in,in->n", normal, state.normals), 1e-3)
        out_of_plane = np.einsum("in,in->n", old, normal)
        turned = old - out_of_plane / cosine * both
        d_out = np.einsum("in,ijn->jn", old, hessian)
        d_cosine = np.einsum("in,ijn->jn", state.normals, hessian)
        d_ratio = d_out / cosine - out_of_plane / cosine**2 * d_cosine
        turned_slope = -both[:, None] * d_ratio[None, :] - out_of_plane / cosine * hessian
        return turned - self.tangential_penalty * slip, turned_slope - self.tangential_penalty * slip_slope


def at_points(record: Record, points: Array) -> Record:
    """A record of a contact at some of its points, by their numbers (m,): the last axis of its arrays counts the points."""
    values = ((field.name, getattr(record, field.name)) for field in fields(record))
    chosen: dict[str, Any] = {name: value[..., points] for name, value in values if isinstance(value, np.ndarray)}
    return replace(record, **chosen)
