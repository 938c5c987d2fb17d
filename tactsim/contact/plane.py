"""A rigid plane."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import RigidBody


class Plane(RigidBody):
    """The half-space above z = 0; tissue lies below it.

    Source: the jaws of the thesis's chapter 6 where they are wider than the tissue.
    """

    kind: Literal["plane"] = "plane"

    @classmethod
    def example(cls) -> Self:
        """The plane."""
        return cls()

    def signed_distance(self, x: Array) -> tuple[Array, Array, Array]:
        """Distance, normal and Hessian at points (d, n)."""
        normal = np.zeros_like(x)
        normal[-1] = -1.0
        return -x[-1], normal, np.zeros((len(x), *x.shape))
