"""The filler plate of the hardness sensor: a rigid annulus with walls and filleted edges."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from tactsim.analytic.annular_area import annular_area
from tactsim.array import Array
from tactsim.contact.profile import Revolved, check_fillet, rounded_box
from tactsim.interfaces.contact_shape import ContactShape
from tactsim.units import Length, NonNegative, Positive, format_quantity


class Annulus(Revolved):
    """A rigid ring ``inner_radius <= r <= outer_radius`` whose face lies at z = 0 and whose walls rise along z > 0.

    >>> import tactsim as ts
    >>> ring = ts.Annulus(inner_radius="1.5 mm", outer_radius="3 mm")
    >>> f"{1e6 * ring.area:.1f} mm^2"
    '21.2 mm^2'

    Source: thesis, section 3.1.1, Fig. 3.1 and 3.7; the fillet is not printed and is a declared assumption.
    """

    kind: Literal["annulus"] = "annulus"
    inner_radius: Positive[Length] = 1.5e-3
    """Radius of the hole."""
    outer_radius: Positive[Length] = 3e-3
    """Outer radius of the ring."""
    fillet: NonNegative[Length] = 0.2e-3
    """Radius of the rounding of both edges of the face; 0 is a sharp edge."""
    height: Positive[Length] = 20e-3
    """Height of the walls."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.inner_radius >= self.outer_radius:
            inner, outer = (format_quantity(value, "m") for value in (self.inner_radius, self.outer_radius))
            raise ValueError(f"inner_radius {inner} must be smaller than outer_radius {outer}")
        largest = min((self.outer_radius - self.inner_radius) / 2, self.height / 2)
        check_fillet(self.fillet, largest)
        return self

    @classmethod
    def example(cls) -> Self:
        """The sensor of chapter 3."""
        return cls()

    @property
    def area(self) -> float:
        """Annular area in m^2 that the thesis divides the threshold force by."""
        return annular_area(self.inner_radius, self.outer_radius)

    @property
    def contact_shape(self) -> ContactShape:
        """The face, its hole and the rounding of both edges."""
        radii = {"inner_radius": self.inner_radius, "outer_radius": self.outer_radius}
        return ContactShape(self.outer_radius, self.inner_radius, self.fillet, radii=radii)

    def profile_distance(self, p: Array) -> tuple[Array, Array, Array]:
        """Distance (n,) in m, normal (2, n), Hessian (2, 2, n) in 1/m of the section, a rounded rectangle, at points (2, n)."""
        lower, upper = np.array([self.inner_radius, 0.0]), np.array([self.outer_radius, self.height])
        return rounded_box(p, lower, upper, self.fillet)
