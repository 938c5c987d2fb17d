"""Energies that are polynomials of the invariants: evaluated once for every Mooney-Rivlin kind."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from tactsim.array import Array
from tactsim.materials.hyperelastic import Hyperelastic

COEFFICIENT_NAME = re.compile(r"c(\d)(\d)")


class InvariantPolynomial(Hyperelastic):
    r"""Rivlin's series in Pa; a kind lists its coefficients as fields named ``c<i><j>``.

    .. math:: W = \sum_{ij} c_{ij} (I_1 - 3)^i (I_2 - 3)^j

    Source: Rivlin & Saunders 1951, doi:10.1098/rsta.1951.0004; thesis 3.1.6.
    """

    @property
    def terms(self) -> dict[tuple[int, int], float]:
        """Coefficient in Pa by its pair of powers (i, j)."""
        return powers_of({name: getattr(self, name) for name in type(self).model_fields if COEFFICIENT_NAME.fullmatch(name)})

    def energy(self, I1: Array, I2: Array) -> Array:
        """W in J/m^3, of the shape of the invariants."""
        return self._derivative(I1, I2, 0, 0)

    def energy_gradient(self, I1: Array, I2: Array) -> tuple[Array, Array]:
        """(W1, W2) in Pa, each of the shape of the invariants."""
        return self._derivative(I1, I2, 1, 0), self._derivative(I1, I2, 0, 1)

    def energy_hessian(self, I1: Array, I2: Array) -> tuple[Array, Array, Array]:
        """(W11, W12, W22) in Pa, each of the shape of the invariants."""
        return self._derivative(I1, I2, 2, 0), self._derivative(I1, I2, 1, 1), self._derivative(I1, I2, 0, 2)

    def _derivative(self, I1: Array, I2: Array, m: int, n: int) -> Array:
        """The derivative m times by I1 and n times by I2; terms of lower powers have none."""
        left = {power: c for power, c in self.terms.items() if power[0] >= m and power[1] >= n}
        return sum(
            (c * monomial_derivative(I1, I2, power, (m, n)) for power, c in left.items()),
            start=np.zeros(np.broadcast_shapes(np.shape(I1), np.shape(I2))),
        )


def powers_of(coefficients: Mapping[str, float]) -> dict[tuple[int, int], float]:
    """``{"c10": 3.0}`` as ``{(1, 0): 3.0}``."""
    return {(int(name[1]), int(name[2])): value for name, value in coefficients.items()}


def monomial_derivative(I1: Array, I2: Array, power: tuple[int, int], order: tuple[int, int]) -> Array:
    """The derivative of (I1 - 3)^i (I2 - 3)^j, ``order`` times (each at most 2) by I1 and I2.

    It has the shape of the invariants, but is one number where it is constant.
    """
    return np.asarray(_power_derivative(I1, power[0], order[0]) * _power_derivative(I2, power[1], order[1]))


def _power_derivative(invariant: Array, power: int, order: int) -> Array | float:
    """The derivative of ``(invariant - 3)**power``, ``order`` <= 2 times."""
    if power <= order:
        return float((1, 1, 2)[order]) if power == order else 0.0
    return float((1, power, power * (power - 1))[order]) * (invariant - 3) ** (power - order)
