"""Determinant and isochoric invariants of a deformation gradient, with their first and second derivatives.

Every function takes ``F`` of shape (3, 3, ...), components first, real or complex, and keeps the trailing shape.

Source: Holzapfel 2000, Nonlinear Solid Mechanics, section 6.4; the derivatives follow by the product rule.
"""

from __future__ import annotations

import numpy as np

from tactsim.array import Array

IDENTITY = np.eye(3)
STRAIN = 0.05
"""Size of the sampled deformations: large against round-off, within the range of any law."""


def sampled_deformations(count: int) -> Array:
    """Deformation gradients (3, 3, count) without any symmetry, the same at every call."""
    return IDENTITY[:, :, None] + STRAIN * np.random.default_rng(0).uniform(-1.0, 1.0, (3, 3, count))


def cofactor(F: Array) -> Array:
    """J F^-T for ``F`` of shape (3, 3, ...), without a division: each column is the cross product of the other two."""
    a, b, c = F[:, 0], F[:, 1], F[:, 2]
    return np.stack([cross(b, c), cross(c, a), cross(a, b)], axis=1)


def cross(a: Array, b: Array) -> Array:
    """Cross product of vectors of shape (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def determinant(F: Array) -> Array:
    """J for ``F`` of shape (3, 3, ...): the triple product of its columns."""
    return np.einsum("i...,i...->...", F[:, 0], cross(F[:, 1], F[:, 2]))


def inverse_transpose(F: Array) -> Array:
    """F^-T, shape (3, 3, ...)."""
    return cofactor(F) / determinant(F)


def outer(A: Array, B: Array) -> Array:
    """A_iJ B_kL, shape (3, 3, 3, 3, ...)."""
    return np.einsum("iJ...,kL...->iJkL...", A, B)


def determinant_hessian(F: Array) -> Array:
    """d2J / dF_iJ dF_kL = J (T_iJ T_kL - T_iL T_kJ) with T = F^-T, shape (3, 3, 3, 3, ...)."""
    T = inverse_transpose(F)
    return determinant(F) * (outer(T, T) - np.einsum("iL...,kJ...->iJkL...", T, T))


def strain_invariants(F: Array) -> tuple[Array, Array]:
    """tr C and (tr^2 C - tr C^2) / 2 of C = F^T F, dimensionless, for F of shape (3, 3, ...)."""
    C = np.einsum("iJ...,iK...->JK...", F, F)
    trace = np.einsum("JJ...->...", C)
    return trace, (trace**2 - np.einsum("JK...,JK...->...", C, C)) / 2


def isochoric_invariants(F: Array) -> tuple[Array, Array]:
    """J^(-2/3) tr C and J^(-4/3) (tr^2 C - tr C^2) / 2, dimensionless, for F of shape (3, 3, ...); both 3 at rest."""
    J = determinant(F)
    i1, i2 = strain_invariants(F)
    return J ** (-2 / 3) * i1, J ** (-4 / 3) * i2


def isochoric_invariant_gradients(F: Array) -> tuple[Array, Array]:
    """dI1/dF and dI2/dF of the isochoric invariants, each of shape (3, 3, ...)."""
    J, T = determinant(F), inverse_transpose(F)
    i1, i2 = strain_invariants(F)
    di1, di2 = _strain_invariant_gradients(F)
    return J ** (-2 / 3) * (di1 - 2 / 3 * i1 * T), J ** (-4 / 3) * (di2 - 4 / 3 * i2 * T)


def isochoric_invariant_hessians(F: Array) -> tuple[Array, Array]:
    r"""d2I1/dFdF and d2I2/dFdF, each of shape (3, 3, 3, 3, ...).

    With :math:`I = J^{-n} i`, :math:`T = F^{-T}` and :math:`\partial T_{iJ} / \partial F_{kL} = -T_{iL} T_{kJ}`:

    .. math::
        \frac{\partial^2 I}{\partial F \partial F} = J^{-n} \left[ \frac{\partial^2 i}{\partial F \partial F}
        - n T \otimes \frac{\partial i}{\partial F} - n \frac{\partial i}{\partial F} \otimes T
        + n^2 i\, T \otimes T + n i\, T_{iL} T_{kJ} \right]
    """
    J, T = determinant(F), inverse_transpose(F)
    swapped = np.einsum("iL...,kJ...->iJkL...", T, T)
    ddI = []
    for n, i, di, ddi in zip(
        (2 / 3, 4 / 3), strain_invariants(F), _strain_invariant_gradients(F), _strain_invariant_hessians(F), strict=True
    ):
        split = n**2 * i * outer(T, T) + n * i * swapped - n * (outer(T, di) + outer(di, T))
        ddI.append(J ** (-n) * (ddi + split))
    return ddI[0], ddI[1]


def _strain_invariant_gradients(F: Array) -> tuple[Array, Array]:
    """2 F and 2 (tr C F - F C)."""
    C = np.einsum("iJ...,iK...->JK...", F, F)
    return 2 * F, 2 * (np.einsum("JJ...->...", C) * F - np.einsum("iK...,KJ...->iJ...", F, C))


def _strain_invariant_hessians(F: Array) -> tuple[Array, Array]:
    """2 d_ik d_JL and 2 (2 F_iJ F_kL + tr C d_ik d_JL - d_ik C_JL - F_iL F_kJ - B_ik d_JL)."""
    B = np.einsum("iJ...,kJ...->ik...", F, F)
    C = np.einsum("iJ...,iL...->JL...", F, F)
    unit = np.einsum("ik,JL->iJkL", IDENTITY, IDENTITY).reshape(3, 3, 3, 3, *(1,) * (F.ndim - 2))
    hessian = (
        2 * outer(F, F)
        + np.einsum("JJ...->...", C) * unit
        - np.einsum("ik,JL...->iJkL...", IDENTITY, C)
        - np.einsum("iL...,kJ...->iJkL...", F, F)
        - np.einsum("ik...,JL->iJkL...", B, IDENTITY)
    )
    return 2 * unit, 2 * hessian
