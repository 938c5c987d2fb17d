"""Constants of the generalized Kelvin model by least squares: a convex fit of the spectrum, then few units refined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity, UnknownName
from tactsim.identification.dma_data import DmaData
from tactsim.identification.dma_objective import KelvinConstants, compliance_parts, objective, part_sensitivities
from tactsim.identification.dma_spectrum import (
    ROUND_OFF,
    estimated_noise,
    nonnegative_spectrum,
    relative_noise,
    retardation_basis,
    retardation_grid,
    units_of,
)

WEIGHTINGS = ("noise", "objective")
"""``noise``: errors over their standard deviation, equal relative ones if unknown; ``objective``: eq. 4.5.2 itself, squared."""

PRIOR_DEVIATION = float(np.log(10))
"""Assumption: the constants lie within a factor of ten of the start of the refinement, one standard deviation."""
SMALLEST_SPRING = 1e-3
"""Part of the smallest elastic compliance that the refinement starts from when the spectrum has no glassy compliance."""
SPREAD = 0.1
"""Half the distance of the parts of a unit in the logarithm of the time: at one time no gradient would part them."""
GRID_MISFIT = 1e-3
"""Relative noise below which the spectrum's grid of times is felt: the refinement then starts from its misfit."""
SLACK = 0.5
"""In weighted squares: what the prior may cost; 0.06 is the most seen in 400 fits of noisy data."""
FARTHEST = 30.0
"""A trial step farther than this in a logarithm is cut, lest it overflow."""
MOST_EVALUATIONS, MOST_ROUNDS, TOLERANCE = 2000, 8, 1e-13


@dataclass(frozen=True, eq=False)
class DmaFit:
    """Constants with how they were identified."""

    method: str
    constants: KelvinConstants
    data: DmaData
    objective: float
    """Eq. 4.5.2 in the form ``squared``, in 1/Pa^2."""
    evaluations: int
    history: tuple[float, ...] = ()
    """Best objective after each generation of a search."""

    def parts(self, frequencies: Array) -> Array:
        """Elastic and viscous compliance in 1/Pa at ``frequencies`` in Hz, shape (2, frequencies)."""
        return compliance_parts(self.constants.logarithms, frequencies)


def fit_least_squares(data: DmaData, units: int = 8, *, weighting: str = "noise") -> DmaFit:
    r"""Constants of ``units`` Kelvin units that make the weighted sum of squares least.

    The non-negative spectrum on a grid of times is the one minimum of a convex problem, and has few units. Where it has more than
    ``units``, those that the others make up for best are left out. The rest is refined, divided until there are ``units`` of
    them, and refined again under a weak prior:

    .. math:: \min_p \sum_k \left(\frac{D_k(p) - D_k}{s_k}\right)^2 + \frac{|p - p_0|^2}{(\ln 10)^2}

    with the log constants p, their start p0 and the standard deviations s. Where the noise is not known, it is lowered to what
    the residuals leave, round by round: the prior vanishes with the noise.

    Raises
    ------
    InvalidQuantity
        If ``units`` is less than 1.
    UnknownName
        If the weighting is none of ``WEIGHTINGS``.
    ConvergenceError
        If the spectrum or the refinement does not converge.

    Source: the spectrum, Lawson & Hanson 1974, chapter 23; the refinement, More 1978, doi:10.1007/BFb0067700.
    """
    if weighting not in WEIGHTINGS:
        raise UnknownName("weighting", weighting, WEIGHTINGS)
    if units < 1:
        raise InvalidQuantity(f"units is {units}; allowed: at least 1")
    known = np.full(data.parts.shape, ROUND_OFF) if data.relative_noise is None else relative_noise(data)
    rough = known if (known > GRID_MISFIT).all() else np.maximum(known, estimated_noise(data))
    known, rough = (_weighted(noise, data, weighting) for noise in (known, rough))
    grid = retardation_grid(data.frequencies)
    basis = retardation_basis(data.frequencies, grid)
    spectrum = nonnegative_spectrum(basis, data.parts.ravel(), rough.ravel())
    few, spent = _refined(_at_most(units, spectrum, grid, data, rough), data, rough)
    fitted, more = _until_the_noise_is_reached(_divided(few, units), data, rough, known)
    if weighting == "noise" and np.count_nonzero(spectrum[1:]) <= units:
        _check_minimum(fitted, data, rough, (basis @ spectrum).reshape(data.parts.shape))
    return DmaFit("least_squares", _sorted(fitted), data, float(objective(fitted, data)), spent + more)


