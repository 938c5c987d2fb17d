r"""How much force the penetration that is left costs, from what the contact itself knows.

The solution with penetration is the exact contact of a body whose surface is set back by the penetration, and whose sticking
points are set back by the distance that they crept along it. By reciprocity for the next increment of the motion d (Betti 1872),

.. math:: F_{exact} - F = \int \delta \frac{\partial p}{\partial d} - s \cdot \frac{\partial \tau}{\partial d}\, dA

with penetration delta, creep s, pressure p and friction tau on the tissue. For a response that is linear in d the ratio to the
exact force is the part of it that is missing; to a prescribed force the same number is the relative error of the displacement.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.contact.traction import ContactIterate
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact

LEAST_SHARE = 0.01
"""Last step over the whole displacement below which the growth of the pressure over it is more round-off than growth."""


def bonded_block_rate(shear_modulus: float, size: Sequence[float]) -> float:
    r"""Growth in Pa/m of the pressure on a block of ``size`` (3,) in m between bonded plates along z, per closing of each plate.

    .. math:: \frac{6 G (1 + 2 S^2)}{h}, \quad S = \frac{a b}{2 h (a + b)}

    Source: Gent & Lindley 1959, doi:10.1243/PIME_PROC_1959_173_022_02 (incompressible blocks bonded to plates).
    """
    width, depth, height = size
    shape = width * depth / (2 * height * (width + depth))
    return 6 * shear_modulus * (1 + 2 * shape**2) / height


@dataclass(frozen=True)
class PenetrationEffect:
    """The part of the true force that penetration and creep take away in the last of some states of a run.

    Attributes
    ----------
    stiffest : in Pa/m, bounds the growth of the pressure where other loads than the motion make pressure too
    share : the missing part of the force, over the largest force so far, from 0 to 1
    stiffening : growth of the forces over that in proportion to the displacement, as far as it is known
    largest_force : of all states, in N
    """

    stiffest: float = math.inf
    share: float = 0.0
    stiffening: float = 1.0
    largest_force: float = 0.0

    def after(self, state: ContactEquilibrium) -> PenetrationEffect:
        """The effect in the next state."""
        largest = max(self.largest_force, sum(map(_force, state.contacts)))
        if not largest > 0:
            return self
        secant = sum(_missing(contact, _secant(contact, state.load, self.stiffest)) for contact in state.contacts)
        stiffening = self.stiffening
        if secant > 0 and math.isinf(self.stiffest) and _pushed_on(state):
            grown = sum(_missing(contact, contact.growth) for contact in state.contacts)
            stiffening = max(1.0, _exponent(grown / secant, state.contacts[0].grown_over / state.load))
        share = min(1.0, stiffening * secant / largest)
        return PenetrationEffect(self.stiffest, share, stiffening, largest)


def _pushed_on(state: ContactEquilibrium) -> bool:
    """Whether the last step moved the bodies so far into the tissue that the growth of the forces is known."""
    return all(c.growth is not None and c.grown_over >= LEAST_SHARE * state.load for c in state.contacts)


def _exponent(growth: float, step: float) -> float:
    """Slope of a power law over its secant, from that over its last ``step``, a part of the way."""
    before = 1 - growth * step
    return math.log(before) / math.log1p(-step) if 0 < before < 1 and step < 1 else growth


def _secant(contact: PosedContact, load: float, stiffest: float) -> ContactIterate:
    """Growth of the forces in Pa/m as if they had grown in proportion to the displacement."""
    pressure = contact.state.pressure
    growth = np.minimum(pressure / load, stiffest) if load > 0 else np.where(pressure > 0, stiffest, 0.0)
    growth = np.where(np.isfinite(growth), growth, 0.0)
    return ContactIterate(growth, contact.state.tangential * (growth / np.where(pressure > 0, pressure, 1.0)))


def _missing(contact: PosedContact, growth: ContactIterate | None) -> float:
    """The force in N that penetration and creep take away if the contact forces grow like this."""
    if growth is None:
        return 0.0
    state, weights = contact.state, contact.surface.points.weights
    penetration = np.where(state.pressure > 0, -contact.pair.body.signed_distance(state.points)[0], 0.0)
    creep = state.creep * growth.tangential
    return abs(float(weights @ (penetration * growth.pressure))) + abs(float(weights @ creep.sum(axis=0)))


def _force(contact: PosedContact) -> float:
    """Largest component in N of the force on the body: bodies move along an axis, and what acts around an axis of revolution adds
    up to less."""
    return float(np.abs(contact.surface.total(contact.state.traction)).max())
