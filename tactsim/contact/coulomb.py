"""Coulomb friction."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.interfaces import ContactLaw


class Coulomb(ContactLaw):
    """Tangential traction up to ``friction`` times the contact pressure.

    >>> import tactsim as ts
    >>> float(ts.Coulomb(friction=0.6).traction_limit(1000.0))  # Pa, under a contact pressure of 1 kPa
    600.0

    Source: thesis, 3.2 (0.4 between annulus and elastomer) and 6.6 (0.6 between jaws and tissue).
    """

    kind: Literal["coulomb"] = "coulomb"
    friction: Annotated[float, Field(ge=0, le=10)] = 0.4
    """Coefficient of friction, dimensionless; 0 is frictionless."""

    @classmethod
    def example(cls) -> Self:
        """The coefficient of chapter 3."""
        return cls()

    def traction_limit(self, pressure: Array) -> Array:
        """``friction * pressure`` in Pa, (n,)."""
        return self.friction * pressure

    def traction_limit_slope(self, pressure: Array) -> Array:
        """``friction``, (n,)."""
        return np.full_like(pressure, self.friction)
