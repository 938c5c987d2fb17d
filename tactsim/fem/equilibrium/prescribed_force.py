"""Interfaces under load control: their common rigid displacement is one more unknown, bordered onto Newton's system.

A traction depends on a point's place relative to its body, so a rigid displacement acts like the opposite one of all points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import TooShort
from tactsim.fem.assembly.external_forces import LinearisedContact
from tactsim.fem.assembly.surface import SurfaceAssembly

TOUCH = 1e-6
"""Penetration at first touch, as a part of the distance of the touching point from the middle of the body."""
LARGEST_ROUND_OFF = 1e-2
"""Round-off of the contact force over the prescribed force, beyond which the answer is refused."""


@dataclass(frozen=True)
class Border:
    """What a prescribed force adds to the linear system.

    ``column`` (size,): nodal forces per rigid displacement, on the right-hand side; ``row`` (size,): derivative of the force by
    the unknowns; ``slope``: its derivative by the rigid displacement, with the sign turned; ``missing``: missing force in N;
    ``approach``: rigid displacement in m after which a first point would touch.
    """

    column: Array
    row: Array
    slope: float
    missing: float
    approach: float

    def displacement_step(self, step: Array, along: Array) -> float:
        """Step of the rigid displacement in m, from the step of the unknowns at rest and their step per displacement.

        ``step`` and ``along`` are (size,). To the touch if nothing touches yet.
        """
        if self.slope == 0.0:
            return self.approach
        return float((self.missing - self.row @ step) / (self.row @ along - self.slope))


@dataclass(frozen=True)
class PrescribedForce:
    """A force in N that the interfaces together exert, each along its own unit vector (d,) of ``directions``; their
    common displacement along these follows."""

    directions: tuple[Array, ...]
    force: float

    def border(self, surfaces: Sequence[SurfaceAssembly], now: Sequence[LinearisedContact]) -> Border:
        """The border of the linear system for contacts with ``traction`` and ``derivative`` on their surfaces."""
        slope, missing = 0.0, self.force
        column, row = np.zeros(surfaces[0].size), np.zeros(surfaces[0].size)
        for surface, contact, e in zip(surfaces, now, self.directions, strict=True):
            along = np.einsum("ijn,j->in", contact.derivative, e)
            column -= surface.force(along)
            row += surface.force(np.einsum("i,ijn->jn", e, contact.derivative))
            slope += float(e @ surface.total(along))
            missing -= float(e @ surface.total(contact.traction))
        return Border(column, row, slope, missing, min(map(_approach, now)))

    def error(
        self, surfaces: Sequence[SurfaceAssembly], tractions: Sequence[Array], noise: Sequence[Array], tolerance: float
    ) -> float:
        """Missing force over the prescribed one, or over the round-off of the tractions as a part of the tolerance.

        Of each surface the traction is (d, n), its ``noise`` (n,), both in Pa.

        Raises
        ------
        TooShort
            If round-off hides the force.
        """
        missing, lost = self.force, 0.0
        for surface, traction, uncertain, direction in zip(surfaces, tractions, noise, self.directions, strict=True):
            missing -= float(direction @ surface.total(traction))
            lost += float(uncertain @ surface.points.weights)
        if lost > LARGEST_ROUND_OFF * abs(self.force):
            raise TooShort(
                f"the round-off of the contact, {lost:.1e} N, hides the prescribed force of {self.force:.1e} N; "
                "allow more penetration (penetration_tolerance)"
            )
        return abs(missing) / max(abs(self.force), lost / tolerance)


def _approach(contact: LinearisedContact) -> float:
    """Displacement in m that brings a body into touch with the point nearest to it, and a little further."""
    nearest = int(contact.gap.argmin())
    return float(contact.gap[nearest] + TOUCH * np.abs(contact.points[:, nearest]).max())
