"""What a contact takes with it: from one augmentation to the next, over an accepted step, and to another mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.penalty import Regularisation
from tactsim.contact.traction import ContactIterate, ContactState, ContactTraction
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.mechanics.contact.first_touch import distance_to_touch
from tactsim.mechanics.contact.posed_contact import PosedContact

MOST_APPROACHES = 100
"""Steps of a free approach, each as long as the gap; where they end before touch the rest counts as slip."""


def touching(
    contacts: Sequence[PosedContact], nodes: Array, directions: Sequence[Array]
) -> tuple[tuple[PosedContact, ...], float]:
    """Contacts of which none presses, moved on along their unit vectors until one touches, and by how many m.

    ``nodes`` (n, d) are the displacements of the body's nodes in m.

    Why: what a body covers before it touches is no slip. On a slope its part along the surface would be taken for one, and the
    friction against it outweigh the first small force of a prescribed ramp, so that the point opens and closes in turns.
    """
    if any(contact.state.pressure.any() for contact in contacts):
        return tuple(contacts), 0.0
    bodies = [
        (contact.pair.body, contact.reference + contact.surface.points.interpolate(nodes) - contact.place[:, None], e[:, None])
        for contact, e in zip(contacts, directions, strict=True)
    ]
    size = max(float(np.abs(points).max()) for _, points, _ in bodies)

    def gap_after(distance: float) -> float:
        return min(float(body.signed_distance(points - distance * along)[0].min()) for body, points, along in bodies)

    distance, _ = distance_to_touch(gap_after, size, MOST_APPROACHES)
    if distance == 0.0:
        return tuple(contacts), 0.0
    moved = []
    for contact, (body, points, along) in zip(contacts, bodies, strict=True):
        now = points - distance * along
        state = ContactState.untouched(now, body.signed_distance(now)[1])
        moved.append(replace(contact, place=contact.place + distance * along[:, 0], state=state, growth=None, grown_over=0.0))
    return tuple(moved), distance


def expected(contact: PosedContact, distance: float) -> PosedContact:
    """The contact with the multipliers that it should have further on by ``distance`` in m."""
    pressure, tangential = contact.state.pressure, contact.state.tangential
    if contact.growth is not None:
        pressure = np.maximum(0.0, pressure + distance * contact.growth.pressure)
        tangential = np.where(pressure > 0, tangential + distance * contact.growth.tangential, 0.0)
    return replace(contact, state=replace(contact.state, pressure=pressure, tangential=tangential, multiplier=pressure))


def continued(contact: PosedContact, regularisation: Regularisation) -> PosedContact:
    """The contact with the multipliers under which its points press as they do, with the penetration that they have."""
    state, pair = contact.state, regularisation.applied(contact.pair, contact.state)
    kept = pair.penalty * pair.body.signed_distance(state.points)[0]
    multiplier = np.where(state.pressure > 0, state.pressure + kept, np.minimum(kept, 0.0))
    return replace(contact, state=replace(state, multiplier=multiplier))


def begun_from(contact: PosedContact, now: ContactTraction) -> PosedContact:
    """The contact for a solution whose first iterate has these forces."""
    return replace(contact, begin=now.iterate())


def held(contact: PosedContact, displacement: Array) -> PosedContact:
    """The contact with its forces and limits of friction at displacements (d, n) of the points: Newton starts from the forces,
    the limits stay."""
    now = contact.at(displacement)
    return replace(begun_from(contact, now), pair=contact.pair.with_held_limit(now.pressure))


def lying_on(contact: PosedContact) -> PosedContact:
    """The contact of a face all of which touches, for a first iterate in which all points press, however little.

    Why: what touches without a force counts as open, so that Newton's first tangent does not know the body that a block lies on.
    Where loads alone press it there, they would throw it aside by metres.
    """
    pressure = np.full(contact.reference.shape[1], np.finfo(float).tiny)
    return replace(contact, begin=ContactIterate(pressure, np.zeros_like(contact.reference)))


def augmented(contact: PosedContact, now: ContactTraction) -> PosedContact:
    """The contact before the step, with the forces ``now`` as its multipliers."""
    return replace(contact, state=contact.state.augmented(now), begin=None)


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


def moved_on(
    contacts: Sequence[PosedContact], distance: float, directions: Sequence[Array], regularisation: Regularisation
) -> list[PosedContact]:
    """The contacts with their bodies moved on by ``distance`` in m, each along a unit vector (d,)."""
    return [
        replace(contact, place=contact.place + distance * direction, pair=regularisation.applied(contact.pair, contact.state))
        for contact, direction in zip(contacts, directions, strict=True)
    ]
