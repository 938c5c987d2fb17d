"""What the planes of symmetry of a body ask of its material, its loads and its rigid bodies: each to be its own mirror image."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tactsim.array import Array
from tactsim.contact.mirrored import body_mirrors
from tactsim.errors import InputError
from tactsim.experiments.boundary_value.conditions import (
    SIDES,
    AnyCondition,
    BodyForceCondition,
    ContactCondition,
    FaceCondition,
    ForceCondition,
    PressureCondition,
    TractionCondition,
)
from tactsim.experiments.boundary_value.parts import AT_NODE, Parts
from tactsim.interfaces import Material
from tactsim.materials.mirrored import check_in_plane, law_mirrors

ELSEWHERE = "take a geometry without this plane, such as part: whole of a round body"


def check_material(parts: Parts, key: str, material: Material) -> None:
    """Check that the planes of symmetry, and that of a section, mirror the material that stands at a ``key``.

    Raises
    ------
    ValueError
        If one does not.
    """
    if parts.dimension != "3d":
        try:
            check_in_plane(material)
        except InputError as error:
            raise ValueError(f"{key}: {error}") from None
    for name, axis in parts.domain.mirrors.items():
        if not law_mirrors(material, axis):
            raise ValueError(
                f"{key}: {material.kind} is not its own mirror image across {name}, where the part computed ends; "
                "take a geometry without this plane, such as part: whole, or turn the axes of the material"
            )


def check_load(parts: Parts, condition: AnyCondition) -> None:
    """Check that a load acts on a surface of the body, and that it and its mirror images are one load.

    A force per area across a plane of symmetry changes its sign there: on a face that meets the plane it would pull the body and
    its image apart, or press them together, instead of shearing them.

    Raises
    ------
    ValueError
        If they are not; the message begins with the key that is to blame.
    """
    if not isinstance(condition, BodyForceCondition | PressureCondition | TractionCondition | ForceCondition):
        return
    for name, axis in parts.domain.mirrors.items():
        if isinstance(condition, FaceCondition) and condition.face == name:
            raise ValueError(f"face: {name} is a plane of symmetry inside the body, on which nothing acts from outside")
        if isinstance(condition, PressureCondition) or not condition.along(parts.axes).get(axis):
            continue
        along = parts.axes[axis]
        if isinstance(condition, BodyForceCondition):
            raise ValueError(
                f"{along}: {name} is a plane of symmetry, and such a force is not its own mirror image there; "
                "leave it out, or take a geometry without this plane"
            )
        if len(_nodes_on_plane(parts, condition, axis)):
            raise ValueError(
                f"{along}: {condition.face} meets {name}, a plane of symmetry, and such a {condition.kind} is not its own mirror "
                f"image there; {ELSEWHERE}, or load a part of the face that ends beside the plane"
            )


def check_contact(parts: Parts, condition: ContactCondition, body_at: Callable[[Array], Array]) -> None:
    """Check that a rigid body and its mirror images are one body, or do not meet.

    ``body_at`` gives the signed distance (n,) in m of the body at its first touch from points (d, n) in m.

    Raises
    ------
    ValueError
        If they are two that meet; the message begins with the key that is to blame.
    """
    along = np.array(SIDES[parts.dimension][condition.side])
    moved = np.reshape([motion.vector(parts.axes) for motion in condition.moving.values()], (-1, len(along))).sum(axis=0)
    for name, axis in parts.domain.mirrors.items():
        if condition.face == name:
            raise ValueError(f"face: {name} is a plane of symmetry inside the body, which no rigid body touches")
        on_plane = _nodes_on_plane(parts, condition, axis)
        stands_on_plane = not along[axis] and (condition.at is None or condition.at[axis] == 0)
        reaches = len(on_plane) and min(body_at(on_plane.T - shift).min() for shift in (0.0, moved[:, None])) < 0
        if not (stands_on_plane or reaches):
            continue
        for key, motion in condition.moving.items():
            if motion.along(parts.axes).get(axis):
                raise ValueError(
                    f"{key}{parts.axes[axis]}: {name} is a plane of symmetry, and the {condition.body.kind} that moves across it "
                    f"meets its own mirror image there; {ELSEWHERE}"
                )
        if not body_mirrors(body_at, axis, parts.size, len(along)):
            raise ValueError(
                f"body: {condition.body.kind} is not its own mirror image across {name}, where the part computed ends, and meets "
                f"it there; {ELSEWHERE}"
            )


def _nodes_on_plane(parts: Parts, condition: FaceCondition, axis: int) -> Array:
    """Places (n, d) in m of the nodes of the face of a condition that lie on the plane of symmetry normal to an axis."""
    nodes = parts.domain.mesh.nodes[np.unique(parts.facets(condition))]
    return np.asarray(nodes[np.abs(nodes[:, axis]) <= AT_NODE * parts.size])
