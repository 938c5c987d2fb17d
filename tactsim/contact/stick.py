"""Contact that never slips while it is closed."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import ContactLaw

STRONGEST = 100.0
"""Largest tangential traction of a sticking contact over its pressure.

Why: without any limit a point that touches or lifts takes or loses its whole tangential traction at once, and where that opens
or closes it again there is no equilibrium: six of some 35 random grasps with sticking jaws ended there. With a limit of 10, 30,
100 and 1000 all of them converge; from 100 to 1000 no taxel changes by more than 0.7 % of its force on coarse cells where edges
roll, most by 1e-5."""


class Stick(ContactLaw):
    """Hardly any slip while the contact is closed: the tangential traction may be a hundred times the pressure; it opens freely.

    Source: the limit of infinite friction (thesis errata E16: part of the bracket of Table 3.2).
    """

    kind: Literal["stick"] = "stick"

    @classmethod
    def example(cls) -> Self:
        """The law has no parameter."""
        return cls()

    def traction_limit(self, pressure: Array) -> Array:
        """``STRONGEST`` times the pressure (n,) in Pa, where it is positive."""
        return np.asarray(STRONGEST * np.maximum(pressure, 0.0))

    def traction_limit_slope(self, pressure: Array) -> Array:
        """``STRONGEST`` where the pressure (n,) is positive."""
        return np.where(pressure > 0, STRONGEST, 0.0)
