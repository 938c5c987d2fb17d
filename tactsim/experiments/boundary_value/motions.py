"""What the conditions of a problem prescribe of the displacement, as motions of nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.experiments.boundary_value.conditions import (
    AnyCondition,
    BodyForceCondition,
    ClampCondition,
    Condition,
    DisplacementCondition,
    FaceCondition,
    PointCondition,
    RotationCondition,
)
from tactsim.experiments.boundary_value.parts import AT_NODE, Parts
from tactsim.mechanics.models.prescribed_motion import PrescribedMotion, Rotation, Sliding, Translation


@dataclass(frozen=True)
class Held:
    """A motion; ``condition`` is what moves it, None if nothing does, and ``face`` what it holds, None if that is no face."""

    motion: PrescribedMotion
    condition: Condition | None
    face: str | None


def motions_of(parts: Parts, conditions: Sequence[AnyCondition]) -> list[Held]:
    """Every motion: those of the symmetry of the whole first, then those of the conditions.

    Raises
    ------
    ValueError
        If a condition names what the body does not have; the message begins with its key.
    """
    mesh, held = parts.domain.mesh, []
    for name, axis in parts.domain.mirrors.items():
        unknowns = _unknowns(mesh.dim, parts.face(name), axis)
        held.append(Held(Translation(f"the symmetry about {name}", unknowns, 0.0), None, name))
    if parts.axes[0] == "r" and (on_axis := np.flatnonzero(mesh.nodes[:, 0] == 0.0)).size:
        held.append(Held(Translation("the symmetry about the axis", mesh.dim * on_axis, 0.0), None, None))
    for number, condition in enumerate(conditions):
        try:
            new = _prescribed(f"condition {number + 1} ({condition.kind})", condition, parts)
        except ValueError as error:
            raise ValueError(f"conditions.{number}.{error}") from None
        face = condition.face if isinstance(condition, FaceCondition) else None
        held += [Held(motion, condition, face) for motion in new]
    return held


def _prescribed(name: str, condition: AnyCondition, parts: Parts) -> list[PrescribedMotion]:
    """What a condition prescribes of the displacement; nothing if it is a load."""
    mesh = parts.domain.mesh
    if isinstance(condition, BodyForceCondition):
        return []
    if isinstance(condition, PointCondition):
        node = parts.node(condition.at)
        given = condition.along(parts.axes)
        return [Translation(name, np.array([mesh.dim * node + axis]), value) for axis, value in given.items()]
    facets = parts.facets(condition)
    if isinstance(condition, DisplacementCondition):
        given, slopes, places = condition.along(parts.axes), condition.slopes_along(parts.axes), mesh.nodes[np.unique(facets)]
        return [
            Translation(name, _unknowns(mesh.dim, facets, axis), value + places @ slopes[axis]) for axis, value in given.items()
        ]
    if isinstance(condition, ClampCondition):
        return [Translation(name, _unknowns(mesh.dim, facets, axis), 0.0) for axis in range(mesh.dim)]
    if isinstance(condition, RotationCondition):
        turned = _turned(name, condition, parts)
        if mesh.dim == 2 or condition.axial == "free":
            return turned
        return [*turned, Translation(f"{name} along z, axial: held,", _unknowns(mesh.dim, facets, 2), 0.0)]
    return []


def _turned(name: str, condition: RotationCondition, parts: Parts) -> list[PrescribedMotion]:
    """What a rotation prescribes in the plane of the first two axes."""
    mesh, facets = parts.domain.mesh, parts.facets(condition)
    nodes = np.unique(facets)
    arms = mesh.nodes[nodes, :2] - condition.about
    if condition.sliding == "none":
        return [Rotation(name, mesh.dim * nodes, arms, condition.angle)]
    if condition.sliding == "in_plane":
        normals = np.tile(_normal(condition, parts), (len(nodes), 1))
        return [Sliding(name, mesh.dim * nodes, arms, normals, condition.angle)]
    radius = np.hypot(*arms.T)
    off = radius > AT_NODE * parts.size
    normals = np.column_stack([-arms[off, 1], arms[off, 0]]) / radius[off, None]
    return [
        Rotation(name, mesh.dim * nodes[~off], arms[~off], condition.angle),
        Sliding(name, mesh.dim * nodes[off], arms[off], normals, condition.angle),
    ]


def _normal(condition: RotationCondition, parts: Parts) -> Array:
    """The normal (2,) of a flat face along z.

    Raises
    ------
    ValueError
        If it is not flat, or stands across the axis; the message begins with its key.
    """
    normals = parts.space.surface_points(parts.facets(condition)).normals
    if np.ptp(normals, axis=1).max() > AT_NODE:
        raise ValueError(
            f"sliding: the face {condition.face} is not flat, so that it has no plane to slide in; allowed: none, radial"
        )
    if abs(normals[:2, 0] @ normals[:2, 0] - 1) > AT_NODE:
        raise ValueError(
            f"sliding: the plane of {condition.face} stands across the axis, so that nothing would turn what slides in it; "
            "allowed: none, radial"
        )
    return np.asarray(normals[:2, 0])


def _unknowns(dim: int, facets: Array, axis: int) -> Array:
    """Numbers of the unknowns of one axis at the nodes of facets."""
    return dim * np.unique(facets) + axis
