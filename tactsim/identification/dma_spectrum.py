"""Non-negative retardation spectrum on a fixed grid of times: the convex form of the fit, with one minimum."""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.identification.dma_data import DmaData

POINTS_PER_DECADE = 12
"""Neighbours 1.21 apart: a unit between them is a pair of units to 2.3e-3 of its compliance."""

SHORTEST, LONGEST = 1e-2, 1e4
"""Assumption: times from 1e-2 / omega_max, nearly a spring, to 1e4 / omega_min, nearly a dashpot."""

MOST_ITERATIONS = 10_000
ROUND_OFF = 1e-13
"""Smallest relative noise that matters: the round-off of the data as floats."""


def retardation_grid(frequencies: Array) -> Array:
    """Retardation times (m,) in s, evenly spaced in the logarithm, for data at ``frequencies`` (n,) in Hz."""
    omega = 2 * np.pi * np.asarray(frequencies)
    return grid_of_times(SHORTEST / omega.max(), LONGEST / omega.min())


def grid_of_times(shortest: float, longest: float) -> Array:
    """Times (m,) in s, evenly spaced in the logarithm, at least two."""
    return np.geomspace(shortest, longest, max(2, 1 + int(np.ceil(POINTS_PER_DECADE * np.log10(longest / shortest)))))


def retardation_basis(frequencies: Array, times: Array) -> Array:
    """Elastic, then viscous compliance at ``frequencies`` in Hz per unit of glassy compliance and of each retardation compliance.

    Dimensionless, shape (2 frequencies, 1 + times).
    """
    product = 2 * np.pi * np.asarray(frequencies)[:, None] * times
    term = 1 / (1 + product**2)
    spring = np.repeat([1.0, 0.0], len(product))
    return np.column_stack([spring, np.concatenate([term, product * term])])


def nonnegative_spectrum(basis: Array, compliance: Array, deviation: Array) -> Array:
    r"""Glassy and retardation compliances in 1/Pa, shape (1 + times,).

    .. math:: \min_{J \ge 0} \sum_k ((B J - D)_k / s_k)^2

    Parameters
    ----------
    basis
        ``B``, of ``retardation_basis``.
    compliance, deviation
        ``D`` and ``s`` in 1/Pa, shape (2 frequencies,).

    Raises
    ------
    ConvergenceError
        If the active set does not settle.

    Source: Lawson & Hanson 1974, Solving Least Squares Problems, chapter 23; for spectra: Provencher 1982,
    doi:10.1016/0010-4655(82)90173-4.
    """
    weighted = basis / deviation[:, None]
    size = np.linalg.norm(weighted, axis=0)
    try:
        scaled, _ = scipy.optimize.nnls(weighted / size, compliance / deviation, maxiter=MOST_ITERATIONS)
    except RuntimeError as error:
        raise ConvergenceError(f"retardation spectrum: {error}") from None
    return scaled / size


def units_of(spectrum: Array, grid: Array) -> tuple[list[float], list[float]]:
    """Strengths and log times of a spectrum (1 + times,) whose first number has no time, neighbours on the grid made one unit."""
    places = np.flatnonzero(spectrum[1:] > 0)
    groups = [group for group in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if group.size]
    strengths = [spectrum[1:][group].sum() for group in groups]
    return strengths, [float(np.average(np.log(grid[group]), weights=spectrum[1:][group])) for group in groups]


def relative_noise(data: DmaData) -> Array:
    """Relative standard deviation of the noise of each number, shape (2, n): as the data give it, else ``estimated_noise``.

    Raises
    ------
    ConvergenceError
        If it is estimated and the active set of the spectrum does not settle.
    """
    if data.relative_noise is not None:
        return np.maximum(data.relative_noise, ROUND_OFF)
    return estimated_noise(data)


def estimated_noise(data: DmaData) -> Array:
    r"""Relative standard deviation of the noise from the residuals of the best spectrum, shape (2, n), all equal.

    .. math:: \hat\sigma^2 = \frac{1}{2 n - a} \sum_k \left(\frac{(B J)_k}{D_k} - 1\right)^2

    with the spectrum J fitted to relative errors and a the number of its positive compliances, whose expectation is the number of
    degrees of freedom that a non-negative fit uses.

    Raises
    ------
    ConvergenceError
        If the active set of the spectrum does not settle.

    Source: Meyer & Woodroofe 2000, doi:10.1214/aos/1015956708.
    """
    basis, spectrum = _best_spectrum(data)
    return np.full(data.parts.shape, residual_noise(basis, data.parts.ravel(), spectrum))


def noise_is_known(data: DmaData) -> bool:
    """Whether the data give their noise, or have more numbers than the best spectrum has positive compliances to estimate it by.

    Raises
    ------
    ConvergenceError
        If the active set of the spectrum does not settle.
    """
    return data.relative_noise is not None or int((_best_spectrum(data)[1] > 0).sum()) < data.parts.size


def _best_spectrum(data: DmaData) -> tuple[Array, Array]:
    """Basis (2 n, m) and spectrum (m,) in 1/Pa of least squared relative errors."""
    compliance = data.parts.ravel()
    basis = retardation_basis(data.frequencies, retardation_grid(data.frequencies))
    return basis, nonnegative_spectrum(basis, compliance, compliance)


def residual_noise(basis: Array, compliance: Array, spectrum: Array) -> float:
    """Relative standard deviation of the noise from the residuals of a spectrum; see ``estimated_noise``.

    ``basis`` (2 n, m) is dimensionless, ``compliance`` (2 n,) and ``spectrum`` (m,) are in 1/Pa.
    """
    residual = basis @ spectrum / compliance - 1
    free = max(1, residual.size - int((spectrum > 0).sum()))
    return max(ROUND_OFF, float(np.sqrt(residual @ residual / free)))
