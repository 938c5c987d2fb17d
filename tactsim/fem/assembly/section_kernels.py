"""Compiled element loops of sections: equal to the readable ones in ``forms`` to round-off.

Only five entries of F are not zero (``section_point``), and an element is summed up before it is added to the body, its tangent
as products of tables over all its points. That takes a third of the time of the loops over 3 x 3 tensors that serve solids
(``kernels``): of `annulus_icf` with its 10 194 points, 4.9 ms for a tangent, where those took 14.4 ms.

No sum is reordered or contracted, so that the first run on a machine gives the digits of all others, as in ``kernels``. With both
allowed, a tangent takes a quarter less, and of whole runs nothing is to be seen of that.
"""

from __future__ import annotations

import numba
import numpy as np

from tactsim.fem.assembly import section_point
from tactsim.fem.assembly.section_point import (
    add_history_moduli,
    add_history_stress,
    deformation_gradient,
    deformation_invariants,
    isochoric_stress,
    moduli,
    pulled_back,
)
from tactsim.outside.compiled_loops import forget_stale

BLOCK = 64
"""Elements per task of a thread."""


@numba.njit(cache=True)
def _pressure(p, corners, shape_p):  # type: ignore[no-untyped-def]
    """Pressure at one point."""
    return shape_p[0] * p[corners[0]] + shape_p[1] * p[corners[1]] + shape_p[2] * p[corners[2]]


@numba.njit(cache=True)
def _keep_point(A, slope, gradients, hoop, weights, q, rows, columns):  # type: ignore[no-untyped-def]
    """Write what point q adds to the tangent, to be summed over the points at once.

    Shape function gradients go into ``rows``, radial (6, 3 Q) and axial (6, 2 Q); A times those of the columns into ``columns``:
    radial rows by radial ones (6, 3 Q), radial by axial (6, 3 Q), axial by axial (6, 2 Q), and the slope of the volume change by
    both (2, 6, Q). ``weights`` are those of the stress and of the volume.
    """
    radial, axial = rows
    by_radial, by_axial, along, volume = columns
    weight, share = weights
    for n in range(6):
        x, z, h = gradients[n, 0], gradients[n, 1], hoop[n]
        radial[n, 3 * q], radial[n, 3 * q + 1], radial[n, 3 * q + 2] = x, z, h
        axial[n, 2 * q], axial[n, 2 * q + 1] = x, z
        volume[0, n, q] = share * (slope[0] * x + slope[1] * z + slope[4] * h)
        volume[1, n, q] = share * (slope[2] * x + slope[3] * z)
        x, z, h = weight * x, weight * z, weight * h
        by_radial[n, 3 * q] = A[0, 0] * x + A[0, 1] * z + A[0, 4] * h
        by_radial[n, 3 * q + 1] = A[1, 0] * x + A[1, 1] * z + A[1, 4] * h
        by_radial[n, 3 * q + 2] = A[4, 0] * x + A[4, 1] * z + A[4, 4] * h
        by_axial[n, 3 * q] = A[0, 2] * x + A[0, 3] * z
        by_axial[n, 3 * q + 1] = A[1, 2] * x + A[1, 3] * z
        by_axial[n, 3 * q + 2] = A[4, 2] * x + A[4, 3] * z
        along[n, 2 * q] = A[2, 2] * x + A[2, 3] * z
        along[n, 2 * q + 1] = A[3, 2] * x + A[3, 3] * z


@numba.njit(cache=True)
def _dot(first, second):  # type: ignore[no-untyped-def]
    """Sum of products of two vectors."""
    total = 0.0
    for k in range(len(first)):
        total += first[k] * second[k]
    return total


@numba.njit(cache=True)
def _scatter(rows, columns, D, shape_p, nodes, pressure_rows, indptr, place, data):  # type: ignore[no-untyped-def]
    """Sum one element's points, ``rows`` and ``columns`` of ``_keep_point`` and D (3, 3), and add it to the matrix entries."""
    radial, axial = rows
    by_radial, by_axial, along, volume = columns
    for m in range(6):
        start, next_start = indptr[nodes[m] * 2], indptr[nodes[m] * 2 + 1]
        for n in range(6):
            mixed = _dot(radial[m], by_axial[n])
            data[start + place[m, n] + 1] += mixed
            data[indptr[nodes[n] * 2 + 1] + place[n, m]] += mixed
            if n >= m:
                first, second = _dot(radial[m], by_radial[n]), _dot(axial[m], along[n])
                data[start + place[m, n]] += first
                data[next_start + place[m, n] + 1] += second
                if n > m:
                    data[indptr[nodes[n] * 2] + place[n, m]] += first
                    data[indptr[nodes[n] * 2 + 1] + place[n, m] + 1] += second
        for v in range(3):
            first, second = _dot(volume[0, m], shape_p[v]), _dot(volume[1, m], shape_p[v])
            at, pressure = place[m, 6 + v], indptr[pressure_rows[v]] + place[6 + v, m]
            data[start + at] += first
            data[next_start + at] += second
            data[pressure] += first
            data[pressure + 1] += second
    for v in range(3):
        for x in range(3):
            data[indptr[pressure_rows[v]] + place[6 + v, 6 + x]] += D[v, x]


