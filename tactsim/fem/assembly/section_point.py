"""Compiled constitutive response at one point of a section, where F has the entries F11, F12, F21, F22 and F33 besides zeros.

F33 is that of the hoop, which is one in plane strain. The five are held in registers.
"""

from __future__ import annotations

import numba


@numba.njit(cache=True)
def deformation_gradient(u, nodes, gradients, hoop):  # type: ignore[no-untyped-def]
    """F11, F12, F21, F22 and F33 at one point."""
    a, b, c, d, t = 1.0, 0.0, 0.0, 1.0, 1.0
    for n in range(6):
        radial, axial = u[nodes[n], 0], u[nodes[n], 1]
        a += radial * gradients[n, 0]
        b += radial * gradients[n, 1]
        c += axial * gradients[n, 0]
        d += axial * gradients[n, 1]
        t += radial * hoop[n]
    return a, b, c, d, t


@numba.njit(cache=True)
def deformation_invariants(F):  # type: ignore[no-untyped-def]
    """The area ratio, its slope by the four entries in the plane, the sum of their squares, J, I1, I2 and J^(-2/3)."""
    a, b, c, d, t = F
    area, square = a * d - b * c, a * a + b * b + c * c + d * d
    J = area * t
    return area, (d, -c, -b, a), square, J, square + t * t, area * area + square * t * t, abs(J) ** (-2.0 / 3.0)


@numba.njit(cache=True)
def isochoric_gradients(F, invariants):  # type: ignore[no-untyped-def]
    """dI1bar/dF and dI2bar/dF (5,), F^-T (5,), and half of dI2/dF (5,)."""
    a, b, c, d, t = F
    area, slope, square, _, I1, I2, a1 = invariants
    inverse = (slope[0] / area, slope[1] / area, slope[2] / area, slope[3] / area, 1.0 / t)
    H = (area * d + t * t * a, t * t * b - area * c, t * t * c - area * b, area * a + t * t * d, square * t)
    first, second, a2 = 2.0 / 3.0 * I1, 4.0 / 3.0 * I2, a1 * a1
    G1 = (
        a1 * (2.0 * a - first * inverse[0]),
        a1 * (2.0 * b - first * inverse[1]),
        a1 * (2.0 * c - first * inverse[2]),
        a1 * (2.0 * d - first * inverse[3]),
        a1 * (2.0 * t - first * inverse[4]),
    )
    G2 = (
        a2 * (2.0 * H[0] - second * inverse[0]),
        a2 * (2.0 * H[1] - second * inverse[1]),
        a2 * (2.0 * H[2] - second * inverse[2]),
        a2 * (2.0 * H[3] - second * inverse[3]),
        a2 * (2.0 * H[4] - second * inverse[4]),
    )
    return G1, G2, inverse, H


@numba.njit(cache=True)
def isochoric_stress(F, W1, W2, linear, P, volume_slope):  # type: ignore[no-untyped-def]
    """Isochoric P into ``P`` (5,), the slope of the volume change into ``volume_slope`` (5,); returns the volume change."""
    a, b, c, d, t = F
    if linear:
        change, shear = a + d + t - 3.0, W1 * (b + c)
        mean = W1 * (2.0 + 2.0 / 3.0 * change)
        P[0], P[1], P[2], P[3], P[4] = 2.0 * W1 * a - mean, shear, shear, 2.0 * W1 * d - mean, 2.0 * W1 * t - mean
        volume_slope[0], volume_slope[1], volume_slope[2], volume_slope[3], volume_slope[4] = 1.0, 0.0, 0.0, 1.0, 1.0
        return change
    invariants = deformation_invariants(F)
    G1, G2, _, _ = isochoric_gradients(F, invariants)
    area, slope = invariants[0], invariants[1]
    for m in range(4):
        volume_slope[m] = slope[m] * t
    volume_slope[4] = area
    for m in range(5):
        P[m] = W1 * G1[m] + W2 * G2[m]
    return invariants[3] - 1.0


@numba.njit(cache=True)
def add_history_stress(F, S, linear, P):  # type: ignore[no-untyped-def]
    """Add the stress of the history, a second Piola-Kirchhoff stress S (11, 22, 33, 12, ...), to P (5,)."""
    if linear:
        a, b, c, d, t = 1.0, 0.0, 0.0, 1.0, 1.0
    else:
        a, b, c, d, t = F
    P[0] += a * S[0] + b * S[3]
    P[1] += a * S[3] + b * S[1]
    P[2] += c * S[0] + d * S[3]
    P[3] += c * S[3] + d * S[1]
    P[4] += t * S[2]


