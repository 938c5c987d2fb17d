"""What every inclusion offers to the mesher: closed bodies with exact surfaces, in the coordinates of the block."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from tactsim.errors import InvalidQuantity
from tactsim.interfaces import CaseKind
from tactsim.units import Length, format_quantity

Array = np.ndarray
Patch = Callable[[Array], tuple[Array, Array]]
"""A smooth piece of surface: for points (n, 3) in m their nearest points (n, 3) on it and its unit normals (n, 3) there."""
Triangles = tuple[Array, Array]
"""Vertices (n, 3) in m and triangles (m, 3) of a closed surface, outward oriented."""
Positive = Annotated[Length, Field(gt=0)]
Point = tuple[Length, Length, Length]
FACES = (("left", 0, 0), ("right", 0, 1), ("front", 1, 0), ("back", 1, 1), ("lower", 2, 0), ("upper", 2, 1))
"""Name, axis and end of every face of the block."""


class Solid(ABC):
    """A closed body.

    Attributes
    ----------
    patches : the smooth pieces of its surface, each continued beyond its edges
    """

    patches: tuple[Patch, ...]

    @abstractmethod
    def signed_distance(self, points: Array) -> Array:
        """Distance in m of points (n, 3) from the surface, negative inside."""

    @abstractmethod
    def triangles(self, edge: float) -> Triangles:
        """The surface in triangles of about this edge length in m, vertices on the surface."""

    @abstractmethod
    def volume(self) -> float:
        """Exact volume in m^3 of what lies in the block."""

    @abstractmethod
    def bounds(self) -> Array:
        """Lowest and highest coordinates (2, 3) in m."""

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie inside."""
        return self.signed_distance(points) < 0


class Inclusion(CaseKind):
    """A body in the block, or a hollow one."""

    package: ClassVar[str] = "tactsim.mesh.inclusions"

    @abstractmethod
    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The body in a block of size (3,) in m, and the empty space in it if it is hollow."""

    def refine(self, wanted: float) -> float:
        """Element size in m near the body if ``wanted`` is what a thick body gets."""
        return wanted

    def identity(self) -> str:
        """Text that changes with the geometry."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    def check_in_block(self, size: Array, gap: float, name: str) -> None:
        """Refuse a body that protrudes or comes nearer to a face than ``gap`` in m.

        Raises
        ------
        InvalidQuantity
            Naming the inclusion, the face and the distance.
        """
        check_bounds(self.solids(size)[0].bounds(), size, gap, name)


def check_bounds(bounds: Array, size: Array, gap: float, name: str) -> None:
    """Refuse bounds (2, 3) that leave a block of size (3,) or come nearer to a face than ``gap``, all in m.

    Raises
    ------
    InvalidQuantity
        Naming the body, the face and the least distance.
    """
    for face, axis, end in FACES:
        distance = float(size[axis] - bounds[1, axis] if end else bounds[0, axis])
        if distance < gap:
            place = (
                f"protrudes by {format_quantity(-distance, 'm')} through"
                if distance < 0
                else f"is {format_quantity(distance, 'm')} from"
            )
            raise InvalidQuantity(
                f"{name} {place} the {face} face; allowed: at least {format_quantity(gap, 'm')} inside the block"
            )


def plane_patch(axis: int, value: float) -> Patch:
    """The plane where a coordinate has a value in m."""
    normal = np.eye(3)[axis]

    def project(points: Array) -> tuple[Array, Array]:
        nearest = np.array(points, float)
        nearest[:, axis] = value
        return nearest, np.broadcast_to(normal, nearest.shape)

    return project


def outward(vertices: Array, triangles: Array, centre: Array) -> Array:
    """Triangles (m, 3) of a surface that is star-shaped about ``centre``, turned outward."""
    a, b, c = (vertices[triangles[:, k]] - centre for k in range(3))
    inward = np.einsum("fi,fi->f", np.cross(b - a, c - a), a) < 0
    turned = triangles.copy()
    turned[inward] = turned[inward][:, [0, 2, 1]]
    return turned
