"""One jaw of a grasper."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.contact.own_axes import in_turned_axes
from tactsim.contact.profile import check_fillet, rounded_box
from tactsim.contact.tilt import Tilt, tilt_matrix
from tactsim.interfaces import RigidBody
from tactsim.interfaces.taxel_layout import OUTWARD, JawName
from tactsim.units import Length, NonNegative, Positive


class Jaw(RigidBody):
    """A rigid plate with rounded edges, the middle of its face at the origin; tissue may bulge out beside it.

    Source: thesis, section 6.1 and Fig. 6.1 (jaws that carry matrices of sensors); their size is not printed.
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)
    kind: Literal["jaw"] = "jaw"
    width: Positive[Length] = 30e-3
    """Along x."""
    depth: Positive[Length] = 30e-3
    """Along y."""
    thickness: Positive[Length] = 10e-3
    """Along z, away from the tissue."""
    fillet: NonNegative[Length] = 1e-3
    """Radius of the edges."""
    side: JawName = "upper"
    """Whether the tissue is below or above the face."""
    tilt_x: Tilt = 0.0
    """Rotation about the x axis, right-handed, before that about y."""
    tilt_y: Tilt = 0.0
    """Rotation about the y axis."""

    @model_validator(mode="after")
    def _rounded(self) -> Self:
        check_fillet(self.fillet, min(self.width, self.depth, self.thickness) / 2)
        return self

    @classmethod
    def example(cls) -> Self:
        """The upper jaw, a little tilted."""
        return cls(tilt_x=0.05, tilt_y=-0.03)

    @property
    def rotation(self) -> Array:
        """Matrix (3, 3) that turns the jaw's own axes (x, y, and z away from the tissue) into those of the tissue."""
        facing = np.diag([1.0, 1.0, OUTWARD[self.side]])
        return tilt_matrix(self.tilt_x, self.tilt_y) @ facing

    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance in m, outward normal and Hessian in 1/m at points (3, n)."""
        lower = np.array([-self.width / 2, -self.depth / 2, 0.0])
        upper = np.array([self.width / 2, self.depth / 2, self.thickness])
        return in_turned_axes(self.rotation, lambda own: rounded_box(own, lower, upper, self.fillet), x)

    def face_coordinates(self, x: Array) -> Array:
        """Places (2, n) in m on the face, from its middle, of points (3, n)."""
        return (self.rotation.T @ x)[:2]

    def flat(self, middle: Array) -> Array:
        """Low and high corner (2, 2) in m of the face without its rounded edges, seen along z, its ``middle`` (2,) in m."""
        half = np.abs(self.rotation[:2, :2]) @ (np.array([self.width, self.depth]) / 2 - self.fillet)
        return np.stack([middle - half, middle + half])
