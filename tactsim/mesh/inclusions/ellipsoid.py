"""A lump in the shape of an ellipsoid."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
import scipy

from tactsim.analytic.sphere_points import sphere_points
from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import BallImage, Point, Solid, Triangles
from tactsim.mesh.solid import outward
from tactsim.units import Angle, Length, Positive

BISECTIONS = 110
"""Halvings of the bracket of the nearest point: down to round-off from any ratio of the axes."""
EQUILATERAL = np.sqrt(3) / 4
"""Area of an equilateral triangle over its squared edge."""


class Ellipsoid(Inclusion):
    """An ellipsoid wholly inside the block.

    >>> import tactsim as ts
    >>> lump = ts.Ellipsoid(center=("20 mm", "20 mm", "10 mm"), semi_axes=("6 mm", "5 mm", "4 mm"))
    >>> lump.semi_axes
    (0.006, 0.005, 0.004)
    """

    kind: Literal["ellipsoid"] = "ellipsoid"
    data_set_number: ClassVar[int | None] = 2
    center: Point
    """Centre, from the corner of the block: along the columns, along the rows, and from the lower jaw."""
    semi_axes: tuple[Positive[Length], Positive[Length], Positive[Length]]
    """Half the length of each axis before rotation."""
    rotation: tuple[Angle, Angle, Angle] = (0.0, 0.0, 0.0)
    """Angles of the rotations about the fixed axes x, y, z, in this order."""

    @classmethod
    def example(cls) -> Self:
        """A flat lump in the middle of the default block."""
        return cls(center=(20e-3, 20e-3, 10e-3), semi_axes=(6e-3, 5e-3, 4e-3), rotation=(0.0, 0.0, np.pi / 6))

    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The ellipsoid, whatever the size (3,) of the block."""
        turn = scipy.spatial.transform.Rotation.from_euler("xyz", self.rotation).as_matrix()
        return (EllipsoidSolid(np.array(self.center), np.array(self.semi_axes), turn),)


class EllipsoidSolid(Solid):
    r"""The ellipsoid ``|A^{-1} R^T (x - c)| <= 1`` with semi-axes A, rotation R (3, 3) and centre c.

    Raises
    ------
    InvalidQuantity
        If the semi-axes are not three positive lengths in m.
    """

    def __init__(self, center: Array, semi_axes: Array, turn: Array):
        if np.shape(semi_axes) != (3,) or not (np.isfinite(semi_axes).all() and (semi_axes > 0).all()):
            raise InvalidQuantity(f"the semi-axes {np.asarray(semi_axes).tolist()} m; allowed: three positive lengths")
        self.center, self.semi_axes, self.turn = center, semi_axes, turn
        self.patches = (self.project,)

    @property
    def stretch(self) -> Array:
        """Symmetric matrix (3, 3) in m that maps the unit ball onto the ellipsoid about its centre, without a twist."""
        return self.turn * self.semi_axes @ self.turn.T

    def ball_image(self) -> BallImage:
        """The ellipsoid itself."""
        return BallImage(self.center, self.stretch, float(self.semi_axes.max()))

    def project(self, points: Array) -> tuple[Array, Array]:
        """Nearest points and outward normals, both (n, 3)."""
        local = (points - self.center) @ self.turn
        near = nearest_on_ellipsoid(local, self.semi_axes)
        normal = near / self.semi_axes**2
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return near @ self.turn.T + self.center, normal @ self.turn.T

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie inside."""
        return np.linalg.norm((points - self.center) @ self.turn / self.semi_axes, axis=1) < 1

    def signed_distance(self, points: Array) -> Array:
        """Distance (n,) in m of points (n, 3), negative inside."""
        distance = np.linalg.norm(points - self.project(points)[0], axis=1)
        return np.where(self.inside(points), -distance, distance)

    def triangles(self, edge: float) -> Triangles:
        """Hull of the image of a spiral of points on the unit sphere, its edges at most about ``edge`` in m."""
        count = max(40, round(2 * np.pi * self.semi_axes.max() ** 2 / (EQUILATERAL * edge**2)))
        unit = sphere_points(count)
        faces = outward(unit, scipy.spatial.ConvexHull(unit).simplices, np.zeros(3))
        return unit * self.semi_axes @ self.turn.T + self.center, faces

    def volume(self) -> float:
        """Volume in m^3."""
        return float(4 / 3 * np.pi * self.semi_axes.prod())

    def bounds(self) -> Array:
        """Lowest and highest coordinates (2, 3) in m."""
        reach = np.linalg.norm(self.turn * self.semi_axes, axis=1)
        return np.array([self.center - reach, self.center + reach])


def nearest_on_ellipsoid(points: Array, semi_axes: Array) -> Array:
    r"""Nearest points (n, 3) in m on the ellipsoid with semi-axes a, aligned with the coordinates.

    The nearest point is :math:`x_i = a_i^2 y_i / (t + a_i^2)` where t is the largest root of
    :math:`\sum (a_i y_i/(t + a_i^2))^2 = 1`.

    Source: Eberly 2013, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", section 3.
    """
    scale = semi_axes.min()
    axes = semi_axes / scale
    excess = axes**2 - 1  # counted from the least axis, so that the root near its pole keeps its digits
    y = np.maximum(np.abs(points) / scale, 1e-14 * axes)  # off the planes of symmetry, where the root hides in a limit
    lower = (axes * y - excess).max(axis=1)
    upper = np.linalg.norm(axes * y, axis=1)
    for _ in range(BISECTIONS):
        middle = (lower + upper) / 2
        outside = ((axes * y / (middle[:, None] + excess)) ** 2).sum(axis=1) > 1
        lower, upper = np.where(outside, middle, lower), np.where(outside, upper, middle)
    near = axes**2 * y / (upper[:, None] + excess)
    near /= np.linalg.norm(near / axes, axis=1, keepdims=True)
    return np.copysign(near, points) * scale
