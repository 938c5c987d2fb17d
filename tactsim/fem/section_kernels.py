"""Compiled element loops of sections: equal to the readable ones in ``forms`` to round-off.

In a section F has five entries besides zeros: F11, F12, F21, F22, and F33 of the hoop, which is one in plane strain. Everything is
written out for these, held in registers, and summed over an element before it is added to the body: a third of the time of the
loops over 3 x 3 tensors that serve solids (``kernels``), here 0.3 us a point for a tangent and 0.1 us for a residual.
"""

from __future__ import annotations

import numba
import numpy as np

BLOCK = 64
"""Elements per task of a thread."""


@numba.njit(cache=True, fastmath={"contract"})
def _deformation_gradient(u, nodes, gradients, hoop):  # type: ignore[no-untyped-def]
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


@numba.njit(cache=True, fastmath={"contract"})
def _pressure(p, corners, shape_p):  # type: ignore[no-untyped-def]
    """Pressure at one point."""
    return shape_p[0] * p[corners[0]] + shape_p[1] * p[corners[1]] + shape_p[2] * p[corners[2]]


@numba.njit(cache=True, fastmath={"contract"})
def _invariants(F):  # type: ignore[no-untyped-def]
    """The area ratio, its slope by the four entries in the plane, the sum of their squares, J, I1, I2 and J^(-2/3)."""
    a, b, c, d, t = F
    area, square = a * d - b * c, a * a + b * b + c * c + d * d
    J = area * t
    return area, (d, -c, -b, a), square, J, square + t * t, area * area + square * t * t, abs(J) ** (-2.0 / 3.0)


@numba.njit(cache=True, fastmath={"contract"})
def _isochoric_gradients(F, invariants):  # type: ignore[no-untyped-def]
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


@numba.njit(cache=True, fastmath={"contract"})
def _isochoric_stress(F, W1, W2, linear, P, volume_slope):  # type: ignore[no-untyped-def]
    """Isochoric P into ``P`` (5,), the slope of the volume change into ``volume_slope`` (5,); returns the volume change."""
    a, b, c, d, t = F
    if linear:
        change, shear = a + d + t - 3.0, W1 * (b + c)
        mean = W1 * (2.0 + 2.0 / 3.0 * change)
        P[0], P[1], P[2], P[3], P[4] = 2.0 * W1 * a - mean, shear, shear, 2.0 * W1 * d - mean, 2.0 * W1 * t - mean
        volume_slope[0], volume_slope[1], volume_slope[2], volume_slope[3], volume_slope[4] = 1.0, 0.0, 0.0, 1.0, 1.0
        return change
    invariants = _invariants(F)
    G1, G2, _, _ = _isochoric_gradients(F, invariants)
    area, slope = invariants[0], invariants[1]
    for m in range(4):
        volume_slope[m] = slope[m] * t
    volume_slope[4] = area
    for m in range(5):
        P[m] = W1 * G1[m] + W2 * G2[m]
    return invariants[3] - 1.0


@numba.njit(cache=True, fastmath={"contract"})
def _add_history_stress(F, S, linear, P):  # type: ignore[no-untyped-def]
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


@numba.njit(cache=True, fastmath={"contract"})
def _moduli(F, W, linear, volume, volume_slope, A):  # type: ignore[no-untyped-def]
    """dP/dF at fixed pressure into A (5, 5), slope of the volume change into ``volume_slope`` (5,); W are the five slopes of the
    energy and ``volume`` the pressure, the compliance and the stiffness against a change of volume that it does not ask for."""
    a, b, c, d, t = F
    W1, W2, W11, W12, W22 = W
    pressure, compliance, stiffness = volume
    if linear:
        volume_slope[0], volume_slope[1], volume_slope[2], volume_slope[3], volume_slope[4] = 1.0, 0.0, 0.0, 1.0, 1.0
        for m in range(5):
            for n in range(5):
                A[m, n] = (stiffness - 2.0 / 3.0 * W1) * volume_slope[m] * volume_slope[n]
            A[m, m] += W1 * (1.0 + volume_slope[m])
        A[1, 2] += W1
        A[2, 1] += W1
        return
    invariants = _invariants(F)
    area, slope, square, J, I1, I2, a1 = invariants
    G1, G2, inverse, H = _isochoric_gradients(F, invariants)
    first, second = W1 * a1, W2 * a1 * a1
    pJ = J * (pressure + stiffness * (J - 1.0 - compliance * pressure))
    bend = pJ - 2.0 / 3.0 * first * I1 - 4.0 / 3.0 * second * I2  # of the second derivative of J over J
    whole = 10.0 / 9.0 * first * I1 + 28.0 / 9.0 * second * I2 + stiffness * J * J
    for m in range(4):
        volume_slope[m] = slope[m] * t
    volume_slope[4] = area
    flat, twice = 2.0 * (first + second * t * t), 2.0 * second
    for m in range(5):
        mixed_m = 4.0 / 3.0 * first * F[m] + 8.0 / 3.0 * second * H[m]
        for n in range(m, 5):
            mixed_n = 4.0 / 3.0 * first * F[n] + 8.0 / 3.0 * second * H[n]
            value = W11 * G1[m] * G1[n] + W12 * (G1[m] * G2[n] + G2[m] * G1[n]) + W22 * G2[m] * G2[n]
            value += whole * inverse[m] * inverse[n] - mixed_m * inverse[n] - mixed_n * inverse[m]
            if m < 4 and n < 4:
                value += twice * slope[m] * slope[n]
            A[m, n] = value
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


