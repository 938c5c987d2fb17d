"""An artery: a hollow tube along a straight or curved line, cut by the faces of the block that it leaves through."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import FACES, Measures, Point, Solid, near_face
from tactsim.mesh.inclusions.centre_line import CentreLine
from tactsim.mesh.inclusions.swept import SweptSolid
from tactsim.units import Length, Positive, format_quantity

LARGEST_EXTENSION = 6.0
"""How far a tube may go on beyond its last point to leave the block, in outer radii: a slope of 80 degrees to the face."""
STEEPEST = 0.4
"""Least sine of the angle between a tube and the face that it leaves through."""
WALL_SIZE = 3.5
"""Element size asked for in wall thicknesses: one layer of quadratic elements spans the wall, with edges of about two of them."""
ALONG_LINE = 400
"""Points along a centre line that stand for the tube."""
THINNEST = 0.02
"""Least wall in inner radii: a thinner one is a membrane, which solid elements do not represent."""


class Tube(Inclusion):
    """A hollow tube; the space inside it is empty, so that a pressure can act on the wall.

    An end whose point lies on or outside a face of the block leaves through that face and is cut by it. An end inside the block
    is cut flat, and the empty space ends with it.

    >>> import tactsim as ts
    >>> line = [("0 mm", "20 mm", "10 mm"), ("40 mm", "20 mm", "10 mm")]
    >>> ts.Tube(centre_line=line, inner_radius="2 mm", wall="0.5 mm").outer_radius  # m
    0.0025
    """

    kind: Literal["tube"] = "tube"
    data_set_number: ClassVar[int | None] = 3
    hollow: ClassVar[bool] = True
    centre_line: Annotated[tuple[Point, ...], Field(min_length=2)]
    """Points of the centre line; two make a straight tube, more a smooth curve through them."""
    inner_radius: Positive[Length]
    """Radius of the empty space."""
    wall: Positive[Length]
    """Thickness of the wall."""

    @classmethod
    def example(cls) -> Self:
        """The artery of the thesis' section 6.5, across the default block."""
        return cls(centre_line=((0.0, 20e-3, 10e-3), (40e-3, 20e-3, 10e-3)), inner_radius=4e-3, wall=0.6e-3)

    @property
    def outer_radius(self) -> float:
        """Outer radius in m."""
        return self.inner_radius + self.wall

    def refine(self, wanted: float) -> float:
        """Element size in m that suits the wall."""
        return min(wanted, WALL_SIZE * self.wall)

    def identity(self) -> str:
        """Text that changes with the geometry and the elements of the wall."""
        return f"{super().identity()}-{WALL_SIZE}"

    def solids(self, size: Array) -> tuple[Solid, ...]:
        """The filled tube and the empty space in it, both long enough to leave the block, size (3,) in m, where the tube does.

        Raises
        ------
        InvalidQuantity
            If points of the centre line coincide.
        """
        line = extended(self.centre_line, self.outer_radius, tuple(map(float, size)))
        return SweptSolid(line, self.outer_radius, size), SweptSolid(line, self.inner_radius, size)

    def measures(self, size: Array) -> Measures:
        """Middle between the ends, outer radius and highest point of the tube, as it is given, whatever the size (3,)."""
        line = np.array(self.centre_line)
        along = line[-1] - line[0]
        center, top = (line[0] + line[-1]) / 2, float(line[:, 2].max() + self.outer_radius)
        return Measures(center, self.outer_radius, top, along / np.linalg.norm(along), self.wall)

    def places(self, size: Array) -> Array:
        """Points (n, 3) in m along the centre line in the block of size (3,) in m.

        Raises
        ------
        InvalidQuantity
            If points of the centre line coincide.
        """
        line = extended(self.centre_line, self.outer_radius, tuple(map(float, size)))
        points = line.derivatives(np.linspace(*line.limits, ALONG_LINE))[0]
        return points[((points >= 0) & (points <= size)).all(axis=1)]

    def check_in_block(self, size: Array, gap: float, name: str) -> None:
        """Refuse a tube that is too thin, too bent, or leaves the block of size (3,) in m other than by an end.

        Raises
        ------
        InvalidQuantity
            Naming the tube and what is wrong with it.
        """
        self._check_shape(name)
        line = extended(self.centre_line, self.outer_radius, tuple(map(float, size)))
        check_bends(line, self.outer_radius, gap, name)
        on, tangent = line.derivatives(line.stations)[0], line.tangents(line.stations)
        within = np.all((on > 0) & (on < size), axis=1)
        if not within.any():
            raise InvalidQuantity(f"{name}: the centre line does not pass through the block")
        reach = [self.outer_radius * np.sqrt(1 - np.minimum(tangent[:, axis] ** 2, 1.0)) for _, axis, _ in FACES]
        depth = [size[axis] - on[:, axis] if end else on[:, axis] for _, axis, end in FACES]
        gone = [centre < -0.9 * radius for centre, radius in zip(depth, reach, strict=True)]
        for k, (face, axis, _) in enumerate(FACES):
            elsewhere = np.any([other for j, other in enumerate(gone) if j != k], axis=0)  # out by another face already
            distance = np.where(elsewhere, np.inf, depth[k] - reach[k])
            self._check_face(face, distance, gap, name, out=gone[k], slope=np.abs(tangent[:, axis]))

    def _check_shape(self, name: str) -> None:
        if self.wall < THINNEST * self.inner_radius:
            wall, least = format_quantity(self.wall, "m"), format_quantity(THINNEST * self.inner_radius, "m")
            raise InvalidQuantity(f"{name}: the wall {wall} is too thin for solid elements; allowed: at least {least}")

    def _check_face(self, face: str, distance: Array, gap: float, name: str, *, out: Array, slope: Array) -> None:
        """Accept distances (n,) below the gap only in one run from an end that is ``out`` (n,) and steep to the face."""
        near = distance < gap
        for along in (slice(None), slice(None, None, -1)):
            if out[along][0] and near[along][0]:
                run = int(np.argmin(near[along])) if not near.all() else len(near)
                least = float(slope[along][:run].min())
                if least < STEEPEST:
                    angle, allowed = np.degrees(np.arcsin([least, STEEPEST]))
                    raise InvalidQuantity(
                        f"{name} leaves through the {face} face at {angle:.0f} degrees; allowed: at least {allowed:.0f} degrees"
                    )
                near[along][:run] = False
        if near.any():
            place, inside = near_face(float(distance[near].min()), face), format_quantity(gap, "m")
            raise InvalidQuantity(f"{name} {place}; allowed: only an end may leave, the rest stays {inside} inside")


