"""Neo-Hookean energy."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.materials.invariant_polynomial import InvariantPolynomial
from tactsim.units import Positive, Pressure


class NeoHookean(InvariantPolynomial):
    r"""W = c10 (I1 - 3); G = 2 c10.

    >>> import tactsim as ts
    >>> ts.NeoHookean(c10="36 kPa").shear_modulus  # Pa
    72000.0

    Source: Treloar 1943, doi:10.1039/tf9433900036 (statistical theory).
    """

    kind: Literal["neo_hookean"] = "neo_hookean"
    c10: Positive[Pressure]
    """Coefficient of (I1 - 3)."""

    @classmethod
    def example(cls) -> Self:
        """Arterial wall of the thesis, section 6.5: E = 130 kPa, so c10 = E / 6."""
        return cls(c10=130e3 / 6)
