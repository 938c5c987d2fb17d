"""The solid that a disc sweeps along a line, and the part of its volume that lies in a block."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.solid import Patch, Solid, Triangles
from tactsim.mesh.inclusions.centre_line import CentreLine

RADIAL_POINTS, ANGLES = 12, 96
"""Points of the section at which the length inside the block is integrated."""


class SweptSolid(Solid):
    """A disc of ``radius`` in m swept along a line, with flat ends, in a block of size (3,) in m."""

    def __init__(self, line: CentreLine, radius: float, size: Array):
        self.line, self.radius, self.size = line, radius, size
        self.patches = (self._side, *(self._end(k) for k in range(2)))

    def _side(self, points: Array) -> tuple[Array, Array]:
        on = self.line.derivatives(self.line.nearest(points))[0]
        offset = points - on
        reach = np.linalg.norm(offset, axis=1, keepdims=True)
        across = np.broadcast_to(self.line.frames(self.line.stations[:1])[0], offset.shape)
        normal = np.where(reach > 1e-12 * self.radius, offset / np.maximum(reach, 1e-300), across)
        return on + self.radius * normal, normal

    def _end(self, number: int) -> Patch:
        station = np.array([self.line.limits[number]])
        origin, normal = self.line.derivatives(station)[0][0], self.line.tangents(station)[0] * (1 if number else -1)

        def project(points: Array) -> tuple[Array, Array]:
            return points - ((points - origin) @ normal)[:, None] * normal, np.broadcast_to(normal, points.shape)

        return project

    def signed_distance(self, points: Array) -> Array:
        """Distance (n,) in m of points (n, 3), negative inside."""
        parameter = self.line.nearest(points)
        on, tangent = self.line.derivatives(parameter)[0], self.line.tangents(parameter)
        low, high = self.line.limits
        sign = np.where(parameter <= low, -1.0, np.where(parameter >= high, 1.0, 0.0))
        past = ((points - on) * tangent).sum(axis=1) * sign
        side = np.linalg.norm(points - on - (past * sign)[:, None] * tangent, axis=1) - self.radius
        outside = np.hypot(np.maximum(side, 0.0), np.maximum(past, 0.0))
        ends = np.min([self._to_end(points, number) for number in range(2)], axis=0)
        return np.where((side > 0) | (past > 0), outside, np.maximum(side, -ends))

    def _to_end(self, points: Array, number: int) -> Array:
        """Distance in m of points (n, 3) from the disc at one end."""
        station = np.array([self.line.limits[number]])
        offset = points - self.line.derivatives(station)[0]
        along = offset @ self.line.tangents(station)[0]
        across = np.sqrt(np.maximum((offset**2).sum(axis=1) - along**2, 0.0))
        return np.hypot(along, np.maximum(across - self.radius, 0.0))

    def triangles(self, edge: float) -> Triangles:
        """Rings of points along the line, and discs at its ends; edges are about ``edge`` in m."""
        low, high = self.line.limits
        coarse = self.line.derivatives(self.line.stations)[0]
        lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(coarse, axis=0), axis=1)))
        rings = max(3, round(lengths[-1] / edge) + 1)
        around = max(16, round(2 * np.pi * self.radius / edge))
        parameter = np.interp(np.linspace(0, lengths[-1], rings), lengths, self.line.stations)
        parameter[[0, -1]] = low, high
        on = self.line.derivatives(parameter)[0]
        first, second = self.line.frames(parameter)
        angle = (np.arange(around) + 0.5 * (np.arange(rings) % 2)[:, None]) * 2 * np.pi / around
        points = on[:, None] + self.radius * (
            np.cos(angle)[..., None] * first[:, None] + np.sin(angle)[..., None] * second[:, None]
        )
        vertices = np.vstack([points.reshape(-1, 3), on[[0, -1]]])
        return vertices, np.vstack([_side_triangles(rings, around), _end_triangles(rings, around)])

    def volume(self) -> float:
        r"""Volume in m^3 inside the block.

        .. math:: V = \int\!\int\!\int [x(s, \rho, \theta) \in B]\, (1 - \kappa \cdot d)\, ds\, \rho\, d\rho\, d\theta

        with the offset d from the line and its curvature vector; where a fibre leaves the block is interpolated.

        Source: H. Weyl 1939, doi:10.2307/2371513, for the element of volume.
        """
        line, s = self.line, self.line.stations
        on, derivative, _ = line.derivatives(s)
        speed = np.linalg.norm(derivative, axis=1)
        on, bend, first, second = (np.ascontiguousarray(part.T) for part in (on, line.curvature(s), *line.frames(s)))
        nodes, weights = np.polynomial.legendre.leggauss(RADIAL_POINTS)
        rho, weight = (nodes + 1) / 2 * self.radius, weights / 2 * self.radius
        parts = []
        for theta in (np.arange(ANGLES) + 0.5) * 2 * np.pi / ANGLES:
            across = np.cos(theta) * first + np.sin(theta) * second
            fibres = on[:, None] + rho[:, None] * across[:, None]
            depth = np.minimum(fibres, self.size[:, None, None] - fibres).min(axis=0)
            density = speed * (1 - rho[:, None] * (bend * across).sum(axis=0))
            parts += (_lengths_inside(s, depth, density) * rho * weight * 2 * np.pi / ANGLES).tolist()
        return float(sum(parts))

    def bounds(self) -> Array:
        """Lowest and highest coordinates (2, 3) in m."""
        on, tangent = self.line.derivatives(self.line.stations)[0], self.line.tangents(self.line.stations)
        reach = self.radius * np.sqrt(np.maximum(1 - tangent**2, 0.0))
        return np.array([(on - reach).min(axis=0), (on + reach).max(axis=0)])


def _lengths_inside(s: Array, depth: Array, density: Array) -> Array:
    """Integrals (m,) of the density (m, n) over the parameters (n,) where the depth (m, n), linear in between, is positive."""
    positive = depth >= 0
    share = (positive[:, :-1] & positive[:, 1:]).astype(float)
    crossing = np.nonzero(positive[:, :-1] != positive[:, 1:])
    a, b = depth[:, :-1][crossing], depth[:, 1:][crossing]
    share[crossing] = np.maximum(a, b) / np.abs(a - b)
    return np.asarray((share * np.diff(s) * (density[:, :-1] + density[:, 1:]) / 2).sum(axis=1))


def _side_triangles(rings: int, around: int) -> Array:
    """Triangles between rings of points, every second ring turned by half a step, outward oriented."""
    k, j = (index.ravel() for index in np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij"))
    here, there = k * around, (k + 1) * around
    following = (j + 1) % around
    odd = (k % 2).astype(bool)
    a, b, c, d = here + j, here + following, there + j, there + following
    even_pair = np.stack([np.stack([a, b, c], 1), np.stack([b, d, c], 1)])
    odd_pair = np.stack([np.stack([a, d, c], 1), np.stack([a, b, d], 1)])
    return np.where(odd[None, :, None], odd_pair, even_pair).reshape(-1, 3)


def _end_triangles(rings: int, around: int) -> Array:
    """Fans about the centres of the first and the last ring, outward oriented."""
    j = np.arange(around)
    following, count = (j + 1) % around, rings * around
    last = (rings - 1) * around
    first = np.stack([np.full(around, count), following, j], 1)
    return np.vstack([first, np.stack([np.full(around, count + 1), last + j, last + following], 1)])
