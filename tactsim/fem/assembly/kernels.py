"""Compiled element loops of the mixed form: equal to the readable ones in ``forms`` to round-off.

Those of solids stand here, those of sections, which need less, in ``section_kernels``. Tensors are 3 x 3, flattened as 3 i + J. A
displacement component i acts on its own row of F, ``ENTRIES[i]``, through the three rows of shape function gradients.

Sums keep their order (no ``reassoc``): numba optimises a parallel loop once more for its cache than for the process that compiles
it, so that the first run on a machine would differ from all others by round-off, which a 3D indentation made 1e-5 of the force.
"""

from __future__ import annotations

import numba
import numpy as np

from tactsim.fem.assembly import point
from tactsim.fem.assembly.point import (
    add_history_stress,
    add_history_tangent,
    hyperelastic_stress,
    point_stress,
    point_tangent,
    pulled_back,
)
from tactsim.outside.compiled_loops import forget_stale

BLOCK = 32
"""Elements per task of a thread."""
ENTRIES = ((0, 1, 2), (3, 4, 5), (6, 7, 8))
WIDTH, CORNERS = 10, 4
"""Nodes of an element, and those of its pressure."""


@numba.njit(cache=True, inline="always")
def _deform(entries, u, nodes, gradients, g, F):  # type: ignore[no-untyped-def]
    """Gradient rows of one point into g (3, 3, A) and its deformation gradient into F (9,)."""
    for m in range(9):
        F[m] = 1.0 if m % 4 == 0 else 0.0
    for i in range(3):
        for a in range(len(nodes)):
            for j in range(3):
                g[i, j, a] = gradients[a, j]
                F[entries[i][j]] += u[nodes[a], i] * g[i, j, a]


@numba.njit(cache=True, inline="always")
def _pressure(p, nodes, shape_p):  # type: ignore[no-untyped-def]
    """Pressure at one point."""
    value = 0.0
    for v in range(len(shape_p)):
        value += shape_p[v] * p[nodes[v]]
    return value


@numba.njit(cache=True, inline="always")
def _add_stiffness(entries, A, g, weight, T, K):  # type: ignore[no-untyped-def]
    """Blocks i <= k of the displacement tangent at one point, into K (dim, A, dim, A)."""
    width = g.shape[2]
    for k in range(len(entries)):
        for i in range(k + 1):
            for j in range(3):
                first, second, third = (
                    weight * A[entries[i][j], entries[k][0]],
                    weight * A[entries[i][j], entries[k][1]],
                    weight * A[entries[i][j], entries[k][2]],
                )
                for b in range(width):
                    T[j, b] = first * g[k, 0, b] + second * g[k, 1, b] + third * g[k, 2, b]
            for a in range(width):
                for b in range(width):
                    K[i, a, k, b] += g[i, 0, a] * T[0, b] + g[i, 1, a] * T[1, b] + g[i, 2, a] * T[2, b]


@numba.njit(cache=True, inline="always")
def _add_coupling(entries, cof, g, shape_p, weight, B):  # type: ignore[no-untyped-def]
    """Coupling of displacement and pressure at one point, into B (dim, A, V)."""
    for i in range(len(entries)):
        for a in range(g.shape[2]):
            value = cof[entries[i][0]] * g[i, 0, a] + cof[entries[i][1]] * g[i, 1, a] + cof[entries[i][2]] * g[i, 2, a]
            for v in range(len(shape_p)):
                B[i, a, v] += weight * value * shape_p[v]


@numba.njit(cache=True, inline="always")
def _scatter(blocks, nodes, pressure_rows, indptr, place, data):  # type: ignore[no-untyped-def]
    """Add the blocks (K, B, D) of one element to the matrix entries."""
    K, B, D = blocks
    dim, width, corners = B.shape
    for a in range(width):
        for i in range(dim):
            start = indptr[nodes[a] * dim + i]
            for b in range(width):
                at = start + place[a, b]
                for k in range(dim):
                    data[at + k] += K[i, a, k, b] if i <= k else K[k, b, i, a]
            for v in range(corners):
                data[start + place[a, width + v]] += B[i, a, v]
    for v in range(corners):
        start = indptr[pressure_rows[v]]
        for b in range(width):
            at = start + place[width + v, b]
            for k in range(dim):
                data[at + k] += B[k, b, v]
        for x in range(corners):
            data[start + place[width + v, width + x]] += D[v, x]


