"""Material stability at a point: strong ellipticity and Drucker's condition, exact for an energy of the invariants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.homogeneous import diagonal, principal_invariants
from tactsim.materials.hyperelastic import Hyperelastic
from tactsim.materials.kinematics import determinant
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.sampled_stability import (
    LOGARITHMIC,
    sampled_drucker_margin,
    sampled_ellipticity_margin,
    smaller_eigenvalue,
)

PAIRS = ((1, 2, 0), (2, 0, 1), (0, 1, 2))
"""Principal directions i, j and the third one, k."""


@dataclass(frozen=True)
class EnergyDerivatives:
    """First and second derivatives in Pa of an energy W(I1, I2), each of the shape of the invariants."""

    W1: Array
    W2: Array
    W11: Array
    W12: Array
    W22: Array

    @classmethod
    def of(cls, material: Hyperelastic, I1: Array, I2: Array) -> Self:
        """Those of a material at invariants of shape (...)."""
        return cls(*material.energy_gradient(I1, I2), *material.energy_hessian(I1, I2))


def shear_conditions(energy: EnergyDerivatives, stretches: Array) -> tuple[Array, Array, Array]:
    r"""Shear moduli mu_k, and the terms d_k and e_k of the conditions of strong ellipticity, in Pa, each of shape (3, ...).

    For unit ``n`` normal to ``m``, the energy along ``(I + s m n^T) F`` has the second derivative

    .. math::
        Q = 2 W_1\, n \cdot B n + 2 W_2\, m \cdot B^{-1} m
        + 4 [ W_{11} (m \cdot B n)^2 - 2 W_{12} (m \cdot B n)(m \cdot B^{-1} n) + W_{22} (m \cdot B^{-1} n)^2 ]

    With :math:`x_i = n_i m_i`, of sum zero, the smallest Q over the ratios :math:`n_i / m_i` is at
    :math:`|n_i / m_i| \propto 1 / \lambda_i` and equals, the sums running over the pairs ij with third direction k,

    .. math::
        Q_{min} = 2 \sum_{x_i x_j < 0} d_k |x_i x_j| + 2 \sum_{x_i x_j > 0} e_k x_i x_j, \quad
        \mu_k = W_1 + \lambda_k^2 W_2, \quad H_k = W_{11} + 2 \lambda_k^2 W_{12} + \lambda_k^4 W_{22},

        d_k = (\lambda_i + \lambda_j)^2 \mu_k + 2 (\lambda_i^2 - \lambda_j^2)^2 H_k, \quad
        e_k = -(\lambda_i - \lambda_j)^2 \mu_k - 2 (\lambda_i^2 - \lambda_j^2)^2 H_k

    All three are linear in W. ``stretches`` has shape (3, ...) and product 1. Source: as of `invariant_ellipticity_margin`.
    """
    b = stretches**2
    shear, opposite, equal = [], [], []
    for i, j, k in PAIRS:
        g = energy.W1 + b[k] * energy.W2
        curvature = 2 * (b[i] - b[j]) ** 2 * (energy.W11 + 2 * b[k] * energy.W12 + b[k] ** 2 * energy.W22)
        shear.append(g)
        opposite.append((stretches[i] + stretches[j]) ** 2 * g + curvature)
        equal.append(-((stretches[i] - stretches[j]) ** 2) * g - curvature)
    return np.stack(shear), np.stack(opposite), np.stack(equal)


def convex_in_invariants(material: Hyperelastic, I1: Array, I2: Array) -> Array:
    """Whether W rises with the invariants of the isochoric part and is convex in them, booleans of their shape.

    The material is strongly elliptic there whatever the stretches: no term of Q in `shear_conditions` is negative, and the first
    two are positive.
    """
    W1, W2 = material.energy_gradient(I1, I2)
    W11, W12, W22 = material.energy_hessian(I1, I2)
    rises = (W1 >= 0) & (W2 >= 0) & (W1 + W2 > 0)
    return rises & (W11 >= 0) & (W22 >= 0) & (W11 * W22 >= W12**2)


def invariant_ellipticity_margin(material: Hyperelastic, stretches: Array) -> Array:
    r"""Smallest of the nine conditions of strong ellipticity in Pa; positive where, and only where, the material is elliptic.

    .. math:: \mu_k > 0, \quad d_k > 0, \quad (\sqrt{d_i} + \sqrt{d_j})^2 + e_k > 0

    The third set makes Q_min of ``shear_conditions`` positive when x_i and x_j have one sign and x_k the other. Necessary and
    sufficient for an incompressible material; a finite bulk modulus only adds stiffness to directions with m . n != 0.
    Principal stretches have the shape (3, ...), the margin the trailing one.

    Source: the conditions of Zee & Sternberg 1983, doi:10.1007/BF00281838, derived here from W(I1, I2).
    """
    invariants = principal_invariants(stretches)
    g, d, e = shear_conditions(EnergyDerivatives.of(material, *invariants), stretches)
    root = np.sqrt(np.maximum(d, 0))
    third = [(root[i] + root[j]) ** 2 + e[k] for i, j, k in PAIRS]
    return np.minimum(np.minimum(g.min(axis=0), d.min(axis=0)), np.min(third, axis=0))


def invariant_drucker_margin(material: Hyperelastic, stretches: Array) -> Array:
    r"""Smallest eigenvalue in Pa of the second derivative of W by the logarithmic principal strains of constant volume.

    Positive where the work of an increment of Kirchhoff stress (true stress, as J = 1) on its logarithmic strain is positive in
    every principal loading. The eigenvalue has the trailing shape of the principal stretches (3, ...). With
    :math:`b_i = \lambda_i^2`, :math:`u_i = 2 b_i` and :math:`v_i = -2 / b_i`:

    .. math::
        \frac{\partial^2 W}{\partial e_i \partial e_j} = 4 \delta_{ij} (W_1 b_i + W_2 / b_i)
        + W_{11} u_i u_j + W_{12} (u_i v_j + v_i u_j) + W_{22} v_i v_j

    Source: Drucker 1959, doi:10.1115/1.4011929; in this form Hill 1970, doi:10.1098/rspa.1970.0018.
    """
    invariants = principal_invariants(stretches)
    W1, W2 = material.energy_gradient(*invariants)
    W11, W12, W22 = material.energy_hessian(*invariants)
    u, v = 2 * stretches**2, -2 / stretches**2
    hessian = np.einsum("ai,bi,i...->ab...", LOGARITHMIC, LOGARITHMIC, 2 * (W1 * u - W2 * v))
    u, v = np.tensordot(LOGARITHMIC, u, 1), np.tensordot(LOGARITHMIC, v, 1)
    uv = np.einsum("a...,b...->ab...", u, v)
    hessian += W11 * np.einsum("a...,b...->ab...", u, u) + W22 * np.einsum("a...,b...->ab...", v, v)
    hessian += W12 * (uv + np.swapaxes(uv, 0, 1))
    return smaller_eigenvalue(hessian)


def ellipticity_margin(material: Material, stretches: Array) -> Array:
    """Margin of strong ellipticity in Pa at principal stretches (3, ...) of product 1; positive where the material is elliptic.

    Exact conditions for an energy of the invariants, sampled directions of the tangent otherwise.
    """
    if isinstance(material, Hyperelastic):
        return invariant_ellipticity_margin(material, stretches)
    return sampled_ellipticity_margin(material, diagonal(stretches))


def drucker_margin(material: Material, stretches: Array) -> Array:
    """Margin of Drucker's condition in Pa at principal stretches (3, ...) of product 1; positive where the material is stable."""
    if isinstance(material, Hyperelastic):
        return invariant_drucker_margin(material, stretches)
    return sampled_drucker_margin(material, stretches)


