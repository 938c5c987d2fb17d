"""A lump in the shape of a sphere."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import Point, Solid
from tactsim.mesh.inclusions.ellipsoid import EllipsoidSolid
from tactsim.units import Length, Positive


class Sphere(Inclusion):
    """A sphere wholly inside the block.

    >>> import tactsim as ts
    >>> ts.Sphere(center=("20 mm", "20 mm", "12 mm"), radius="4 mm")
    Sphere(kind='sphere', center=(0.02, 0.02, 0.012), radius=0.004)
    """

    kind: Literal["sphere"] = "sphere"
    data_set_number: ClassVar[int | None] = 1
    center: Point
    """Centre, from the corner of the block: along the columns, along the rows, and from the lower jaw."""
    radius: Positive[Length]
    """Radius."""

    @classmethod
    def example(cls) -> Self:
        """The lump of the thesis' section 6.5 in the middle of the default block."""
        return cls(center=(20e-3, 20e-3, 10e-3), radius=5e-3)

    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The ball, whatever the size (3,) of the block."""
        return (Ball(np.array(self.center), self.radius),)


class Ball(EllipsoidSolid):
    """An ellipsoid with equal axes, whose nearest points have a closed form."""

    def __init__(self, center: Array, radius: float):
        super().__init__(center, np.full(3, radius), np.eye(3))
        self.radius = radius

    def project(self, points: Array) -> tuple[Array, Array]:
        """Nearest points and outward normals, both (n, 3); the centre goes to the top."""
        offset = points - self.center
        reach = np.linalg.norm(offset, axis=1, keepdims=True)
        normal = np.where(reach > 0, offset / np.where(reach > 0, reach, 1.0), np.eye(3)[2])
        return self.center + self.radius * normal, normal

    def signed_distance(self, points: Array) -> Array:
        """Distance (n,) in m of points (n, 3), negative inside."""
        return np.linalg.norm(points - self.center, axis=1) - self.radius