@numba.njit(cache=True, parallel=True)
def deformation(u, elements, gradients, _hoop, F_out, invariants):  # type: ignore[no-untyped-def]
    """F at every point into F_out (9, E, Q); J, I1bar, I2bar into invariants (3, E, Q)."""
    count, points = gradients.shape[:2]
    for task in numba.prange((count + 255) // 256):
        F, g, work = np.empty(9), np.empty((3, 3, WIDTH)), np.empty((6, 9))
        for e in range(256 * task, min(count, 256 * task + 256)):
            for q in range(points):
                _deform(ENTRIES, u, elements[e], gradients[e, q], g, F)
                J, I1, I2 = hyperelastic_stress(F, 0.0, 0.0, work)
                scale = abs(J) ** (-2.0 / 3.0)
                invariants[0, e, q] = J
                invariants[1, e, q] = scale * I1
                invariants[2, e, q] = scale * scale * I2
                for m in range(9):
                    F_out[m, e, q] = F[m]


@numba.njit(cache=True, parallel=True)
def residual(u, p, tables, W, history_stress, order, starts, out):  # type: ignore[no-untyped-def]
    """Internal forces, then volume constraints, added to ``out``; ``history_stress`` (6, E, Q), or (6, 0, 0) for none."""
    elements, pressures, gradients, _, weights, shape_p, linear, compliance, stiffness = tables
    for color in range(starts.size - 1):
        first, last = starts[color], starts[color + 1]
        for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
            F, cof, g, work = np.empty(9), np.empty(9), np.empty((3, 3, WIDTH)), np.empty((6, 9))
            for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                e = order[s]
                nodes = elements[e]
                for q in range(weights.shape[1]):
                    _deform(ENTRIES, u, nodes, gradients[e, q], g, F)
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    change = point_stress(F, W[:, e, q], linear[e], work, cof)
                    if history_stress.shape[1]:
                        add_history_stress(F, history_stress[:, e, q], linear[e], work)
                    change -= compliance[e] * pressure
                    pressure += stiffness[e] * change
                    for i in range(3):
                        for j in range(3):
                            m = ENTRIES[i][j]
                            stress = weight * (work[0, m] + pressure * cof[m])
                            for a in range(WIDTH):
                                out[nodes[a] * 3 + i] += stress * g[i, j, a]
                    change *= weight * (1.0 - stiffness[e] * compliance[e])
                    for v in range(CORNERS):
                        out[u.size + pressures[e, v]] += change * shape_p[q, v]


@numba.njit(cache=True, parallel=True, fastmath={"contract"})
def tangent(u, p, tables, W, history_stress, order, starts, indptr, offsets, data):  # type: ignore[no-untyped-def]
    """Entries of the tangent, added to ``data``."""
    elements, pressures, gradients, _, weights, shape_p, linear, compliance, stiffness = tables
    for color in range(starts.size - 1):
        first, last = starts[color], starts[color + 1]
        for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
            F, cof, g, work = np.empty(9), np.empty(9), np.empty((3, 3, WIDTH)), np.empty((6, 9))
            A, T = np.empty((9, 9)), np.empty((3, WIDTH))
            K, B, D = np.empty((3, WIDTH, 3, WIDTH)), np.empty((3, WIDTH, CORNERS)), np.empty((CORNERS, CORNERS))
            for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                e = order[s]
                nodes = elements[e]
                K[:], B[:], D[:] = 0.0, 0.0, 0.0
                for q in range(weights.shape[1]):
                    _deform(ENTRIES, u, nodes, gradients[e, q], g, F)
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    slopes = (W[0, e, q], W[1, e, q], W[2, e, q], W[3, e, q], W[4, e, q])
                    point_tangent(F, slopes, linear[e], (pressure, compliance[e], stiffness[e]), work, cof, A)
                    if history_stress.shape[1]:
                        add_history_tangent(history_stress[:, e, q], linear[e], A)
                    _add_stiffness(ENTRIES, A, g, weight, T, K)
                    weight *= 1.0 - stiffness[e] * compliance[e]
                    _add_coupling(ENTRIES, cof, g, shape_p[q], weight, B)
                    for v in range(CORNERS):
                        for x in range(CORNERS):
                            D[v, x] -= weight * compliance[e] * shape_p[q, v] * shape_p[q, x]
                _scatter((K, B, D), nodes, u.size + pressures[e], indptr, offsets[e], data)


@numba.njit(cache=True)
def elastic_stress(F, W, tension, linear, out):  # type: ignore[no-untyped-def]
    """Second Piola-Kirchhoff stress at F (3, 3, E, Q), slopes W and tension (E, Q) into ``out`` (6, E, Q)."""
    here, cof, work = np.empty(9), np.empty(9), np.empty((6, 9))
    for e in range(F.shape[2]):
        for q in range(F.shape[3]):
            for m in range(9):
                here[m] = F[m // 3, m % 3, e, q]
            point_stress(here, W[:, e, q], linear[e], work, cof)
            for m in range(9):
                work[0, m] += tension[e, q] * cof[m]
            pulled_back(work, linear[e], out[:, e, q])


forget_stale(elastic_stress, point)
