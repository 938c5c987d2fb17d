"""Smoothing: better shaped tetrahedra by moving corners, each along the surface or edge that it must stay on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.mesh.quality import TO_REGULAR, mean_ratio, regular_map

ROUNDS = 6
STEPS = 20
SHARES = (1.0, 0.5, 0.25, 0.1)
"""Parts of a step that are tried until the worst tetrahedron is better, after moving back onto the surfaces."""
POWER = 3
"""Exponent of the inverse mean ratio in the energy: the worse a tetrahedron, the more it counts."""
BARRIER, LEAST_BARRIER = 1e-3, 1e-5
"""Determinant below which the energy rises steeply but stays finite, as a part of that at the start and at least of the mean:
what begins flat would have no energy."""


def smoothed(corners: Array, simplices: Array, directions: Callable[[Array], Array], restore: Callable[[Array], Array]) -> Array:
    """Corner coordinates (n, 3) in m after minimising the sum of the inverse mean ratios, each to the power POWER.

    Parameters
    ----------
    simplices : (E, 4)
    directions : projectors (n, 3, 3) on the directions in which corners (n, 3) may move
    restore : puts moved corners (n, 3) back exactly on what they must stay on
    """
    best = corners
    length = float(np.linalg.norm(corners[simplices[:, 1]] - corners[simplices[:, 0]], axis=1).mean())
    for _ in range(ROUNDS):
        start, free = best / length, directions(best)
        size = np.abs(np.linalg.det(regular_map(start, simplices)))
        barrier = np.maximum(BARRIER * size, LEAST_BARRIER * size.mean())

        def objective(step: Array, start: Array = start, barrier: Array = barrier, free: Array = free) -> tuple[float, Array]:
            moved = start + np.einsum("nij,nj->ni", free, step.reshape(-1, 3))
            value, gradient = _energy(moved, simplices, barrier)
            return value, np.einsum("nij,ni->nj", free, gradient).ravel()

        minimum = scipy.optimize.minimize(
            objective, np.zeros(start.size), jac=True, method="L-BFGS-B", options={"maxiter": STEPS}
        )
        step = length * np.einsum("nij,nj->ni", free, minimum.x.reshape(-1, 3))
        worst = mean_ratio(best, simplices).min()
        tried = (restore(best + share * step) for share in SHARES)
        better = next((moved for moved in tried if mean_ratio(moved, simplices).min() > worst), None)
        if better is None:
            break
        best = better
    return best


def _energy(corners: Array, simplices: Array, barrier: Array) -> tuple[float, Array]:
    r"""Sum of :math:`(|T|^2 / (3 h^{2/3}))^p` and its gradient (n, 3), with :math:`h = (d + \sqrt{d^2 + 4 b^2})/2`.

    T is the map from the regular tetrahedron, d its determinant and b the barrier.

    Source: Escobar et al. 2003, Comput. Methods Appl. Mech. Engrg. 192, 2775-2787, doi:10.1016/S0045-7825(03)00299-8.
    """
    map_ = regular_map(corners, simplices)
    determinant = np.linalg.det(map_)
    root = np.sqrt(determinant**2 + 4 * barrier**2)
    h = (determinant + root) / 2
    h = np.where(determinant < 0, 2 * barrier**2 / (root - determinant), h)
    norm2 = (map_**2).sum(axis=(1, 2))
    shape = norm2 / (3 * h ** (2 / 3))
    cofactor = np.stack([np.cross(map_[:, :, (k + 1) % 3], map_[:, :, (k + 2) % 3]) for k in range(3)], axis=2)
    slope = POWER * shape ** (POWER - 1)
    by_map = (2 * slope / (3 * h ** (2 / 3)))[:, None, None] * map_
    by_map -= (slope * shape * 2 / 3 / root)[:, None, None] * cofactor
    by_side = by_map @ TO_REGULAR.T
    ends = np.concatenate([simplices[:, corner] for k in range(3) for corner in (k + 1, 0)])
    parts = np.concatenate([sign * by_side[:, :, k] for k in range(3) for sign in (1, -1)])
    gradient = np.stack([np.bincount(ends, part, minlength=len(corners)) for part in parts.T], axis=1)
    return float((shape**POWER).sum()), gradient