@numba.njit(cache=True, fastmath={"contract"})
def _add_history_moduli(S, A):  # type: ignore[no-untyped-def]
    """Add the derivative of the stress of the history to A (5, 5)."""
    for row in (0, 2):
        A[row, row] += S[0]
        A[row, row + 1] += S[3]
        A[row + 1, row] += S[3]
        A[row + 1, row + 1] += S[1]
    A[4, 4] += S[2]


@numba.njit(cache=True, fastmath={"contract"})
def _add_stiffness(A, gradients, hoop, weight, T, K):  # type: ignore[no-untyped-def]
    """Blocks of the displacement tangent at one point, radial with radial, radial with axial, axial with axial: into K (3, 6, 6).

    ``T`` (7, 6) is what A leaves of the shape functions of a column: three entries of F by the radial displacement, four more by
    the axial one.
    """
    for n in range(6):
        x, z, h = weight * gradients[n, 0], weight * gradients[n, 1], weight * hoop[n]
        T[0, n] = A[0, 0] * x + A[0, 1] * z + A[0, 4] * h
        T[1, n] = A[1, 0] * x + A[1, 1] * z + A[1, 4] * h
        T[2, n] = A[4, 0] * x + A[4, 1] * z + A[4, 4] * h
        T[3, n] = A[0, 2] * x + A[0, 3] * z
        T[4, n] = A[1, 2] * x + A[1, 3] * z
        T[5, n] = A[4, 2] * x + A[4, 3] * z
        T[6, n] = A[2, 2] * x + A[2, 3] * z
        T[7, n] = A[3, 2] * x + A[3, 3] * z
    for m in range(6):
        x, z, h = gradients[m, 0], gradients[m, 1], hoop[m]
        for n in range(6):
            K[0, m, n] += x * T[0, n] + z * T[1, n] + h * T[2, n]
            K[1, m, n] += x * T[3, n] + z * T[4, n] + h * T[5, n]
            K[2, m, n] += x * T[6, n] + z * T[7, n]


@numba.njit(cache=True, fastmath={"contract"})
def _scatter(K, B, D, nodes, pressure_rows, indptr, place, data):  # type: ignore[no-untyped-def]
    """Add the blocks K (3, 6, 6), B (2, 6, 3) and D (3, 3) of one element to the matrix entries."""
    for m in range(6):
        radial, axial = indptr[nodes[m] * 2], indptr[nodes[m] * 2 + 1]
        for n in range(6):
            at = place[m, n]
            data[radial + at] += K[0, m, n]
            data[radial + at + 1] += K[1, m, n]
            data[axial + at] += K[1, n, m]
            data[axial + at + 1] += K[2, m, n]
        for v in range(3):
            at = place[m, 6 + v]
            data[radial + at] += B[0, m, v]
            data[axial + at] += B[1, m, v]
    for v in range(3):
        start = indptr[pressure_rows[v]]
        for n in range(6):
            at = start + place[6 + v, n]
            data[at] += B[0, n, v]
            data[at + 1] += B[1, n, v]
        for x in range(3):
            data[start + place[6 + v, 6 + x]] += D[v, x]


