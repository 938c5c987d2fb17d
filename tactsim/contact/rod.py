"""A rod with a hemispherical end, as the indentor of a durometer for soft materials."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.contact.profile import Revolved
from tactsim.interfaces.contact_shape import ContactShape, RoundTip
from tactsim.units import Length, Positive


class Rod(Revolved):
    """A rigid round rod without end above a hemisphere of its own radius, whose lowest point is the origin.

    Source: indentor of type OO in ASTM D2240, 2.38 mm in diameter; recalled from the standard, a declared assumption.
    """

    kind: Literal["rod"] = "rod"
    radius: Positive[Length] = 1.19e-3
    """Radius of the rod and of its end."""

    @classmethod
    def example(cls) -> Self:
        """The indentor of type OO."""
        return cls()

    @property
    def contact_shape(self) -> ContactShape:
        """The hemisphere at its end."""
        return ContactShape(self.radius, tip=RoundTip(elements=9, within_radius=True), radii={"radius": self.radius})

    def profile_distance(self, p: Array) -> tuple[Array, Array, Array]:
        """Distance (n,) in m to the half-line of the centres above the end, minus the radius, of points (2, n).

        With it normal (2, n) and Hessian (2, 2, n) in 1/m.
        """
        height = np.minimum(p[1], self.radius)
        offset = np.stack([p[0], height - self.radius])
        reach = np.hypot(*offset)
        safe = np.where(reach > 0, reach, self.radius)
        normal = offset / safe
        distance = (p[0] ** 2 + height * (height - 2 * self.radius)) / (reach + self.radius)
        turning = np.eye(2)[:, :, None] - normal[:, None] * normal[None, :]
        return distance, normal, np.where(p[1] < self.radius, turning / safe, 0.0)
