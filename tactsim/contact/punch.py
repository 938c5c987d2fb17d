"""A flat cylindrical punch, or the face of a disc-shaped sensor."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.contact.profile import Revolved, check_fillet, rounded_box
from tactsim.interfaces.contact_shape import ContactShape
from tactsim.units import Length, NonNegative, Positive


class Punch(Revolved):
    """A rigid disc ``r <= radius`` whose face lies at z = 0.

    Source: the flat punch of contact mechanics (Sneddon 1965, doi:10.1016/0020-7225(65)90019-4).
    """

    kind: Literal["punch"] = "punch"
    radius: Positive[Length] = 1.5e-3
    """Radius of the disc."""
    fillet: NonNegative[Length] = 0.0
    """Radius of the rounding of the edge."""
    height: Positive[Length] = 20e-3
    """Height of the wall."""

    @model_validator(mode="after")
    def _rounded(self) -> Self:
        check_fillet(self.fillet, min(self.radius, self.height / 2))
        return self

    @classmethod
    def example(cls) -> Self:
        """A disc as wide as the hole of chapter 3's sensor."""
        return cls()

    @property
    def area(self) -> float:
        """Area of the face in m^2."""
        return float(np.pi * self.radius**2)

    @property
    def contact_shape(self) -> ContactShape:
        """The face and the rounding of its edge."""
        return ContactShape(self.radius, fillet=self.fillet, radii={"radius": self.radius})

    def profile_distance(self, p: Array) -> tuple[Array, Array, Array]:
        """Distance (n,) in m, normal (2, n), Hessian (2, 2, n) in 1/m of the section, a rounded rectangle, at points (2, n)."""
        lower, upper = np.array([-self.radius, 0.0]), np.array([self.radius, self.height])
        return rounded_box(p, lower, upper, self.fillet)
