"""A rigid body that comes from any side."""

from __future__ import annotations

from typing import Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.contact.own_axes import BodyInOwnAxes
from tactsim.contact.plane import Plane
from tactsim.interfaces import RigidBody

UNIT = 1e-12
"""Error of the length of a unit vector that is round-off."""


class Turned(BodyInOwnAxes):
    """A body whose axis, which points away from the tissue, has any direction; its reference point stays at the origin.

    No kind of its own: case files name the body and the side it comes from.
    """

    axis: tuple[float, ...]
    """Unit vector from the tissue to the body, with as many components as there are coordinates."""

    @model_validator(mode="after")
    def _unit(self) -> Self:
        if len(self.axis) not in (2, 3) or abs(float(np.linalg.norm(self.axis)) - 1) > UNIT:
            raise ValueError(f"axis {list(self.axis)} must be a unit vector of two or three components")
        return self

    @classmethod
    def example(cls) -> Self:
        """A plane below the tissue."""
        return cls.of(Plane.example(), (0.0, 0.0, -1.0))

    @classmethod
    def of(cls, body: RigidBody, axis: tuple[float, ...]) -> Self:
        """A body with its axis along a unit vector."""
        return cls(kind=body.kind, body=body, axis=axis)

    @property
    def rotation(self) -> Array:
        """Matrix (d, d) that turns the body's own axes into those of the tissue."""
        away = np.array(self.axis)
        if len(away) == 2:
            return np.array([[away[1], away[0]], [-away[0], away[1]]])
        first = np.roll(np.eye(3)[int(np.abs(away).argmax())], 1)
        first -= (first @ away) * away
        first /= np.linalg.norm(first)
        return np.column_stack([first, np.cross(away, first), away])
