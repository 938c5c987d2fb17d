"""A smooth line through given points, and the points of it that are nearest to others."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from tactsim.array import Array

SAMPLES = 2000
NEWTON_STEPS = 12


@dataclass(frozen=True)
class CentreLine:
    """A natural cubic spline through points, continued straight beyond them; two points make a straight line.

    Attributes
    ----------
    points : (n, 3) in m
    before, beyond : lengths in m by which the line goes on straight before its first and beyond its last point
    """

    points: Array
    before: float = 0.0
    beyond: float = 0.0

    @cached_property
    def _spline(self) -> scipy.interpolate.CubicSpline:
        chords = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return scipy.interpolate.CubicSpline(np.append(0.0, np.cumsum(chords)), self.points, bc_type="natural")

    @cached_property
    def _last(self) -> float:
        return float(self._spline.x[-1])

    @cached_property
    def limits(self) -> tuple[float, float]:
        """First and last parameter in m, with the straight parts."""
        slopes = np.linalg.norm(self._spline([0.0, self._last], 1), axis=1)
        return float(-self.before / slopes[0]), float(self._last + self.beyond / slopes[1])

    def derivatives(self, parameter: Array) -> tuple[Array, Array, Array]:
        """Points and their first and second derivatives (n, 3) at parameters (n,)."""
        within = np.clip(parameter, 0.0, self._last)
        first, over = self._spline(within, 1), (parameter - within)[:, None]
        return self._spline(within) + over * first, first, np.where(over == 0, self._spline(within, 2), 0.0)

    @cached_property
    def stations(self) -> Array:
        """Evenly spread parameters (SAMPLES,)."""
        return np.linspace(*self.limits, SAMPLES)

    def tangents(self, parameter: Array) -> Array:
        """Unit tangents (n, 3)."""
        first = self.derivatives(parameter)[1]
        return first / np.linalg.norm(first, axis=1, keepdims=True)

    def curvature(self, parameter: Array) -> Array:
        """Curvature vectors (n, 3) in 1/m."""
        _, first, second = self.derivatives(parameter)
        speed2 = (first**2).sum(axis=1, keepdims=True)
        return (second - first * (second * first).sum(axis=1, keepdims=True) / speed2) / speed2

    def frames(self, parameter: Array) -> tuple[Array, Array]:
        """Two unit vectors (n, 3) across the line at increasing parameters, carried along without sudden turns."""
        tangent = self.tangents(parameter)
        across = np.empty_like(tangent)
        last = np.eye(3)[np.abs(tangent[0]).argmin()]
        for k, along in enumerate(tangent):
            last = last - along * (last @ along)
            last = last / np.linalg.norm(last)
            across[k] = last
        return across, np.cross(tangent, across)

    @cached_property
    def _tree(self) -> scipy.spatial.cKDTree:
        return scipy.spatial.cKDTree(self.derivatives(self.stations)[0])

    def nearest(self, points: Array) -> Array:
        """Parameters (n,) of the points of the line that are nearest to points (n, 3), by Newton's method from samples."""
        _, index = self._tree.query(points)
        low, high = self.limits
        step = (high - low) / (SAMPLES - 1)
        parameter = self.stations[index]
        left, right = np.maximum(parameter - step, low), np.minimum(parameter + step, high)
        for _ in range(NEWTON_STEPS):
            on, first, second = self.derivatives(parameter)
            slope = ((on - points) * first).sum(axis=1)
            bend = (first**2).sum(axis=1) + ((on - points) * second).sum(axis=1)
            bend = np.where(bend > 0, bend, (first**2).sum(axis=1))
            before, parameter = parameter, np.clip(parameter - slope / bend, left, right)
            if np.array_equal(parameter, before):
                break
        return parameter
