"""Confidence bands of the elastic and viscous compliance curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.identification.dma_data import DmaData
from tactsim.identification.dma_least_squares import DmaFit, fit_least_squares
from tactsim.identification.dma_spectrum import (
    nonnegative_spectrum,
    relative_noise,
    residual_noise,
    retardation_basis,
    retardation_grid,
)

SMALLEST_RATIO = 1e-3
"""A compliance of a replicate below this part of the fitted one counts as this part: its logarithm stays finite."""
FEWEST_REPLICATES = 50


@dataclass(frozen=True, eq=False)
class ComplianceBand:
    """Elastic (row 0) and viscous (row 1) compliance in 1/Pa with their limits, all of shape (2, frequencies)."""

    frequencies: Array
    """In Hz, shape (frequencies,)."""
    centre: Array
    lower: Array
    upper: Array
    confidence: float
    simultaneous: bool
    """Whether the confidence is that of both curves at all frequencies together, or of each number alone."""

    @property
    def relative_width(self) -> Array:
        """Full width over the centre, dimensionless, shape (2, frequencies)."""
        return (self.upper - self.lower) / self.centre

    def contains(self, parts: Array) -> bool:
        """Whether a curve of elastic and viscous compliance in 1/Pa, shape (2, frequencies), lies inside everywhere."""
        return bool(((parts >= self.lower) & (parts <= self.upper)).all())


def least_squares_band(
    fit: DmaFit, frequencies: Array, *, confidence: float = 0.95, simultaneous: bool = True, replicates: int = 400, seed: int = 1
) -> ComplianceBand:
    r"""Band about a least-squares fit at frequencies (n,) in Hz, from a parametric bootstrap of the spectrum.

    Data are drawn from the fitted spectrum with the noise of the data, and fitted again. With the logarithmic deviation
    :math:`\delta = \ln D^* - \ln \hat D` of each replicate from the curve it was drawn from, its root mean square :math:`s`
    over the replicates and the quantile c at the confidence of :math:`\max_{part, \omega} |\delta| / s`, the band is

    .. math:: \hat D \, e^{\pm c s}

    As the deviation is taken from the known curve, the bias of the non-negative fit counts. Where the noise is not known, each
    deviation is divided by the ratio of the replicate's estimate to the one of the data, as in Student's t.
    With ``simultaneous`` false, c is the quantile at each part and frequency alone.

    Raises
    ------
    InvalidQuantity
        If the confidence is not between 0 and 1, or the replicates are fewer than ``FEWEST_REPLICATES``.

    Source: Efron & Tibshirani 1993, An Introduction to the Bootstrap, chapters 6 and 12; sup-t bands: Montiel Olea &
    Plagborg-Moller 2019, doi:10.1002/jae.2656.
    """
    deviations = _deviations(fit.data, frequencies, replicates, seed, unweighted=False)
    centre = fit.parts(frequencies)
    half = _half_width(deviations, confidence, simultaneous).reshape(centre.shape)
    return _band(frequencies, centre, half, confidence, simultaneous)


def genetic_band(
    fit: DmaFit, frequencies: Array, *, confidence: float = 0.95, simultaneous: bool = True, replicates: int = 400, seed: int = 1
) -> ComplianceBand:
    r"""Band about a fit of eq. 4.5.2 by search: the noise's part as in ``least_squares_band``, and the search's on top; at
    frequencies (n,) in Hz.

    What the search approaches, the least of eq. 4.5.2 in its squared form, is the unweighted non-negative spectrum, which is
    computed exactly; its bootstrap gives c s. How far the search stayed from it is known at each frequency, so that the band is

    .. math:: \hat D \, e^{\pm (c s + |\ln \hat D - \ln D_{min}|)}

    Raises
    ------
    InvalidQuantity
        As ``least_squares_band`` does.
    """
    deviations = _deviations(fit.data, frequencies, replicates, seed, unweighted=True)
    centre = fit.parts(frequencies)
    least = fit_least_squares(fit.data, len(fit.constants.moduli), weighting="objective").parts(frequencies)
    half = _half_width(deviations, confidence, simultaneous).reshape(centre.shape) + np.abs(np.log(centre / least))
    return _band(frequencies, centre, half, confidence, simultaneous)


def _band(frequencies: Array, centre: Array, half: Array, confidence: float, simultaneous: bool) -> ComplianceBand:
    with np.errstate(over="ignore"):  # data that leave nothing to judge their noise by have an infinite band
        lower, upper = centre * np.exp(-half), centre * np.exp(half)
    return ComplianceBand(np.array(frequencies), centre, lower, upper, confidence, simultaneous)


def _half_width(deviations: Array, confidence: float, simultaneous: bool) -> Array:
    """c s of every number, from deviations of shape (replicates, numbers)."""
    if not 0 < confidence < 1:
        raise InvalidQuantity(f"confidence is {confidence:g}; allowed: > 0 and < 1")
    if not simultaneous:
        return np.quantile(np.abs(deviations), confidence, axis=0)
    spread = np.sqrt(np.mean(deviations**2, axis=0))
    spread = np.maximum(spread, np.finfo(float).eps)
    return float(np.quantile(np.abs(deviations / spread).max(axis=1), confidence)) * spread


def _deviations(data: DmaData, frequencies: Array, replicates: int, seed: int, *, unweighted: bool) -> Array:
    """Logarithmic deviations of refitted curves from the one they were drawn from, shape (replicates, 2 frequencies)."""
    if replicates < FEWEST_REPLICATES:
        raise InvalidQuantity(f"replicates is {replicates}; allowed: at least {FEWEST_REPLICATES}")
    grid, noise, known = retardation_grid(data.frequencies), relative_noise(data).ravel(), data.relative_noise is not None
    basis, curves = retardation_basis(data.frequencies, grid), retardation_basis(frequencies, grid)

    def refitted(compliance: Array) -> Array:
        deviation = noise * compliance
        level = np.full_like(deviation, np.sqrt(np.mean(deviation**2)))
        return nonnegative_spectrum(basis, compliance, level if unweighted else deviation)

    def level_of_noise(compliance: Array, spectrum: Array) -> float:
        if unweighted and not known:
            spectrum = nonnegative_spectrum(basis, compliance, compliance)
        return 1.0 if known else residual_noise(basis, compliance, spectrum)

    drawn = refitted(data.parts.ravel())
    exact, level = basis @ drawn, level_of_noise(data.parts.ravel(), drawn)
    generator = np.random.default_rng(seed)
    deviations = np.empty((replicates, len(curves)))
    for row in deviations:
        compliance = exact * (1 + noise * generator.standard_normal(exact.size))
        spectrum = refitted(np.maximum(compliance, SMALLEST_RATIO * exact))
        row[:] = np.log(np.maximum(curves @ spectrum / (curves @ drawn), SMALLEST_RATIO))
        row /= level_of_noise(compliance, spectrum) / level
    return deviations
