"""Where a rigid body of a problem first touches its face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.contact.turned import Turned
from tactsim.experiments.boundary_value.conditions import SIDES, ContactCondition
from tactsim.experiments.boundary_value.parts import Parts
from tactsim.fem.assembly.space import SurfacePoints
from tactsim.interfaces import RigidBody
from tactsim.mechanics.contact.first_touch import FAR, first_touch


@dataclass(frozen=True)
class Touch:
    """A rigid body at its ``place`` (d,) in m of first touch; ``reference`` (d, n) in m are the undeformed ``points``."""

    body: RigidBody
    points: SurfacePoints
    reference: Array
    place: Array

    def distance(self, places: Array) -> Array:
        """Signed distance (n,) in m of the body, before it moves on, from places (d, n) in m."""
        return self.body.signed_distance(places - self.place[:, None])[0]


def touch_of(parts: Parts, condition: ContactCondition) -> Touch:
    """Where the rigid body of a condition touches.

    Raises
    ------
    ValueError
        If it passes beside the face; the message begins with the key that is to blame.
    """
    mesh, facets = parts.domain.mesh, parts.facets(condition)
    points = parts.space.surface_points(facets)
    axis = SIDES[parts.dimension][condition.side]
    body = condition.body if axis[-1] == 1.0 else Turned.of(condition.body, axis)
    away, origin = np.array(axis), np.zeros(mesh.dim) if condition.at is None else np.array(condition.at)
    nodes = mesh.nodes[np.unique(facets)].T
    reference = points.interpolate(mesh.nodes)
    begin = origin + (FAR * parts.size + float((away @ nodes).max()) - away @ origin) * away
    place = first_touch(body, np.hstack([nodes, reference]), begin=begin, direction=-away, size=parts.size)
    if place is None:
        raise ValueError(f"at: the {condition.body.kind} that comes from the {condition.side} does not meet {condition.face}")
    return Touch(body, points, reference, place)
