"""Polynomial energy with any terms."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, StringConstraints

from tactsim.materials.invariant_polynomial import InvariantPolynomial, powers_of
from tactsim.units import Pressure

CoefficientName = Annotated[
    str,
    StringConstraints(pattern=r"^c([1-9][0-9]|0[1-9])$"),
    Field(description="c and two digits, the powers of (I1 - 3) and of (I2 - 3), such as c10"),
]


class Polynomial(InvariantPolynomial):
    r"""W = sum of c_ij (I1 - 3)^i (I2 - 3)^j over the given terms; G = 2 (c10 + c01).

    Source: Rivlin & Saunders 1951, doi:10.1098/rsta.1951.0004; thesis 3.1.6.
    """

    kind: Literal["polynomial"] = "polynomial"
    coefficients: Annotated[dict[CoefficientName, Pressure], Field(min_length=1)]
    """Coefficient by its name c<i><j>, the powers of (I1 - 3) and (I2 - 3) as single digits."""

    @property
    def terms(self) -> dict[tuple[int, int], float]:
        """Coefficient in Pa by its pair of powers (i, j)."""
        return powers_of(self.coefficients)

    @classmethod
    def example(cls) -> Self:
        """Filled rubber after Yeoh, with the I2 term: round numbers of no material."""
        return cls(coefficients={"c10": 1.6e5, "c20": -1e3, "c30": 40.0, "c01": 1e4})
