"""Threshold sensors around the tip of a catheter."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.analytic.annular_area import annular_area
from tactsim.array import Array
from tactsim.model import FrozenModel
from tactsim.units import Angle, Length, Positive, format_quantity

RINGS, SPOKES = 40, 96
"""Points of the quadrature over the face of a sensor: so many radii of equal area, so many angles."""


class SensorRing(FrozenModel):
    """Equal annular sensors, evenly spaced on a circle around the middle of a tip; the middle stays free for an anchor.

    Source: thesis, 7.3 and Fig. 7.1: at least four sensors; no size is printed, those here are assumptions.
    """

    count: Annotated[int, Field(ge=2, le=64)] = 4
    """Number of sensors; the thesis asks for at least four, and fewer show what they miss."""
    radius: Positive[Length] = 3e-3
    """Radius of the circle of their centres."""
    outer_radius: Positive[Length] = 1e-3
    """Outer radius of the face of a sensor."""
    inner_radius: Positive[Length] = 0.5e-3
    """Radius of its hole."""
    recess: Positive[Length] = 0.1e-3
    """Depth L of its small sensor."""
    orientation: Angle = 0.0
    """Angle of the first sensor, from the x axis, counter-clockwise."""

    @property
    def area(self) -> float:
        """Annular area of the face of a sensor in m^2."""
        return annular_area(self.inner_radius, self.outer_radius)

    @model_validator(mode="after")
    def _apart(self) -> Self:
        if self.inner_radius > 0.99 * self.outer_radius:
            inner, outer = format_quantity(self.inner_radius, "m"), format_quantity(self.outer_radius, "m")
            raise ValueError(f"inner_radius {inner} must be at most 0.99 of the outer_radius {outer}")
        apart = 2 * self.radius * np.sin(np.pi / self.count)
        if apart < 2 * self.outer_radius * (1 - 1e-12):
            width, between = format_quantity(2 * self.outer_radius, "m"), format_quantity(float(apart), "m")
            raise ValueError(
                f"{self.count} sensors {width} wide overlap: their centres are {between} apart; "
                "take fewer or smaller sensors, or a larger radius"
            )
        return self

    @property
    def angles(self) -> Array:
        """Angles of the sensors in rad, in [0, 2 pi), shape (count,)."""
        return (self.orientation + 2 * np.pi * np.arange(self.count) / self.count) % (2 * np.pi)

    @property
    def positions(self) -> Array:
        """Centres (count, 2) in m from the middle of the tip."""
        return self.radius * np.column_stack([np.cos(self.angles), np.sin(self.angles)])

    def lag(self, tilt: float, direction: float) -> Array:
        """Displacement in m after the first touch of the tip at which each sensor touches, shape (count,).

        ``tilt`` in rad is the angle between tip and surface, ``direction`` in rad where the tip is lowest.
        """
        along = self.positions @ np.array([np.cos(direction), np.sin(direction)])
        return np.tan(tilt) * (along.max() - along)

    def face_points(self) -> Array:
        """Points (n, 2) in m from the centre of a sensor, each standing for the same area of the disc it covers."""
        radii = self.outer_radius * np.sqrt((np.arange(RINGS) + 0.5) / RINGS)
        angles = 2 * np.pi * (np.arange(SPOKES) + 0.5) / SPOKES
        return np.column_stack([np.outer(radii, np.cos(angles)).ravel(), np.outer(radii, np.sin(angles)).ravel()])
