"""A rigid sphere."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import RigidBody
from tactsim.interfaces.contact_shape import ContactShape, RoundTip
from tactsim.units import Length, Positive


class Sphere(RigidBody):
    """A rigid sphere whose lowest point is the origin.

    Source: Hertz 1881, doi:10.1515/crll.1882.92.156.
    """

    kind: Literal["sphere"] = "sphere"
    radius: Positive[Length] = 5e-3
    """Radius of the sphere."""

    @classmethod
    def example(cls) -> Self:
        """A small indenter."""
        return cls()

    @property
    def contact_shape(self) -> ContactShape:
        """The sphere."""
        return ContactShape(self.radius, tip=RoundTip(elements=20), radii={"radius": self.radius})

    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance, normal and Hessian at points (d, n)."""
        offset = x.copy()
        offset[-1] -= self.radius
        reach = np.linalg.norm(offset, axis=0)
        safe = np.where(reach > 0, reach, self.radius)
        normal = offset / safe
        hessian = (np.eye(len(x))[:, :, None] - normal[:, None] * normal[None, :]) / safe
        squared = np.einsum("in,in->n", x, x)
        distance = (squared - 2 * self.radius * x[-1]) / (reach + self.radius)
        return distance, normal, hessian
