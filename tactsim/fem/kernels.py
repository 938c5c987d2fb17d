"""Compiled element loops of the mixed form: equal to the readable ones in ``forms`` to round-off.

Written once for two and three dimensions: ``dim`` counts in-plane components, the hoop row F[2, 2] exists where ``dim`` is 2
and is one in plane strain, where ``hoop`` is zero. Tensors are 3 x 3 throughout, flattened as 3 i + J.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np

BLOCK = 32
"""Elements per task of a thread."""


@numba.njit(cache=True, inline="always")
def _cofactor(F, cof):  # type: ignore[no-untyped-def]
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
def _hyperelastic_stress(F, W1, W2, work):  # type: ignore[no-untyped-def]
    """Isochoric P into work[0], dI1bar/dF into work[1], dI2bar/dF into work[2], F^-T into work[3], I1 F - F C in work[4].

    Returns J, I1, I2 (not isochoric).
    """
    P, G1, G2, inverse, H = work[0], work[1], work[2], work[3], work[4]
    J = _cofactor(F, inverse)
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
def _hyperelastic_tangent(F, W, pressure, invariants, work, A):  # type: ignore[no-untyped-def]
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
def _linear_stress(F, shear_modulus, work):  # type: ignore[no-untyped-def]
    """Deviatoric small-strain stress into work[0]; returns the volume change tr F - 3."""
    change = F[0] + F[4] + F[8] - 3.0
    for i in range(3):
        for j in range(3):
            work[0, 3 * i + j] = shear_modulus * (F[3 * i + j] + F[3 * j + i])
    for i in range(3):
        work[0, 4 * i] -= shear_modulus * (2.0 + 2.0 / 3.0 * change)
    return change


@numba.njit(cache=True)
def _linear_tangent(shear_modulus, A):  # type: ignore[no-untyped-def]
    A[:, :] = 0.0
    for i in range(3):
        for j in range(3):
            A[3 * i + j, 3 * i + j] += shear_modulus
            A[3 * i + j, 3 * j + i] += shear_modulus
            A[4 * i, 4 * j] -= 2.0 / 3.0 * shear_modulus


@numba.njit(cache=True, inline="always")
def _fill(dim, u, nodes, gradients, hoop, F):  # type: ignore[no-untyped-def]
    """Deformation gradient of one point into F (9,)."""
    for m in range(9):
        F[m] = 0.0
    F[0] = F[4] = F[8] = 1.0
    for a in range(nodes.shape[0]):
        for i in range(dim):
            value = u[nodes[a], i]
            for j in range(dim):
                F[3 * i + j] += value * gradients[a, j]
        if dim == 2:
            F[8] += u[nodes[a], 0] * hoop[a]


@cache
def compiled(dim: int) -> SimpleNamespace:
    """The element loops for ``dim`` components: ``deformation``, ``residual`` and ``tangent``.

    They may close over numbers only: numba never finds the stored code of a function that closes over a compiled one.
    """
    return SimpleNamespace(deformation=_deformation_loop(dim), residual=_residual_loop(dim), tangent=_tangent_loop(dim))


def _deformation_loop(dim: int) -> Callable[..., Any]:
    @numba.njit(cache=True, parallel=True)
    def deformation(u, elements, gradients, hoop, F_out, invariants):  # type: ignore[no-untyped-def]
        """F at every point into F_out (9, E, Q); J, I1bar, I2bar into invariants (3, E, Q)."""
        count, points = gradients.shape[:2]
        for task in numba.prange((count + 255) // 256):
            F, work = np.empty(9), np.empty((6, 9))
            for e in range(256 * task, min(count, 256 * task + 256)):
                for q in range(points):
                    _fill(dim, u, elements[e], gradients[e, q], hoop[e, q], F)
                    J, I1, I2 = _hyperelastic_stress(F, 0.0, 0.0, work)
                    scale = abs(J) ** (-2.0 / 3.0)
                    invariants[0, e, q] = J
                    invariants[1, e, q] = scale * I1
                    invariants[2, e, q] = scale * scale * I2
                    for m in range(9):
                        F_out[m, e, q] = F[m]

    return deformation


def _residual_loop(dim: int) -> Callable[..., Any]:
    width = 6 if dim == 2 else 10
    corners = dim + 1

    @numba.njit(cache=True, parallel=True)
    def residual(  # type: ignore[no-untyped-def]
        u, p, tables, W, order, starts, out
    ):
        elements, gradients, hoop, weights, shape_p, linear, compliance = tables
        offset = u.size
        for color in range(starts.size - 1):
            first, last = starts[color], starts[color + 1]
            for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
                F, cof = np.empty(9), np.empty(9)
                work = np.empty((6, 9))
                Ru, Rp = np.empty((width, dim)), np.empty(corners)
                for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                    e = order[s]
                    Ru[:] = 0.0
                    Rp[:] = 0.0
                    for q in range(weights.shape[1]):
                        _fill(dim, u, elements[e], gradients[e, q], hoop[e, q], F)
                        pressure = 0.0
                        for v in range(corners):
                            pressure += shape_p[q, v] * p[elements[e, v]]
                        if linear[e]:
                            change = _linear_stress(F, W[0, e, q], work)
                            for m in range(9):
                                cof[m] = 1.0 if m % 4 == 0 else 0.0
                        else:
                            J, _, _ = _hyperelastic_stress(F, W[0, e, q], W[1, e, q], work)
                            change = J - 1.0
                            for m in range(9):
                                cof[m] = J * work[3, m]
                        w = weights[e, q]
                        P = work[0]
                        for m in range(9):
                            P[m] = w * (P[m] + pressure * cof[m])
                        for a in range(width):
                            for i in range(dim):
                                for j in range(dim):
                                    Ru[a, i] += P[3 * i + j] * gradients[e, q, a, j]
                            if dim == 2:
                                Ru[a, 0] += P[8] * hoop[e, q, a]
                        change = w * (change - compliance[e] * pressure)
                        for v in range(corners):
                            Rp[v] += change * shape_p[q, v]
                    for a in range(width):
                        for i in range(dim):
                            out[elements[e, a] * dim + i] += Ru[a, i]
                    for v in range(corners):
                        out[offset + elements[e, v]] += Rp[v]

    return residual


def _tangent_loop(dim: int) -> Callable[..., Any]:
    width = 6 if dim == 2 else 10
    corners = dim + 1

    @numba.njit(cache=True, parallel=True, fastmath={"contract", "reassoc", "nsz"})
    def tangent(  # type: ignore[no-untyped-def]
        u, p, tables, W, order, starts, indptr, offsets, data
    ):
        elements, gradients, hoop, weights, shape_p, linear, compliance = tables
        pressure_rows = u.size
        for color in range(starts.size - 1):
            first, last = starts[color], starts[color + 1]
            for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
                F, cof, g = np.empty(9), np.empty(9), np.empty((3, width))
                work, A = np.empty((6, 9)), np.empty((9, 9))
                T = np.empty((3, width))
                K, B, D = np.empty((dim, width, dim, width)), np.empty((dim, width, corners)), np.empty((corners, corners))
                for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                    e = order[s]
                    K[:] = 0.0
                    B[:] = 0.0
                    D[:] = 0.0
                    for q in range(weights.shape[1]):
                        _fill(dim, u, elements[e], gradients[e, q], hoop[e, q], F)
                        pressure = 0.0
                        for v in range(corners):
                            pressure += shape_p[q, v] * p[elements[e, v]]
                        if linear[e]:
                            _linear_tangent(W[0, e, q], A)
                            for m in range(9):
                                cof[m] = 1.0 if m % 4 == 0 else 0.0
                        else:
                            invariants = _hyperelastic_stress(F, W[0, e, q], W[1, e, q], work)
                            slopes = (W[0, e, q], W[1, e, q], W[2, e, q], W[3, e, q], W[4, e, q])
                            _hyperelastic_tangent(F, slopes, pressure, invariants, work, A)
                            for m in range(9):
                                cof[m] = invariants[0] * work[3, m]
                        w = weights[e, q]
                        for a in range(width):
                            for j in range(dim):
                                g[j, a] = gradients[e, q, a, j]
                            if dim == 2:
                                g[2, a] = hoop[e, q, a]
                        for k in range(dim):
                            for i in range(k + 1):
                                for j in range(dim):
                                    m = 3 * i + j
                                    for b in range(width):
                                        value = A[m, 3 * k] * g[0, b] + A[m, 3 * k + 1] * g[1, b]
                                        if dim == 3:
                                            value += A[m, 3 * k + 2] * g[2, b]
                                        elif k == 0:
                                            value += A[m, 8] * g[2, b]
                                        T[j, b] = w * value
                                if dim == 2 and i == 0:
                                    for b in range(width):
                                        value = A[8, 3 * k] * g[0, b] + A[8, 3 * k + 1] * g[1, b]
                                        if k == 0:
                                            value += A[8, 8] * g[2, b]
                                        T[2, b] = w * value
                                for a in range(width):
                                    for b in range(width):
                                        value = g[0, a] * T[0, b] + g[1, a] * T[1, b]
                                        if dim == 3 or i == 0:
                                            value += g[2, a] * T[2, b]
                                        K[i, a, k, b] += value
                        for i in range(dim):
                            for a in range(width):
                                value = 0.0
                                for j in range(dim):
                                    value += cof[3 * i + j] * g[j, a]
                                if dim == 2 and i == 0:
                                    value += cof[8] * g[2, a]
                                for v in range(corners):
                                    B[i, a, v] += w * value * shape_p[q, v]
                        for v in range(corners):
                            for x in range(corners):
                                D[v, x] -= w * compliance[e] * shape_p[q, v] * shape_p[q, x]
                    place = offsets[e]
                    for a in range(width):
                        for i in range(dim):
                            start = indptr[elements[e, a] * dim + i]
                            for b in range(width):
                                at = start + place[a, b]
                                for k in range(dim):
                                    data[at + k] += K[i, a, k, b] if i <= k else K[k, b, i, a]
                            for v in range(corners):
                                data[start + place[a, width + v]] += B[i, a, v]
                    for v in range(corners):
                        start = indptr[pressure_rows + elements[e, v]]
                        for b in range(width):
                            at = start + place[width + v, b]
                            for k in range(dim):
                                data[at + k] += B[k, b, v]
                        for x in range(corners):
                            data[start + place[width + v, width + x]] += D[v, x]

    return tangent
