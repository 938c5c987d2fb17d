"""Three-parameter Mooney-Rivlin energy."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.units import Pressure


class MooneyRivlin3(InvariantPolynomial):
    r"""W = c10 (I1 - 3) + c01 (I2 - 3) + c11 (I1 - 3)(I2 - 3); G = 2 (c10 + c01).

    >>> import tactsim as ts
    >>> ts.MooneyRivlin3(c10="1.2 kPa", c01="0.4 kPa", c11="0.1 kPa").shear_modulus  # Pa
    3200.0

    Source: thesis 3.1.7.
    """

    kind: Literal["mooney_rivlin_3"] = "mooney_rivlin_3"
    c10: Pressure
    """Coefficient of (I1 - 3)."""
    c01: Pressure
    """Coefficient of (I2 - 3)."""
    c11: Pressure
    """Coefficient of (I1 - 3)(I2 - 3)."""

    @classmethod
    def example(cls) -> Self:
        """Elastomer ICF, thesis, Table 3.1."""
        return cls(c10=-8598.8, c01=10284, c11=5143.6)