@numba.njit(cache=True, parallel=True)
def deformation(u, elements, gradients, hoop, F_out, invariants):  # type: ignore[no-untyped-def]
    """F at every point into F_out (9, E, Q), which holds zeros; J, I1bar, I2bar into the last (3, E, Q)."""
    count, points = gradients.shape[:2]
    for task in numba.prange((count + 255) // 256):
        for e in range(256 * task, min(count, 256 * task + 256)):
            for q in range(points):
                F = deformation_gradient(u, elements[e], gradients[e, q], hoop[e, q])
                _, _, _, J, I1, I2, scale = deformation_invariants(F)
                invariants[0, e, q] = J
                invariants[1, e, q] = scale * I1
                invariants[2, e, q] = scale * scale * I2
                F_out[0, e, q], F_out[1, e, q], F_out[3, e, q], F_out[4, e, q], F_out[8, e, q] = F


@numba.njit(cache=True, parallel=True)
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
                    F = deformation_gradient(u, nodes, gradients[e, q], hoop[e, q])
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    change = isochoric_stress(F, W[0, e, q], W[1, e, q], linear[e], P, slope)
                    if history_stress.shape[1]:
                        add_history_stress(F, history_stress[:, e, q], linear[e], P)
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


@numba.njit(cache=True, parallel=True)
def tangent(u, p, tables, W, history_stress, order, starts, indptr, offsets, data):  # type: ignore[no-untyped-def]
    """Entries of the tangent, added to ``data``."""
    elements, pressures, gradients, hoop, weights, shape_p, linear, compliance, stiffness = tables
    for color in range(starts.size - 1):
        first, last = starts[color], starts[color + 1]
        for task in numba.prange((last - first + BLOCK - 1) // BLOCK):
            points, shape_v = weights.shape[1], np.ascontiguousarray(shape_p.T)
            slope, A, D = np.empty(5), np.empty((5, 5)), np.empty((3, 3))
            rows = np.empty((6, 3 * points)), np.empty((6, 2 * points))
            columns = (
                np.empty((6, 3 * points)),
                np.empty((6, 3 * points)),
                np.empty((6, 2 * points)),
                np.empty((2, 6, points)),
            )
            for s in range(first + BLOCK * task, min(last, first + BLOCK * task + BLOCK)):
                e = order[s]
                nodes = elements[e]
                D[:] = 0.0
                for q in range(points):
                    F = deformation_gradient(u, nodes, gradients[e, q], hoop[e, q])
                    pressure, weight = _pressure(p, pressures[e], shape_p[q]), weights[e, q]
                    slopes = (W[0, e, q], W[1, e, q], W[2, e, q], W[3, e, q], W[4, e, q])
                    moduli(F, slopes, linear[e], (pressure, compliance[e], stiffness[e]), slope, A)
                    if history_stress.shape[1] and not linear[e]:
                        add_history_moduli(history_stress[:, e, q], A)
                    share = weight * (1.0 - stiffness[e] * compliance[e])
                    _keep_point(A, slope, gradients[e, q], hoop[e, q], (weight, share), q, rows, columns)
                    for v in range(3 if compliance[e] > 0 else 0):
                        for x in range(3):
                            D[v, x] -= share * compliance[e] * shape_p[q, v] * shape_p[q, x]
                _scatter(rows, columns, D, shape_v, nodes, u.size + pressures[e], indptr, offsets[e], data)


@numba.njit(cache=True)
def elastic_stress(F, W, tension, linear, out):  # type: ignore[no-untyped-def]
    """Second Piola-Kirchhoff stress at F (3, 3, E, Q), slopes W and tension (E, Q) into ``out`` (6, E, Q), which holds zeros."""
    P, slope, S = np.empty(5), np.empty(5), np.empty(4)
    for e in range(F.shape[2]):
        for q in range(F.shape[3]):
            here = F[0, 0, e, q], F[0, 1, e, q], F[1, 0, e, q], F[1, 1, e, q], F[2, 2, e, q]
            isochoric_stress(here, W[0, e, q], W[1, e, q], linear[e], P, slope)
            for m in range(5):
                P[m] += tension[e, q] * slope[m]
            pulled_back(here, P, linear[e], S)
            for c in range(4):
                out[c, e, q] = S[c]


forget_stale(elastic_stress, section_point)
