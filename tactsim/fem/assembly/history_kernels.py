"""Compiled loops over the overstresses of a body, one for each relaxation time: each is read and written once.

In numpy every operation of the recursion made an array as large as all overstresses together.
"""

from __future__ import annotations

import numba


@numba.njit(cache=True)
def advanced(factors, overstress, elastic, bend, count, out):  # type: ignore[no-untyped-def]
    """Overstresses after a step into ``out`` (n, 6, E, Q), which holds zeros.

    ``factors`` are three (n, E), of the overstress (n, 6, E, Q), of the step of the stress between ``elastic``, two of (6, E, Q),
    and of its ``bend``, a share of the second stress plus a rest (6, E, Q); the first ``count`` components are not zero.
    """
    kept, mean, bent = factors
    before, after = elastic
    share, rest = bend
    for n in range(overstress.shape[0]):
        for c in range(count):
            for e in range(overstress.shape[2]):
                first, second, third = kept[n, e], mean[n, e], bent[n, e]
                for q in range(overstress.shape[3]):
                    value = first * overstress[n, c, e, q] + second * (after[c, e, q] - before[c, e, q])
                    out[n, c, e, q] = value + third * (share * after[c, e, q] + rest[c, e, q])


@numba.njit(cache=True)
def history_stress(factors, overstress, elastic, rest, count, out):  # type: ignore[no-untyped-def]
    """What a step that begins here adds to the stress beside the new elastic one, into ``out`` (6, E, Q), which holds zeros; the
    arguments are those of ``advanced``."""
    kept, mean, bent = factors
    for c in range(count):
        for n in range(overstress.shape[0]):
            for e in range(overstress.shape[2]):
                first, second, third = kept[n, e], mean[n, e], bent[n, e]
                for q in range(overstress.shape[3]):
                    out[c, e, q] += first * overstress[n, c, e, q] - second * elastic[c, e, q] + third * rest[c, e, q]
