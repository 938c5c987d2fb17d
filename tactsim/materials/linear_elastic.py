"""Linear elasticity of small strains."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.kinematics import IDENTITY
from tactsim.materials.moduli import check_moduli
from tactsim.units import Positive, Pressure

SYMMETRIC = (np.einsum("ik,JL->iJkL", IDENTITY, IDENTITY) + np.einsum("iL,kJ->iJkL", IDENTITY, IDENTITY)) / 2
DEVIATORIC = SYMMETRIC - np.einsum("iJ,kL->iJkL", IDENTITY, IDENTITY) / 3
"""Projection of a displacement gradient on its symmetric traceless part, shape (3, 3, 3, 3)."""


def _bulk_modulus(material: LinearElastic) -> float | None:
    """K = E / (3 (1 - 2 nu)) in Pa, None for nu = 1/2."""
    nu = material.poisson_ratio
    return None if nu == 0.5 else material.youngs_modulus / (3 * (1 - 2 * nu))


class LinearElastic(Material):
    r"""P = 2 G dev(eps) + p I with eps = sym(F - I) and volume change tr(eps): exact only to first order in the strain.

    Source: Love 1927, A Treatise on the Mathematical Theory of Elasticity, sections 68 and 69.
    """

    compiled_form: ClassVar[Literal["invariants", "small_strain"] | None] = "small_strain"
    small_strain: ClassVar[bool] = True
    kind: Literal["linear_elastic"] = "linear_elastic"
    youngs_modulus: Positive[Pressure]
    """Young's modulus E > 0."""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)]
    """Poisson's ratio in (-1, 0.5]; 0.5 is exactly incompressible."""
    # The bulk modulus follows from the two fields, so it replaces the field of the interface.
    bulk_modulus: ClassVar[Any] = property(_bulk_modulus)  # type: ignore[misc]

    @model_validator(mode="after")
    def _moduli_are_usable(self) -> Self:
        check_moduli(self.shear_modulus, self.bulk_modulus)
        return self

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) in Pa."""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))

    def stored_energy(self, F: Array) -> Array:
        """G dev(eps):dev(eps) + K/2 tr(eps)^2 in J/m^3 for ``F`` of shape (3, 3, ...); the first term if incompressible."""
        strain = deviatoric_strain(F)
        energy = self.shear_modulus * np.einsum("iJ...,iJ...->...", strain, strain)
        return energy if self.bulk_modulus is None else energy + self.bulk_modulus / 2 * self.volume_change(F) ** 2

    def first_piola_kirchhoff(self, F: Array, pressure: Array) -> Array:
        """2 G dev(eps) + p I in Pa, shape (3, 3, ...)."""
        return 2 * self.shear_modulus * deviatoric_strain(F) + np.multiply.outer(IDENTITY, pressure)

    def tangent(self, F: Array, pressure: Array) -> Array:
        """2 G times the deviatoric projection in Pa, shape (3, 3, 3, 3, ...)."""
        return 2 * self.shear_modulus * np.multiply.outer(DEVIATORIC, np.ones(F.shape[2:]))

    def volume_change(self, F: Array) -> Array:
        """tr(F - I), dimensionless, of the trailing shape of ``F``."""
        return np.einsum("JJ...->...", F) - 3

    def volume_change_gradient(self, F: Array) -> Array:
        """The identity, shape (3, 3, ...)."""
        return np.multiply.outer(IDENTITY, np.ones(F.shape[2:]))

    @classmethod
    def example(cls) -> Self:
        """The lump of the thesis, section 6.5: E = 18 kPa; Poisson's ratio 0.49 is an assumption."""
        return cls.model_validate({"youngs_modulus": 18e3, "poisson_ratio": 0.49})


def deviatoric_strain(F: Array) -> Array:
    """Symmetric traceless part of F - I, dimensionless, shape (3, 3, ...)."""
    return np.einsum("iJkL,kL...->iJ...", DEVIATORIC, F)