def check_bends(line: CentreLine, radius: float, gap: float, name: str) -> None:
    """Refuse a line (radius in m of the tube around it) that bends too tightly or comes back to itself.

    Raises
    ------
    InvalidQuantity
        With the radius of the bend or the distance, and what is allowed.
    """
    tightest = 1 / max(float(np.linalg.norm(line.curvature(line.stations), axis=1).max()), 1e-12)
    if tightest < 1.2 * radius:
        bend, least = format_quantity(tightest, "m"), format_quantity(1.2 * radius, "m")
        raise InvalidQuantity(f"{name}: the centre line bends with a radius of {bend}; allowed: at least {least}")
    points = line.derivatives(line.stations[::10])[0]
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    apart = np.abs(lengths[:, None] - lengths) > np.pi * radius
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    if (apart & (distance < 2 * radius + gap)).any():
        nearest = format_quantity(float(distance[apart].min()), "m")
        raise InvalidQuantity(
            f"{name}: the centre line comes within {nearest} of itself; allowed: {format_quantity(2 * radius + gap, 'm')}"
        )


@lru_cache(maxsize=64)
def extended(points: tuple[Point, ...], radius: float, size: tuple[float, ...]) -> CentreLine:
    """The centre line, continued until the whole section of each end on or outside a face lies outside, all in m.

    Raises
    ------
    InvalidQuantity
        If points coincide.
    """
    given = np.array(points, float)
    if (np.linalg.norm(np.diff(given, axis=0), axis=1) < 1e-3 * radius).any():
        raise InvalidQuantity("points of a centre line coincide; allowed: distinct points")
    line, block = CentreLine(given), np.array(size)
    lengths = []
    for end, parameter in ((-1.0, line.limits[0]), (1.0, line.limits[1])):
        station = np.array([parameter])
        lengths.append(_extension(line.derivatives(station)[0][0], end * line.tangents(station)[0], radius, block))
    return CentreLine(given, *lengths)


def _extension(point: Array, direction: Array, radius: float, size: Array) -> float:
    """Length in m after which the section of a tube that leaves the block is outside with a margin; 0 inside the block."""
    tolerance = 1e-6 * size.max()
    beyond = np.stack([point <= tolerance, point >= size - tolerance])
    if not beyond.any():
        return 0.0
    needed = LARGEST_EXTENSION * radius
    for _, axis, end in FACES:
        sign = 1.0 if end else -1.0
        speed = sign * direction[axis]
        if beyond[end, axis] and speed > 0:
            excess = sign * (point[axis] - (size[axis] if end else 0.0))
            reach = radius * np.sqrt(max(0.0, 1 - speed**2)) + 0.25 * radius
            needed = min(needed, max(0.0, (reach - excess) / speed))
    return float(needed)
