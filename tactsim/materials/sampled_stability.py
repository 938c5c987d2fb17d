"""Material stability at a point from the tangent alone, whatever the law: the acoustic tensor in sampled directions."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.sphere_points import sphere_points
from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.homogeneous import diagonal

DIRECTIONS = 100
"""Unit vectors on half a sphere, some 14 degrees apart: a loss of ellipticity in a narrower cone can be overlooked."""
CHUNK = 256
"""Points judged at once: what is computed of them stays near the processor."""
LOGARITHMIC = np.array([[1, -1, 0], [1, 1, -2]]) / np.sqrt([[2], [6]])
"""Two unit directions of logarithmic strain of constant volume."""


def sampled_ellipticity_margin(material: Material, F: Array) -> Array:
    r"""Smallest second derivative in Pa of the energy along shears ``m n`` of constant volume, over sampled directions n.

    .. math:: m_i\, n_J\, \frac{\partial P_{iJ}}{\partial F_{kL}}\, n_L\, m_k, \qquad m \cdot \frac{\partial g}{\partial F} n = 0

    for unit n and m, with the volume change g. The pressure drops out, as that of a volume J does from the second derivative
    along such a shear. ``F`` has shape (3, 3, ...); the smallest value over m is exact.

    Source: Ogden 1984, Non-Linear Elastic Deformations, chapter 6 (strong ellipticity of the incremental moduli).
    """
    flat = F.reshape(3, 3, -1)
    margins = [_margin(material, flat[..., first : first + CHUNK]) for first in range(0, flat.shape[2], CHUNK)]
    return np.concatenate(margins).reshape(F.shape[2:]) if margins else np.zeros(F.shape[2:])


def _margin(material: Material, F: Array) -> Array:
    """That at points of shape (3, 3, n), shape (n,).

    On the plane normal to a unit vector c, a symmetric Q has the eigenvalues of trace tr Q - c.Qc and product c.adj(Q)c.
    """
    count = F.shape[2]
    normals = sphere_points(DIRECTIONS, lowest=0.0)
    moduli = material.tangent(F, np.zeros(count)).transpose(4, 0, 2, 1, 3).reshape(count, 9, 9)
    pairs = np.einsum("dJ,dL->JLd", normals, normals).reshape(9, -1)
    Q = (moduli @ pairs).reshape(count, 3, 3, -1)
    c = np.moveaxis(material.volume_change_gradient(F), -1, 0) @ normals.T
    c = c / np.linalg.norm(c, axis=1, keepdims=True)
    half = (np.einsum("niid->nd", Q) - np.einsum("nid,nikd,nkd->nd", c, Q, c)) / 2
    product = sum(
        c[:, i]
        * c[:, k]
        * (
            Q[:, (k + 1) % 3, (i + 1) % 3] * Q[:, (k + 2) % 3, (i + 2) % 3]
            - Q[:, (k + 1) % 3, (i + 2) % 3] * Q[:, (k + 2) % 3, (i + 1) % 3]
        )
        for i in range(3)
        for k in range(3)
    )
    return (half - np.sqrt(np.maximum(half**2 - product, 0.0))).min(axis=1)


def sampled_drucker_margin(material: Material, stretches: Array) -> Array:
    r"""Smallest eigenvalue in Pa of the second derivative of the energy by the logarithmic principal strains of constant volume.

    .. math:: \frac{\partial^2 W}{\partial e_i \partial e_j} = \lambda_i \lambda_j \frac{\partial P_{ii}}{\partial F_{jj}}
        + \delta_{ij} \lambda_i P_{ii}

    at ``stretches`` of shape (3, ...) and product 1, in the axes of the material. A law of small strain is judged by its own
    strains, whose second derivative is :math:`\partial P_{ii} / \partial F_{jj}`.

    Source: Hill 1970, doi:10.1098/rspa.1970.0018.
    """
    F = diagonal(1 + np.log(stretches) if material.small_strain else stretches)
    none = np.zeros(stretches.shape[1:])
    moduli = np.einsum("iijj...->ij...", material.tangent(F, none))
    if material.small_strain:
        return smaller_eigenvalue(np.einsum("ai,bj,ij...->ab...", LOGARITHMIC, LOGARITHMIC, moduli))
    hessian = np.einsum("i...,j...,ij...->ij...", stretches, stretches, moduli)
    first = np.einsum("i...,ii...->i...", stretches, material.first_piola_kirchhoff(F, none))
    for i in range(3):
        hessian[i, i] += first[i]
    return smaller_eigenvalue(np.einsum("ai,bj,ij...->ab...", LOGARITHMIC, LOGARITHMIC, hessian))


def smaller_eigenvalue(matrix: Array) -> Array:
    """Smaller eigenvalue of symmetric matrices of shape (2, 2, ...)."""
    mean, half = (matrix[0, 0] + matrix[1, 1]) / 2, (matrix[0, 0] - matrix[1, 1]) / 2
    return mean - np.hypot(half, matrix[0, 1])
