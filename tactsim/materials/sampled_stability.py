"""Material stability at a point from the tangent alone, whatever the law: the acoustic tensor in sampled directions."""

from __future__ import annotations

import numpy as np

from tactsim.interfaces import Array, Material
from tactsim.materials.homogeneous import diagonal

DIRECTIONS = 100
"""Unit vectors on half a sphere, some 14 degrees apart: a loss of ellipticity in a narrower cone can be overlooked."""
CHUNK = 4096
"""Points judged at once."""
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
    """That at points of shape (3, 3, n), shape (n,)."""
    moduli, slope = material.tangent(F, np.zeros(F.shape[2])), material.volume_change_gradient(F)
    least = np.full(F.shape[2], np.inf)
    for n in half_sphere(DIRECTIONS):
        acoustic = np.einsum("J,iJkLn,L->nik", n, moduli, n)
        first, second = _across(np.einsum("iJn,J->ni", slope, n))
        plane = np.stack([first, second])
        least = np.minimum(least, smaller_eigenvalue(np.einsum("ani,nik,bnk->abn", plane, acoustic, plane)))
    return least


def sampled_drucker_margin(material: Material, stretches: Array) -> Array:
    r"""Smallest eigenvalue in Pa of the second derivative of the energy by the logarithmic principal strains of constant volume.

    .. math:: \frac{\partial^2 W}{\partial e_i \partial e_j} = \lambda_i \lambda_j \frac{\partial P_{ii}}{\partial F_{jj}}
        + \delta_{ij} \lambda_i P_{ii}

    at ``stretches`` of shape (3, ...) and product 1, in the axes of the material.

    Source: Hill 1970, doi:10.1098/rspa.1970.0018.
    """
    F = diagonal(stretches)
    none = np.zeros(stretches.shape[1:])
    moduli = np.einsum("iijj...->ij...", material.tangent(F, none))
    hessian = np.einsum("i...,j...,ij...->ij...", stretches, stretches, moduli)
    first = np.einsum("i...,ii...->i...", stretches, material.first_piola_kirchhoff(F, none))
    for i in range(3):
        hessian[i, i] += first[i]
    return smaller_eigenvalue(np.einsum("ai,bj,ij...->ab...", LOGARITHMIC, LOGARITHMIC, hessian))


def smaller_eigenvalue(matrix: Array) -> Array:
    """Smaller eigenvalue of symmetric matrices of shape (2, 2, ...)."""
    mean, half = (matrix[0, 0] + matrix[1, 1]) / 2, (matrix[0, 0] - matrix[1, 1]) / 2
    return mean - np.hypot(half, matrix[0, 1])


def half_sphere(count: int) -> Array:
    """Evenly spread unit vectors (count, 3) of positive height.

    Source: Gonzalez 2010, Mathematical Geosciences 42, 49-64, doi:10.1007/s11004-009-9257-x (Fibonacci lattice).
    """
    step = np.arange(count) + 0.5
    height, angle = 1 - step / count, np.pi * (1 + np.sqrt(5)) * step
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)


def _across(vectors: Array) -> tuple[Array, Array]:
    """Two unit vectors (n, 3) each, normal to each other and to the vectors (n, 3)."""
    smallest = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    first = np.cross(vectors, smallest)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(vectors, first)
    return first, second / np.linalg.norm(second, axis=1, keepdims=True)
