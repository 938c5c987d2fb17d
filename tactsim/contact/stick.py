"""Contact that never slips while it is closed."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import ContactLaw


class Stick(ContactLaw):
    """Any tangential traction while the contact is closed; it opens freely.

    Source: the limit of infinite friction (thesis errata E16: part of the bracket of Table 3.2).
    """

    kind: Literal["stick"] = "stick"

    @classmethod
    def example(cls) -> Self:
        """The law has no parameter."""
        return cls()

    def traction_limit(self, pressure: Array) -> Array:
        """Infinite where the pressure is positive."""
        return np.where(pressure > 0, np.inf, 0.0)

    def traction_limit_slope(self, pressure: Array) -> Array:
        """Zero."""
        return np.zeros_like(pressure)
