"""Homogeneous states of an incompressible material: stretches and nominal stress along three loading paths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.moduli import poisson_ratio


def uniaxial(stretch: Array) -> Array:
    """Principal stretches (l, l^-1/2, l^-1/2), shape (3, ...): directions 2 and 3 are free."""
    return np.stack([stretch, stretch**-0.5, stretch**-0.5])


def equibiaxial(stretch: Array) -> Array:
    """Principal stretches (l, l, l^-2), shape (3, ...): direction 3 is free."""
    return np.stack([stretch, stretch, stretch**-2.0])


def planar(stretch: Array) -> Array:
    """Principal stretches (l, 1, 1/l), shape (3, ...): direction 3 is free, direction 2 is held (pure shear)."""
    return np.stack([stretch, np.ones_like(stretch), 1 / stretch])


PATHS: dict[str, Callable[[Array], Array]] = {"uniaxial": uniaxial, "equibiaxial": equibiaxial, "planar": planar}
"""Loading path by name: a function of the stretch."""


def diagonal(stretches: Array) -> Array:
    """Deformation gradient (3, 3, ...) of principal stretches (3, ...) along the axes."""
    return np.einsum("ij,j...->ij...", np.eye(3), stretches)


def principal_invariants(stretches: Array) -> tuple[Array, Array]:
    """I1 and I2 of an incompressible state of principal stretches of shape (3, ...)."""
    squared = stretches**2
    return squared.sum(axis=0), (1 / squared).sum(axis=0)


def cauchy_stress(W1: Array, W2: Array, stretches: Array) -> Array:
    r"""True stress in Pa along direction 1 when direction 3 is free of stress, from the energy's derivatives in Pa.

    .. math:: \sigma_1 = 2 (\lambda_1^2 - \lambda_3^2)(W_1 + \lambda_2^2 W_2)

    ``stretches`` has shape (3, ...) and product 1; a finite bulk modulus is left out.

    Source: Rivlin 1948, doi:10.1098/rsta.1948.0024; thesis 3.1.2 with 3.1.9 corrected (c11 kept, pressure from the free face).
    """
    return 2 * (stretches[0] ** 2 - stretches[2] ** 2) * (W1 + stretches[1] ** 2 * W2)


def nominal_stress(material: Material, path: str, stretch: Array) -> Array:
    """Force per reference area in Pa along direction 1 of a path of ``PATHS``, of the shape of ``stretch``.

    Every law is taken as incompressible but those of small strain, which keep their Poisson's ratio. One without an energy of the
    invariants is loaded along its axes; its pressure follows from the free direction 3.
    """
    stretch = np.asarray(stretch, dtype=float)
    if isinstance(material, Hyperelastic):
        stretches = PATHS[path](stretch)
        return cauchy_stress(*material.energy_gradient(*principal_invariants(stretches)), stretches) / stretch
    F = diagonal(_small_stretches(material, path, stretch) if material.small_strain else PATHS[path](stretch))
    stress = material.first_piola_kirchhoff(F, np.zeros(stretch.shape))
    slope = material.volume_change_gradient(F)
    return stress[0, 0] - stress[2, 2] / slope[2, 2] * slope[0, 0]


def _small_stretches(material: Material, path: str, stretch: Array) -> Array:
    """Principal stretches (3, ...) of a path at small strain: the free directions contract by Poisson's ratio."""
    nu = poisson_ratio(material.shear_modulus, material.bulk_modulus)
    strains = {"uniaxial": (1.0, -nu, -nu), "equibiaxial": (1.0, 1.0, -2 * nu / (1 - nu)), "planar": (1.0, 0.0, -nu / (1 - nu))}
    return 1 + np.multiply.outer(np.array(strains[path]), stretch - 1)


def stiffness_ratio(material: Material, tissue: Material, stretch: float) -> float:
    """Stress of a material over that of the tissue at the same uniaxial ``stretch``, dimensionless: 1 for the tissue itself.

    It is the ratio at a working strain; at the stretch 1 it is that of the shear moduli, the ratio at rest.
    """
    if stretch == 1.0:
        return float(material.shear_modulus / tissue.shear_modulus)
    own, other = (float(nominal_stress(one, "uniaxial", np.array(stretch))) for one in (material, tissue))
    return own / other
