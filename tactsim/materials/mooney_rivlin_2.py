"""Two-parameter Mooney-Rivlin energy."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.units import Pressure


class MooneyRivlin2(InvariantPolynomial):
    r"""W = c10 (I1 - 3) + c01 (I2 - 3); G = 2 (c10 + c01).

    Source: Mooney 1940, doi:10.1063/1.1712836; Rivlin 1948, doi:10.1098/rsta.1948.0024.
    """

    kind: Literal["mooney_rivlin_2"] = "mooney_rivlin_2"
    c10: Pressure
    """Coefficient of (I1 - 3)."""
    c01: Pressure
    """Coefficient of (I2 - 3)."""

    @classmethod
    def example(cls) -> Self:
        """The thick tube of Oden 1972, Finite Elements of Nonlinear Continua, pp. 325-331: 80 and 20 psi."""
        psi = 6894.757293168361
        return cls(c10=80 * psi, c01=20 * psi)