def strongly_elliptic(material: Material, F: Array) -> Array:
    """Whether the material is strongly elliptic at ``F`` of shape (3, 3, ...), booleans of the trailing shape.

    The isochoric part of ``F`` is judged; an inverted or undefined ``F`` is not elliptic. A law of small strain is judged as it
    is; linear elasticity always is elliptic. What has no energy of the invariants is judged in sampled directions.
    """
    if isinstance(material, LinearElastic):
        return np.ones(F.shape[2:], dtype=bool)
    if material.small_strain:
        return sampled_ellipticity_margin(material, F) > 0
    J = determinant(F)
    valid = J > 0
    regular = np.where(valid, F, np.eye(3).reshape(3, 3, *(1,) * J.ndim))
    if not isinstance(material, Hyperelastic):
        return valid & (sampled_ellipticity_margin(material, regular / np.cbrt(np.where(valid, J, 1.0))) > 0)
    stretches = principal_stretches(regular)
    return valid & (invariant_ellipticity_margin(material, stretches / np.cbrt(stretches.prod(axis=0))) > 0)


def principal_stretches(F: Array) -> Array:
    """Square roots of the eigenvalues of C = F^T F, largest first, shape (3, ...).

    Two eigenvalues that coincide come out up to 1e-8 of the largest apart, as of an arc cosine at its end.

    Source: Smith 1961, doi:10.1145/355578.366316 (trigonometric eigenvalues of a symmetric 3 x 3 matrix).
    """
    C = np.einsum("iJ...,iK...->JK...", F, F)
    mean = np.einsum("JJ...->...", C) / 3
    for i in range(3):
        C[i, i] -= mean
    radius = np.sqrt(np.einsum("JK...,JK...->...", C, C) / 6)
    safe = np.where(radius > 0, radius, 1)
    angle = np.arccos(np.clip(determinant(C / safe) / 2, -1, 1)) / 3
    largest = mean + 2 * radius * np.cos(angle)
    smallest = mean + 2 * radius * np.cos(angle + 2 * np.pi / 3)
    eigenvalues = np.stack([largest, 3 * mean - largest - smallest, smallest])
    return np.sqrt(np.maximum(eigenvalues, np.finfo(float).tiny))
