"""The probe with leaning sides: a rigid trapezoid in the plane, a truncated cone when it is turned about its axis."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.contact.profile import Revolved
from tactsim.interfaces.contact_shape import ContactShape
from tactsim.units import Angle, Length, NonNegative, Positive, format_quantity


class Trapezoid(Revolved):
    """A flat face at z = 0 between two sides that lean outwards, with rounded corners.

    On a mesh in plane strain it is the section of a prism, on an axisymmetric mesh and in 3D that of a truncated cone.

    Source: thesis, section 5.1.1: sides of 20 degrees, read as the lean of each side from the axis of the probe; width of the
    face and fillet are not printed and are declared assumptions.
    """

    kind: Literal["trapezoid"] = "trapezoid"
    face: Positive[Length] = 2e-3
    """Width of the face between the corners where face and sides would meet without a fillet."""
    lean: Annotated[Angle, Field(ge=0, le=math.radians(80))] = 0.349065850398866
    """Angle of each side to the axis of the probe; the default is 20 degrees, as a file's "20 deg" is read."""
    fillet: NonNegative[Length] = 0.5e-3
    """Radius of the rounding of the corners; 0 is sharp."""
    height: Positive[Length] = 20e-3
    """Height of the sides along the axis."""

    @model_validator(mode="after")
    def _rounded(self) -> Self:
        largest = min(self.radius * math.cos(self.lean) / (1 - math.sin(self.lean)), self.height / 2)
        if self.fillet > largest:
            given, limit = format_quantity(self.fillet, "m"), format_quantity(largest, "m")
            raise ValueError(f"fillet {given} leaves no face of the trapezoid; allowed: at most {limit} for this face and lean")
        return self

    @classmethod
    def example(cls) -> Self:
        """The probe of chapter 5."""
        return cls()

    @property
    def radius(self) -> float:
        """Half the width of the face in m."""
        return self.face / 2

    def half_width(self, height: float | Array) -> Array:
        """Half width in m of the sides at heights in m above the face, corners not rounded; of their shape."""
        return self.radius + math.tan(self.lean) * np.asarray(height, float)

    @property
    def fillet_height(self) -> float:
        """Height in m above the face at which the fillet meets the side."""
        return self.fillet * (1 - math.sin(self.lean))

    @property
    def contact_shape(self) -> ContactShape:
        """The face and the rounding of its corners."""
        return ContactShape(self.radius, fillet=self.fillet, radii={"radius": self.radius})

    def profile_distance(self, p: Array) -> tuple[Array, Array, Array]:
        """Distance (n,) in m to the rounded trapezoid: its faces moved in by the fillet, then grown by it; at points (2, n).

        With it normal (2, n) and Hessian (2, 2, n) in 1/m.
        """
        sine, cosine = math.sin(self.lean), math.cos(self.lean)
        sign = np.where(p[0] < 0, -1.0, 1.0)
        x, z = np.abs(p[0]), p[1]
        normals = np.array([[0.0, -1.0], [cosine, -sine], [0.0, 1.0]])
        faces = np.stack([-z, cosine * (x - self.radius) - sine * z, z - self.height])
        distance, normal = faces.max(axis=0), normals[faces.argmax(axis=0)].T
        hessian = np.zeros((2, *p.shape))
        for corner, before, after in self._corners():
            offset = np.stack([x, z]) - corner[:, None]
            beyond = (before @ offset > 0) & (after @ offset < 0)
            reach = np.linalg.norm(offset, axis=0)
            beyond &= reach > 0
            radial = offset / np.where(beyond, reach, 1.0)
            turning = (np.eye(2)[:, :, None] - radial[:, None] * radial[None, :]) / np.where(beyond, reach, 1.0)
            distance = np.where(beyond, reach - self.fillet, distance)
            normal, hessian = np.where(beyond, radial, normal), np.where(beyond, turning, hessian)
        mirror = np.stack([sign, np.ones_like(sign)])
        return distance, mirror * normal, mirror[:, None] * mirror[None, :] * hessian

    def _corners(self) -> tuple[tuple[Array, Array, Array], ...]:
        """Centres of the roundings of the right half in m, each with the directions of the face before and after it."""
        sine, cosine, r = math.sin(self.lean), math.cos(self.lean), self.fillet
        side, inward = np.array([sine, cosine]), np.array([-1.0, 0.0])
        lower, upper = (np.array([self.radius + (z * sine - r) / cosine, z]) for z in (r, self.height - r))
        return (lower, -inward, side), (upper, side, inward)
