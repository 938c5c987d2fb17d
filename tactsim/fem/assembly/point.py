"""Compiled constitutive response at one point; tensors are 3 x 3, flattened as 3 i + J."""

from __future__ import annotations

import numba

from tactsim.fem.assembly.symmetric import SLOTS


@numba.njit(cache=True, inline="always")
def cofactor(F, cof):  # type: ignore[no-untyped-def]
    """Cofactor of F into ``cof``; returns the determinant."""
    cof[0] = F[4] * F[8] - F[5] * F[7]
    cof[1] = F[5] * F[6] - F[3] * F[8]
    cof[2] = F[3] * F[7] - F[4] * F[6]
    cof[3] = F[2] * F[7] - F[1] * F[8]
    cof[4] = F[0] * F[8] - F[2] * F[6]
    cof[5] = F[1] * F[6] - F[0] * F[7]
    cof[6] = F[1] * F[5] - F[2] * F[4]
    cof[7] = F[2] * F[3] - F[0] * F[5]
    cof[8] = F[0] * F[4] - F[1] * F[3]
    return F[0] * cof[0] + F[1] * cof[1] + F[2] * cof[2]


@numba.njit(cache=True)
def hyperelastic_stress(F, W1, W2, work):  # type: ignore[no-untyped-def]
    """Isochoric P into work[0], dI1bar/dF into work[1], dI2bar/dF into work[2], F^-T into work[3], I1 F - F C in work[4].

    Returns J, I1, I2 (not isochoric).
    """
    P, G1, G2, inverse, H = work[0], work[1], work[2], work[3], work[4]
    J = cofactor(F, inverse)
    for k in range(9):
        inverse[k] /= J
    I1 = 0.0
    for k in range(9):
        I1 += F[k] * F[k]
    trace_square = 0.0
    for i in range(3):
        for j in range(3):
            b = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2]
            work[5, 3 * i + j] = b
            trace_square += b * b
    I2 = 0.5 * (I1 * I1 - trace_square)
    a1 = J ** (-2.0 / 3.0)
    a2 = a1 * a1
    for i in range(3):
        for j in range(3):
            bF = 0.0
            for k in range(3):
                bF += work[5, 3 * i + k] * F[3 * k + j]
            m = 3 * i + j
            H[m] = I1 * F[m] - bF
            G1[m] = a1 * (2.0 * F[m] - 2.0 / 3.0 * I1 * inverse[m])
            G2[m] = a2 * (2.0 * H[m] - 4.0 / 3.0 * I2 * inverse[m])
            P[m] = W1 * G1[m] + W2 * G2[m]
    return J, I1, I2


@numba.njit(cache=True)
def hyperelastic_tangent(F, W, pressure, invariants, work, A):  # type: ignore[no-untyped-def]
    """dP/dF at fixed pressure into A (9, 9); ``work`` as the stress left it, W = (W1, W2, W11, W12, W22)."""
    G1, G2, inverse, H, b = work[1], work[2], work[3], work[4], work[5]
    J, I1, I2 = invariants
    W1, W2, W11, W12, W22 = W
    a1 = J ** (-2.0 / 3.0)
    a2 = a1 * a1
    pJ = pressure * J
    swap = W1 * a1 * (2.0 / 3.0) * I1 + W2 * a2 * (4.0 / 3.0) * I2 - pJ
    identity = 2.0 * (W1 * a1 + W2 * a2 * I1)
    for i in range(3):
        for j in range(3):
            m = 3 * i + j
            for k in range(3):
                for o in range(3):
                    n = 3 * k + o
                    if n < m:
                        continue
                    value = W11 * G1[m] * G1[n] + W12 * (G1[m] * G2[n] + G2[m] * G1[n]) + W22 * G2[m] * G2[n]
                    value += W1 * (-2.0 / 3.0 * G1[m] * inverse[n] - a1 * 4.0 / 3.0 * inverse[m] * F[n])
                    value += W2 * (-4.0 / 3.0 * G2[m] * inverse[n] - a2 * 8.0 / 3.0 * inverse[m] * H[n])
                    value += W2 * a2 * (4.0 * F[m] * F[n] - 2.0 * F[3 * i + o] * F[3 * k + j])
                    value += swap * inverse[3 * i + o] * inverse[3 * k + j] + pJ * inverse[m] * inverse[n]
                    if i == k:
                        C = F[j] * F[o] + F[3 + j] * F[3 + o] + F[6 + j] * F[6 + o]
                        value -= 2.0 * W2 * a2 * C
                        if j == o:
                            value += identity
                    if j == o:
                        value -= 2.0 * W2 * a2 * b[3 * i + k]
                    A[m, n] = value
                    A[n, m] = value