@numba.njit(cache=True, parallel=True, fastmath={"contract"})
def deformation(u, elements, gradients, hoop, F_out, invariants):  # type: ignore[no-untyped-def]
    """F at every point into F_out (9, E, Q), which holds zeros; J, I1bar, I2bar into invariants (3, E, Q)."""
    count, points = gradients.shape[:2]
    for task in numba.prange((count + 255) // 256):
        for e in range(256 * task, min(count, 256 * task + 256)):
            for q in range(points):
                F = _deformation_gradient(u, elements[e], gradients[e, q], hoop[e, q])
                _, _, _, J, I1, I2, scale = _invariants(F)
                invariants[0, e, q] = J
                invariants[1, e, q] = scale * I1
                invariants[2, e, q] = scale * scale * I2
                F_out[0, e, q], F_out[1, e, q], F_out[3, e, q], F_out[4, e, q], F_out[8, e, q] = F


@numba.njit(cache=True, parallel=True, fastmath={"contract"})
def residual(u, p, tables, W, history_stress, order, starts, out):  # type: ignore[no-untyped-def]
    """Internal forces, then volume constraints, added to ``out``; ``history_stress`` (6, E, Q), or (6, 0, 0) for none."""
    elements, pressures, gradients, hoop, weights, shape_p, linear, compliance, stiffness = tables
    for color in range(starts.size - 1):
        first, last = starts[color], starts[color + 1]
        for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
            P, slope, forces, volumes = np.empty(5), np.empty(5), np.empty((6, 2)), np.empty(3)
            for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                e = order[s]
                nodes = elements[e]
                forces[:], volumes[:] = 0.0, 0.0
                for q in range(weights.shape[1]):
                    F = _deformation_gradient(u, nodes, gradients[e, q], hoop[e, q])
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    change = _isochoric_stress(F, W[0, e, q], W[1, e, q], linear[e], P, slope)
                    if history_stress.shape[1]:
                        _add_history_stress(F, history_stress[:, e, q], linear[e], P)
                    change -= compliance[e] * pressure
                    pressure += stiffness[e] * change
                    for m in range(5):
                        P[m] = weight * (P[m] + pressure * slope[m])
                    for n in range(6):
                        x, z = gradients[e, q, n, 0], gradients[e, q, n, 1]
                        forces[n, 0] += P[0] * x + P[1] * z + P[4] * hoop[e, q, n]
                        forces[n, 1] += P[2] * x + P[3] * z
                    change *= weight * (1.0 - stiffness[e] * compliance[e])
                    for v in range(3):
                        volumes[v] += change * shape_p[q, v]
                for n in range(6):
                    out[2 * nodes[n]] += forces[n, 0]
                    out[2 * nodes[n] + 1] += forces[n, 1]
                for v in range(3):
                    out[u.size + pressures[e, v]] += volumes[v]


@numba.njit(cache=True, parallel=True, fastmath={"contract", "reassoc", "nsz"})
def tangent(u, p, tables, W, history_stress, order, starts, indptr, offsets, data):  # type: ignore[no-untyped-def]
    """Entries of the tangent, added to ``data``."""
    elements, pressures, gradients, hoop, weights, shape_p, linear, compliance, stiffness = tables
    for color in range(starts.size - 1):
        first, last = starts[color], starts[color + 1]
        for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
            slope, A, T = np.empty(5), np.empty((5, 5)), np.empty((8, 6))
            K, B, D = np.empty((3, 6, 6)), np.empty((2, 6, 3)), np.empty((3, 3))
            for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                e = order[s]
                nodes = elements[e]
                K[:], B[:], D[:] = 0.0, 0.0, 0.0
                for q in range(weights.shape[1]):
                    F = _deformation_gradient(u, nodes, gradients[e, q], hoop[e, q])
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    slopes = (W[0, e, q], W[1, e, q], W[2, e, q], W[3, e, q], W[4, e, q])
                    _moduli(F, slopes, linear[e], (pressure, compliance[e], stiffness[e]), slope, A)
                    if history_stress.shape[1] and not linear[e]:
                        _add_history_moduli(history_stress[:, e, q], A)
                    _add_stiffness(A, gradients[e, q], hoop[e, q], weight, T, K)
                    weight *= 1.0 - stiffness[e] * compliance[e]
                    for n in range(6):
                        x, z = weight * gradients[e, q, n, 0], weight * gradients[e, q, n, 1]
                        radial = slope[0] * x + slope[1] * z + weight * slope[4] * hoop[e, q, n]
                        axial = slope[2] * x + slope[3] * z
                        for v in range(3):
                            B[0, n, v] += radial * shape_p[q, v]
                            B[1, n, v] += axial * shape_p[q, v]
                    for v in range(3):
                        for x in range(3):
                            D[v, x] -= weight * compliance[e] * shape_p[q, v] * shape_p[q, x]
                _scatter(K, B, D, nodes, u.size + pressures[e], indptr, offsets[e], data)
