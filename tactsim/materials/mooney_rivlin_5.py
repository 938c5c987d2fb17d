"""Five-parameter Mooney-Rivlin energy, complete to the second order."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.units import Pressure


class MooneyRivlin5(InvariantPolynomial):
    r"""W = c10 (I1-3) + c01 (I2-3) + c20 (I1-3)^2 + c11 (I1-3)(I2-3) + c02 (I2-3)^2; G = 2 (c10 + c01).

    Other authors mean c10, c01, c11, c20, c30 by five parameters: that is the kind ``polynomial``.

    Source: Rivlin & Saunders 1951, doi:10.1098/rsta.1951.0004.
    """

    kind: Literal["mooney_rivlin_5"] = "mooney_rivlin_5"
    c10: Pressure
    """Coefficient of (I1 - 3)."""
    c01: Pressure
    """Coefficient of (I2 - 3)."""
    c20: Pressure
    """Coefficient of (I1 - 3)^2."""
    c11: Pressure
    """Coefficient of (I1 - 3)(I2 - 3)."""
    c02: Pressure
    """Coefficient of (I2 - 3)^2."""

    @classmethod
    def example(cls) -> Self:
        """Round numbers of no material, all terms present."""
        return cls(c10=2e3, c01=1e3, c20=500.0, c11=250.0, c02=125.0)
