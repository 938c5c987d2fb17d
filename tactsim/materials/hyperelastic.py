"""Isotropic hyperelasticity: stress and tangent derived once from an energy of the two isochoric invariants."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.derivatives import check_derivatives
from tactsim.materials.kinematics import (
    cofactor,
    determinant,
    determinant_hessian,
    isochoric_invariant_gradients,
    isochoric_invariant_hessians,
    isochoric_invariants,
    outer,
)
from tactsim.materials.moduli import BulkModulus, check_moduli, youngs_modulus


class Hyperelastic(Material):
    r"""Energy per reference volume W(I1, I2) of the isochoric invariants, plus a volume term in mixed form.

    .. math::
        I_1 = J^{-2/3} \operatorname{tr} C, \quad I_2 = J^{-4/3} \tfrac12 (\operatorname{tr}^2 C - \operatorname{tr} C^2), \quad
        L(F, p) = W(I_1, I_2) + p (J - 1) - \frac{p^2}{2K}

    The pressure ``p`` is the mean Cauchy stress, tension positive; eliminating it gives the volume energy ``K/2 (J - 1)^2``.

    Source: Holzapfel 2000, Nonlinear Solid Mechanics, sections 6.4 and 6.5 (isochoric split and its tangent); Sussman & Bathe
    1987, doi:10.1016/0045-7949(87)90265-3 (displacement and pressure).
    """

    compiled_form: ClassVar[Literal["invariants", "small_strain"] | None] = "invariants"
    bulk_modulus: BulkModulus | None = None
    """Bulk modulus K > 0; null means exactly incompressible."""

    @abstractmethod
    def energy(self, I1: Array, I2: Array) -> Array:
        """Isochoric energy W in J/m^3 for invariants of any (common) shape."""

    @abstractmethod
    def energy_gradient(self, I1: Array, I2: Array) -> tuple[Array, Array]:
        """First derivatives (W1, W2) in Pa, each of the shape of the invariants."""

    @abstractmethod
    def energy_hessian(self, I1: Array, I2: Array) -> tuple[Array, Array, Array]:
        """Second derivatives (W11, W12, W22) in Pa, each of the shape of the invariants."""

    @model_validator(mode="after")
    def _moduli_are_usable(self) -> Self:
        check_derivatives(self)
        check_moduli(self.shear_modulus, self.bulk_modulus)
        return self

    @property
    def shear_modulus(self) -> float:
        """Small-strain shear modulus G = 2 (W1 + W2) at I1 = I2 = 3, in Pa."""
        W1, W2 = self.energy_gradient(np.array(3.0), np.array(3.0))
        return float(2 * (W1 + W2))

    @property
    def youngs_modulus(self) -> float:
        """Small-strain Young's modulus in Pa."""
        return youngs_modulus(self.shear_modulus, self.bulk_modulus)

    def stored_energy(self, F: Array) -> Array:
        """Energy W + K/2 (J - 1)^2 in J/m^3 for ``F`` of shape (3, 3, ...); W alone if incompressible."""
        W = self.energy(*isochoric_invariants(F))
        return W if self.bulk_modulus is None else W + self.bulk_modulus / 2 * self.volume_change(F) ** 2

    def volume_change(self, F: Array) -> Array:
        """J - 1, dimensionless, of the trailing shape of ``F``."""
        return determinant(F) - 1

    def volume_change_gradient(self, F: Array) -> Array:
        """dJ/dF = cof F = J F^-T, dimensionless, shape (3, 3, ...)."""
        return cofactor(F)

    def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
        r"""P = W1 dI1/dF + W2 dI2/dF + p cof F in Pa, shape (3, 3, ...)."""
        W1, W2 = self.energy_gradient(*isochoric_invariants(F))
        dI1, dI2 = isochoric_invariant_gradients(F)
        return W1 * dI1 + W2 * dI2 + pressure * cofactor(F)

    def tangent(self, F: Array, pressure: Array) -> Array:
        r"""dP/dF at fixed pressure in Pa, shape (3, 3, 3, 3, ...): element [i, J, k, L] is dP_iJ / dF_kL.

        .. math::
            \frac{\partial P}{\partial F} = W_a \frac{\partial^2 I_a}{\partial F \partial F}
            + W_{ab} \frac{\partial I_a}{\partial F} \otimes \frac{\partial I_b}{\partial F}
            + p \frac{\partial^2 J}{\partial F \partial F}
        """
        I1, I2 = isochoric_invariants(F)
        W1, W2 = self.energy_gradient(I1, I2)
        W11, W12, W22 = self.energy_hessian(I1, I2)
        dI1, dI2 = isochoric_invariant_gradients(F)
        ddI1, ddI2 = isochoric_invariant_hessians(F)
        curvature = W11 * outer(dI1, dI1) + W12 * (outer(dI1, dI2) + outer(dI2, dI1)) + W22 * outer(dI2, dI2)
        return W1 * ddI1 + W2 * ddI2 + curvature + pressure * determinant_hessian(F)
