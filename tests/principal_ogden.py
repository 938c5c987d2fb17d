"""Ogden's law in principal stretches as a user would write it: stress and tangent of a `Material`."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.interfaces import Array, Material
from tactsim.materials.kinematics import cofactor, determinant, determinant_hessian

NEAR = 1e-5
"""Relative difference of squared stretches below which their divided difference is a derivative, exact to its square."""
UNIT = np.eye(3)


class PrincipalOgden(Material):
    r"""W = 2 mu / alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3) of the isochoric principal stretches.

    Source: Ogden 1972, doi:10.1098/rspa.1972.0026.
    """

    kind: Literal["principal_ogden"] = "principal_ogden"
    bulk_modulus: float | None = None
    modulus: float = 1e3
    alpha: float = 2.0

    @property
    def shear_modulus(self) -> float:
        return self.modulus

    @classmethod
    def example(cls) -> Self:
        return cls()

    def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
        """F S + p cof F with S = sum of tau_a / l_a^2 N_a N_a."""
        squared, axes = self._principal(F)
        second = self._stress(squared)
        S = np.einsum("...ia,...a,...ja->ij...", axes, second, axes)
        return np.einsum("iK...,KJ...->iJ...", F, S) + pressure * cofactor(F)

    def tangent(self, F: Array, pressure: Array) -> Array:
        """delta_ik S_JL + F_iM 2 dS_MJ/dC_NL F_kN + p d2J/dFdF."""
        squared, axes = self._principal(F)
        second, slope = self._stress(squared), self._slope(squared)
        S = np.einsum("...ia,...a,...ja->ij...", axes, second, axes)
        shears = np.empty_like(slope)
        for a in range(3):
            for b in range(3):
                gap = squared[..., a] - squared[..., b]
                near = np.abs(gap) < NEAR * squared[..., a]
                divided = (second[..., a] - second[..., b]) / np.where(near, 1.0, gap)
                limit = (slope[..., a, a] + slope[..., b, b] - slope[..., a, b] - slope[..., b, a]) / 2
                shears[..., a, b] = np.where(near, limit, divided) * (a != b)
        normal = np.einsum("...Ma,...Ja,...ab,...Nb,...Lb->MJNL...", axes, axes, slope, axes, axes, optimize=True)
        across = np.einsum("...Ma,...Jb,...ab,...Na,...Lb->MJNL...", axes, axes, shears, axes, axes, optimize=True)
        turned = np.einsum("...Ma,...Jb,...ab,...Nb,...La->MJNL...", axes, axes, shears, axes, axes, optimize=True)
        moduli = 2 * (normal + (across + turned) / 2)
        return (
            np.einsum("ik,JL...->iJkL...", UNIT, S)
            + np.einsum("iM...,MJNL...,kN...->iJkL...", F, moduli, F, optimize=True)
            + pressure * determinant_hessian(F)
        )

    def volume_change(self, F: Array) -> Array:
        return determinant(F) - 1

    def volume_change_gradient(self, F: Array) -> Array:
        return cofactor(F)

    def _principal(self, F: Array) -> tuple[Array, Array]:
        """Squared stretches (..., 3) and axes (..., 3, 3) of C."""
        return np.linalg.eigh(np.einsum("iJ...,iK...->...JK", F, F))

    def _powers(self, squared: Array) -> tuple[Array, Array]:
        """Deviatoric Kirchhoff stress tau (..., 3), and 2 mu / alpha l_a^alpha without its mean taken off."""
        isochoric = squared / np.cbrt(squared.prod(axis=-1, keepdims=True))
        powers = 2 * self.modulus / self.alpha * isochoric ** (self.alpha / 2)
        return powers - powers.mean(axis=-1, keepdims=True), powers

    def _stress(self, squared: Array) -> Array:
        return self._powers(squared)[0] / squared

    def _slope(self, squared: Array) -> Array:
        """dS_a / dC_b (..., 3, 3): dtau_a / dln C_b is P (alpha / 2 diag powers) P with P = 1 - 1/3."""
        tau, powers = self._powers(squared)
        deviator = UNIT - 1 / 3
        turned = np.einsum("ac,...c,cb->...ab", deviator, self.alpha / 2 * powers, deviator)
        return turned / squared[..., :, None] / squared[..., None, :] - UNIT * (tau / squared**2)[..., :, None]