@numba.njit(cache=True)
def linear_stress(F, shear_modulus, work):  # type: ignore[no-untyped-def]
    """Deviatoric small-strain stress into work[0]; returns the volume change tr F - 3."""
    change = F[0] + F[4] + F[8] - 3.0
    for i in range(3):
        for j in range(3):
            work[0, 3 * i + j] = shear_modulus * (F[3 * i + j] + F[3 * j + i])
    for i in range(3):
        work[0, 4 * i] -= shear_modulus * (2.0 + 2.0 / 3.0 * change)
    return change


@numba.njit(cache=True)
def linear_tangent(shear_modulus, A):  # type: ignore[no-untyped-def]
    """dS/dF (9, 9) at fixed pressure of the isochoric stress of a linear elastic material, in Pa."""
    A[:, :] = 0.0
    for i in range(3):
        for j in range(3):
            A[3 * i + j, 3 * i + j] += shear_modulus
            A[3 * i + j, 3 * j + i] += shear_modulus
            A[4 * i, 4 * j] -= 2.0 / 3.0 * shear_modulus


@numba.njit(cache=True, inline="always")
def point_stress(F, W, linear, work, cof):  # type: ignore[no-untyped-def]
    """Stress without pressure into work[0], derivative of the volume change into ``cof`` (9,); returns the volume change."""
    if linear:
        for m in range(9):
            cof[m] = 1.0 if m % 4 == 0 else 0.0
        return linear_stress(F, W[0], work)
    J, _, _ = hyperelastic_stress(F, W[0], W[1], work)
    for m in range(9):
        cof[m] = J * work[3, m]
    return J - 1.0


@numba.njit(cache=True, inline="always")
def add_history_stress(F, history_stress, linear, work):  # type: ignore[no-untyped-def]
    """Add the stress of the history, a second Piola-Kirchhoff stress ``history_stress`` (6,), to work[0]."""
    for i in range(3):
        for j in range(3):
            if linear:
                work[0, 3 * i + j] += history_stress[SLOTS[3 * i + j]]
            else:
                for k in range(3):
                    work[0, 3 * i + j] += F[3 * i + k] * history_stress[SLOTS[3 * k + j]]


@numba.njit(cache=True, inline="always")
def add_history_tangent(history_stress, linear, A):  # type: ignore[no-untyped-def]
    """Add the derivative of that stress to A (9, 9): it follows the rotation of the material only."""
    if not linear:
        for i in range(3):
            for j in range(3):
                for o in range(3):
                    A[3 * i + j, 3 * i + o] += history_stress[SLOTS[3 * j + o]]


@numba.njit(cache=True)
def pulled_back(work, linear, S):  # type: ignore[no-untyped-def]
    """F^-1 P, or P where the material is linear, of the stress and F^-T that ``point_stress`` left, into S (6,)."""
    for i in range(3):
        for j in range(i, 3):
            value = work[0, 3 * i + j]
            if not linear:
                value = work[3, i] * work[0, j] + work[3, 3 + i] * work[0, 3 + j] + work[3, 6 + i] * work[0, 6 + j]
            S[SLOTS[3 * i + j]] = value


@numba.njit(cache=True, inline="always")
def point_tangent(F, W, linear, volume, work, cof, A):  # type: ignore[no-untyped-def]
    """dP/dF at fixed pressure into A (9, 9), derivative of the volume change into ``cof`` (9,); W holds the five slopes and
    ``volume`` the pressure, the compliance and the stiffness against a change of volume that the pressure does not ask for."""
    pressure, compliance, stiffness = volume
    if linear:
        for m in range(9):
            cof[m] = 1.0 if m % 4 == 0 else 0.0
        linear_tangent(W[0], A)
    else:
        invariants = hyperelastic_stress(F, W[0], W[1], work)
        excess = invariants[0] - 1.0 - compliance * pressure
        hyperelastic_tangent(F, W, pressure + stiffness * excess, invariants, work, A)
        for m in range(9):
            cof[m] = invariants[0] * work[3, m]
    for m in range(9):
        for n in range(9):
            A[m, n] += stiffness * cof[m] * cof[n]
