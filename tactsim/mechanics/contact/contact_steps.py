"""What a contact takes with it: from one augmentation to the next, over an accepted step, and to another mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.traction import ContactIterate, ContactState, ContactTraction
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.mechanics.contact.posed_contact import PosedContact


def expected(contact: PosedContact, distance: float) -> PosedContact:
    """The contact with the multipliers that it should have further on by ``distance`` in m."""
    pressure, tangential = contact.state.pressure, contact.state.tangential
    if contact.growth is not None:
        pressure = np.maximum(0.0, pressure + distance * contact.growth.pressure)
        tangential = np.where(pressure > 0, tangential + distance * contact.growth.tangential, 0.0)
    return replace(contact, state=replace(contact.state, pressure=pressure, tangential=tangential, multiplier=pressure))


def begun_from(contact: PosedContact, now: ContactTraction) -> PosedContact:
    """The contact for a solution whose first iterate has these forces."""
    return replace(contact, begin=now.iterate())


def held(contact: PosedContact, displacement: Array) -> PosedContact:
    """The contact with its forces and limits of friction at displacements (d, n) of the points: Newton starts from the forces,
    the limits stay."""
    now = contact.at(displacement)
    return replace(begun_from(contact, now), pair=contact.pair.with_held_limit(now.pressure))


def augmented(contact: PosedContact, now: ContactTraction, share: float = 1.0) -> PosedContact:
    """The contact before the step, with a ``share`` of the forces ``now`` in its multipliers."""
    return replace(contact, state=contact.state.augmented(now, share))


def accepted(contact: PosedContact, displacement: Array) -> PosedContact:
    """The contact after a step was accepted at displacements (d, n) of the points."""
    return replace(contact, state=contact.at(displacement).commit(contact.state, contact.pair), begin=None)


def grown(contact: PosedContact, start: PosedContact, distance: float) -> PosedContact:
    """The contact after a step from ``start`` along ``distance`` in m, with the growth of its forces."""
    if distance == 0.0:
        return replace(contact, growth=None, grown_over=0.0)
    pressure = contact.state.pressure - start.state.pressure
    tangential = contact.state.tangential - start.state.tangential
    return replace(contact, growth=ContactIterate(pressure / distance, tangential / distance), grown_over=distance)


def transferred(contact: PosedContact, surface: SurfaceAssembly, reference: Array, displacement: Array) -> PosedContact:
    """The same contact on the finer points of another mesh: forces interpolated along the surface, by the undeformed radius.

    Parameters
    ----------
    surface, reference : the new points and where they are undeformed (2, m) in m
    displacement : (2, m) in m of the new points at the accepted state
    """
    old = np.argsort(contact.reference[0])
    fields = np.vstack([contact.state.pressure, contact.state.tangential, contact.state.creep + np.zeros_like(contact.reference)])
    pressure, *others = (np.interp(reference[0], contact.reference[0, old], values[old]) for values in fields)
    tangential, creep = np.split(np.array(others), 2)
    points = reference + displacement - contact.place[:, None]
    normals = contact.pair.body.signed_distance(points)[1]
    traction = tangential - np.einsum("in,in->n", tangential, normals) * normals
    state = ContactState(pressure, traction, points, normals, creep=creep)
    return replace(contact, surface=surface, reference=reference, state=state)
