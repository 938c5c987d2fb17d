"""Closed bodies with exact surfaces in the coordinates of the block: what an inclusion gives to the mesher."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.units import Length, format_quantity

Patch = Callable[[Array], tuple[Array, Array]]
"""A smooth piece of surface: for points (n, 3) in m their nearest points (n, 3) on it and its unit normals (n, 3) there."""
Triangles = tuple[Array, Array]
"""Vertices (n, 3) in m and triangles (m, 3) of a closed surface, outward oriented."""
Point = tuple[Length, Length, Length]
FACES = (("left", 0, 0), ("right", 0, 1), ("front", 1, 0), ("back", 1, 1), ("lower", 2, 0), ("upper", 2, 1))
"""Name, axis and end of every face of the block."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Where a body lies and how large it is, in m.

    Attributes
    ----------
    center : (3,) of its volume; of a tube the middle between its ends
    radius : of a ball or a tube, that of a ball of equal volume otherwise
    top : height of its highest point
    direction : (3,) unit vector along a long body; None if it has none
    wall : thickness of the wall of a hollow one; None if it is not hollow
    """

    center: Array
    radius: float
    top: float
    direction: Array | None = None
    wall: float | None = None


@dataclass(frozen=True, eq=False)
class BallImage:
    """The unit ball, stretched: the points ``center + stretch @ x`` with ``|x| <= 1``, in m.

    Attributes
    ----------
    center : (3,)
    stretch : (3, 3), symmetric
    longest : the longest semi-axis
    """

    center: Array
    stretch: Array
    longest: float


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

    def centroid(self) -> Array:
        """Centre (3,) of its volume in m; here the middle of its bounds, where that of a body with a centre of symmetry lies."""
        return np.asarray(self.bounds().mean(axis=0))

    def measures(self) -> Measures:
        """Where it lies and how large it is."""
        radius = float((0.75 * self.volume() / np.pi) ** (1 / 3))
        return Measures(self.centroid(), radius, float(self.bounds()[1, 2]))

    def ball_image(self) -> BallImage | None:
        """The stretched ball that it is, which meshes of layers and graded cells can follow; None if it is none."""
        return None


def check_size(size: Array) -> None:
    """Refuse a size in m of a block that is not three positive lengths (3,).

    Raises
    ------
    InvalidQuantity
        With the size.
    """
    if size.shape != (3,) or not np.isfinite(size).all() or not (size > 0).all():
        raise InvalidQuantity(f"the block has the size {size.tolist()} m; allowed: three positive lengths")


def check_bounds(bounds: Array, size: Array, gap: float, name: str) -> None:
    """Refuse bounds (2, 3) that leave a block of size (3,) or come nearer to a face than ``gap``, all in m.

    Raises
    ------
    InvalidQuantity
        Naming the face and the distance; ``name`` is how the message calls the body.
    """
    for face, axis, end in FACES:
        distance = float(size[axis] - bounds[1, axis] if end else bounds[0, axis])
        if distance < gap:
            place, least = near_face(distance, face), format_quantity(gap, "m")
            raise InvalidQuantity(f"{name} {place}; allowed: at least {least} inside the block")


def near_face(distance: float, face: str) -> str:
    """Where something is whose nearest point lies at a distance in m inside a face, in words."""
    by = format_quantity(abs(distance), "m")
    return f"protrudes by {by} through the {face} face" if distance < 0 else f"is {by} from the {face} face"