def _at_most(units: int, spectrum: Array, grid: Array, data: DmaData, deviation: Array) -> Array:
    """Log constants of the spectrum with neighbours on the grid made one unit, and with ``units`` of them at most.

    Units are left out one by one, each time the one that the others make up for best. The nearest two are not made one: they may
    be those of the tissue, beside faint ones far out that only follow the noise.
    """
    strengths, times = map(np.array, units_of(spectrum, grid))
    while times.size > units:
        fewer = [np.delete(times, k) for k in range(times.size)]
        bases = [retardation_basis(data.frequencies, np.exp(few)) for few in fewer]
        spectra = [nonnegative_spectrum(basis, data.parts.ravel(), deviation.ravel()) for basis in bases]
        misfits = [(basis @ one - data.parts.ravel()) / deviation.ravel() for basis, one in zip(bases, spectra, strict=True)]
        best = int(np.argmin([misfit @ misfit for misfit in misfits]))
        spectrum, kept = spectra[best], spectra[best][1:] > 0
        strengths, times = spectrum[1:][kept], fewer[best][kept]
    if not times.size:
        raise ConvergenceError("retardation spectrum: the data have no unit with a retardation time")
    spring = max(spectrum[0], SMALLEST_SPRING * data.parts[0].min())
    return np.concatenate([[-np.log(spring)], -np.log(strengths), times])


def _divided(logarithms: Array, units: int) -> Array:
    """The log constants with every unit made several in turn until there are ``units``, equal parts at times set apart."""
    have = len(logarithms) // 2
    copies = np.array([units // have + (k < units % have) for k in range(have)])
    moduli = np.repeat(logarithms[1 : 1 + have] + np.log(copies), copies)
    times = [time + SPREAD * np.linspace(-1, 1, n) * (n > 1) for time, n in zip(logarithms[1 + have :], copies, strict=True)]
    return np.concatenate([logarithms[:1], moduli, *times])


def _weighted(noise: Array, data: DmaData, weighting: str) -> Array:
    """Standard deviations in 1/Pa that the errors are weighed by, shape (2, frequencies)."""
    deviation = noise * data.parts
    return deviation if weighting == "noise" else np.full_like(deviation, np.sqrt(np.mean(deviation**2)))


def _until_the_noise_is_reached(start: Array, data: DmaData, rough: Array, known: Array) -> tuple[Array, int]:
    """Refinement of a start; from rough deviations again with what the residuals leave, while that falls by half."""
    deviation = rough
    fitted, spent = _refined(start, data, deviation)
    for _ in range(MOST_ROUNDS):
        left = float(np.sqrt(np.mean(((compliance_parts(fitted, data.frequencies) - data.parts) / deviation) ** 2)))
        lowered = np.maximum(left * deviation, known)
        if left > 0.5 or (deviation == known).all():
            break
        deviation = lowered
        fitted, more = _refined(fitted, data, deviation)
        spent += more
    return fitted, spent


def _check_minimum(fitted: Array, data: DmaData, deviation: Array, spectral: Array) -> None:
    """Refuses constants whose weighted squares exceed those of the spectrum, the one minimum of the convex problem."""
    squares = [
        float((((parts - data.parts) / deviation) ** 2).sum()) for parts in (compliance_parts(fitted, data.frequencies), spectral)
    ]
    if not squares[0] <= squares[1] + SLACK:
        raise ConvergenceError(
            f"refinement of the retardation times: weighted squares of {squares[0]:.4g}, but {squares[1]:.4g} for the spectrum"
        )


def _refined(start: Array, data: DmaData, deviation: Array) -> tuple[Array, int]:
    """Least log constants from ``start`` under the prior about it, and the evaluations it took."""

    def near(p: Array) -> Array:
        return np.clip(p, start - FARTHEST, start + FARTHEST)

    def errors(p: Array) -> Array:
        misfit = (compliance_parts(near(p), data.frequencies) - data.parts) / deviation
        return np.concatenate([misfit.ravel(), (p - start) / PRIOR_DEVIATION])

    def slopes(p: Array) -> Array:
        misfit = part_sensitivities(near(p), data.frequencies) / deviation[..., None]
        return np.concatenate([misfit.reshape(-1, p.size), np.eye(p.size) / PRIOR_DEVIATION])

    fit = scipy.optimize.least_squares(
        errors, start, slopes, method="lm", xtol=TOLERANCE, ftol=TOLERANCE, gtol=TOLERANCE, max_nfev=MOST_EVALUATIONS
    )
    if not np.isfinite(fit.x).all():
        raise ConvergenceError("refinement of the retardation times: the constants are not finite")
    return fit.x, int(fit.nfev)


def _sorted(logarithms: Array) -> KelvinConstants:
    """The constants, units by increasing retardation time."""
    units = len(logarithms) // 2
    order = np.argsort(logarithms[1 + units :])
    return KelvinConstants.from_logarithms(
        np.concatenate([logarithms[:1], logarithms[1 : 1 + units][order], logarithms[1 + units :][order]])
    )