@numba.njit(cache=True)
def linear_moduli(shear_modulus, stiffness, volume_slope, A):  # type: ignore[no-untyped-def]
    """What ``moduli`` gives where the material is linear."""
    volume_slope[0], volume_slope[1], volume_slope[2], volume_slope[3], volume_slope[4] = 1.0, 0.0, 0.0, 1.0, 1.0
    for m in range(5):
        for n in range(5):
            A[m, n] = (stiffness - 2.0 / 3.0 * shear_modulus) * volume_slope[m] * volume_slope[n]
        A[m, m] += shear_modulus * (1.0 + volume_slope[m])
    A[1, 2] += shear_modulus
    A[2, 1] += shear_modulus


@numba.njit(cache=True)
def moduli(F, W, linear, volume, volume_slope, A):  # type: ignore[no-untyped-def]
    """dP/dF at fixed pressure into A (5, 5), slope of the volume change into ``volume_slope`` (5,); W are the five slopes of the
    energy and ``volume`` the pressure, the compliance and the stiffness against a change of volume that it does not ask for."""
    t, (W1, W2, W11, W12, W22) = F[4], W
    pressure, compliance, stiffness = volume
    if linear:
        linear_moduli(W1, stiffness, volume_slope, A)
        return
    invariants = deformation_invariants(F)
    area, slope, square, J, I1, I2, a1 = invariants
    G1, G2, inverse, H = isochoric_gradients(F, invariants)
    first, second = W1 * a1, W2 * a1 * a1
    pJ = J * (pressure + stiffness * (J - 1.0 - compliance * pressure))
    bend = pJ - 2.0 / 3.0 * first * I1 - 4.0 / 3.0 * second * I2  # of the second derivative of J over J
    whole = 10.0 / 9.0 * first * I1 + 28.0 / 9.0 * second * I2 + stiffness * J * J
    for m in range(4):
        volume_slope[m] = slope[m] * t
    volume_slope[4] = area
    flat, twice = 2.0 * (first + second * t * t), 2.0 * second
    for n in range(5):
        mixed = 4.0 / 3.0 * first * F[n] + 8.0 / 3.0 * second * H[n]
        by_first, by_second = W11 * G1[n] + W12 * G2[n], W12 * G1[n] + W22 * G2[n]
        by_inverse = whole * inverse[n] - mixed
        for m in range(n + 1):
            A[m, n] = G1[m] * by_first + G2[m] * by_second + inverse[m] * by_inverse
            A[m, n] -= (4.0 / 3.0 * first * F[m] + 8.0 / 3.0 * second * H[m]) * inverse[n]
    for n in range(4):
        for m in range(n + 1):
            A[m, n] += twice * slope[m] * slope[n]
    turning = bend / area + twice * area  # of the second derivative of the area ratio
    A[0, 3] += turning
    A[1, 2] -= turning
    for m in range(4):
        A[m, m] += flat
        A[m, 4] += bend / J * slope[m] + 2.0 * twice * t * F[m]
    A[4, 4] += 2.0 * first + twice * square
    for m in range(5):
        for n in range(m):
            A[m, n] = A[n, m]


@numba.njit(cache=True)
def add_history_moduli(S, A):  # type: ignore[no-untyped-def]
    """Add the derivative of the stress of the history to A (5, 5)."""
    for row in (0, 2):
        A[row, row] += S[0]
        A[row, row + 1] += S[3]
        A[row + 1, row] += S[3]
        A[row + 1, row + 1] += S[1]
    A[4, 4] += S[2]


@numba.njit(cache=True)
def pulled_back(F, P, linear, S):  # type: ignore[no-untyped-def]
    """F^-1 P, or P where the material is linear, of P (5,), into S (11, 22, 33, 12)."""
    if linear:
        a, b, c, d, t = 1.0, 0.0, 0.0, 1.0, 1.0
    else:
        a, b, c, d, t = F
    area = a * d - b * c
    S[0] = (d * P[0] - b * P[2]) / area
    S[1] = (a * P[3] - c * P[1]) / area
    S[2] = P[4] / t
    S[3] = (d * P[1] - b * P[3]) / area
