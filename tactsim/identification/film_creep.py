"""Standard linear solid from creep of a film under constant forces, and the lines of its coefficients over the force."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.identification.columns import of_file, read_columns, tests_by
from tactsim.sensors.films.composite import CREEP_COEFFICIENTS, Composite
from tactsim.sensors.films.film_equations import creep_strain

FEWEST_SAMPLES = 6
SMALLEST_START = 1e-3
"""Part of the largest strain that the search starts from at once, if the first sample is smaller."""


@dataclass(frozen=True, eq=False)
class CreepTest:
    """Strain (n,) at times (n,) in s under a constant force in N."""

    force: float
    time: Array
    strain: Array


@dataclass(frozen=True, eq=False)
class CreepFit:
    """The ``CREEP_COEFFICIENTS`` (3,) of a test under a force in N, in their order, their half-widths (3,), residuals (n,) of the
    strain."""

    force: float
    coefficients: Array
    half_widths: Array
    residuals: Array


@dataclass(frozen=True)
class CoefficientLine:
    """A coefficient over the force: slope per N, intercept, and the half-widths of their intervals."""

    slope: float
    intercept: float
    slope_half_width: float
    intercept_half_width: float


def fit_creep(test: CreepTest, area: float, *, confidence: float = 0.95) -> CreepFit:
    r"""E0, E1 and mu1 by least squares of the strain.

    .. math:: \varepsilon(t) = \frac{F}{A E_0} + \frac{F}{A E_1} \left(1 - e^{-E_1 t / \mu_1}\right)

    Parameters
    ----------
    test : CreepTest
    area : float
        A in m^2.
    confidence : float
        Of the intervals, from the covariance of the fit and Student's distribution.

    Raises
    ------
    InvalidQuantity
        If there are fewer than six samples, times do not increase from 0 s or later, or force or area is not positive.
    ConvergenceError
        If no fit is found, or the data do not determine the coefficients.

    Source: thesis, eq. 2.1.15 with the exponent of errata E1.
    """
    _check(test)
    if not area > 0:
        raise InvalidQuantity(f"creep on an area of {area:g} m^2; allowed: > 0")
    stress = test.force / area
    # A first sample from before the load rose is no start for E0: the search does not come back from so stiff a spring.
    end, first = float(test.time[-1]), max(float(test.strain[0]), SMALLEST_START * float(test.strain.max()))
    late = max(float(test.strain[-1] - first), 1e-3 * first)

    def strain(t: Array, *logarithms: float) -> Array:
        instantaneous, delayed, rate = np.exp(logarithms)
        return stress / instantaneous - np.expm1(-rate * t) * stress / delayed

    start = np.log([stress / first, stress / late, 5 / end])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", scipy.optimize.OptimizeWarning)  # an infinite covariance, which is judged below
            fitted, covariance = scipy.optimize.curve_fit(strain, test.time, test.strain, p0=start, maxfev=5000)
    except RuntimeError as error:
        raise ConvergenceError(f"the creep at {test.force:g} N could not be fitted: {error}") from None
    if not np.isfinite(covariance).all():
        raise ConvergenceError(f"the creep at {test.force:g} N does not determine E0, E1 and mu1; record longer")
    # mu1 = E1 / rate: its logarithm is a difference of two fitted ones.
    change = np.array([[1.0, 0, 0], [0, 1, 0], [0, 1, -1]])
    values = np.exp(change @ fitted)
    deviations = values * np.sqrt(np.diag(change @ covariance @ change.T))
    quantile = scipy.stats.t.ppf((1 + confidence) / 2, len(test.time) - 3)
    return CreepFit(test.force, values, quantile * deviations, test.strain - strain(test.time, *fitted))


def coefficient_lines(fits: Sequence[CreepFit], *, confidence: float = 0.95) -> dict[str, CoefficientLine]:
    """Straight lines of E0, E1 and mu1 over the force, by least squares as in thesis Fig. 2.6b.

    Raises
    ------
    InvalidQuantity
        If there are fewer than three different forces, which leave nothing to judge a line by.
    """
    forces = np.array([fit.force for fit in fits])
    if len(np.unique(forces)) < 3:
        raise InvalidQuantity(f"creep at {len(np.unique(forces))} different forces; allowed: at least 3 for lines with intervals")
    quantile = scipy.stats.t.ppf((1 + confidence) / 2, len(forces) - 2)
    lines = {}
    for k, name in enumerate(CREEP_COEFFICIENTS):
        line = scipy.stats.linregress(forces, [fit.coefficients[k] for fit in fits])
        widths = (quantile * line.stderr, quantile * line.intercept_stderr)
        lines[name] = CoefficientLine(float(line.slope), float(line.intercept), float(widths[0]), float(widths[1]))
    return lines


def synthetic_creep(
    composite: Composite, forces: Sequence[float], times: Array, *, noise: float, generator: np.random.Generator
) -> list[CreepTest]:
    """Tests at times (n,) in s on the reference area, with Gaussian noise of a standard deviation relative to the last strain."""
    tests = []
    for force in forces:
        strain = creep_strain(composite, force, times)
        tests.append(CreepTest(float(force), times, strain + noise * strain[-1] * generator.standard_normal(len(times))))
    return tests


def read_creep(path: str | Path) -> list[CreepTest]:
    """Tests of a CSV file with the columns ``time [s], force [N], strain [1]``, one test for each force.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If a column is missing or a row is wrong, with file and line, or no creep can be fitted to a test, with the file.
    """
    columns = read_columns(path, {"time": "s", "force": "N", "strain": "1"}, complete=True)
    tests = []
    with of_file(path):
        for force, signals in tests_by(columns, "force", "N", FEWEST_SAMPLES):
            tests.append(CreepTest(force, **signals))
            _check(tests[-1])
    return tests


def _check(test: CreepTest) -> None:
    if not test.force > 0:
        raise InvalidQuantity(f"creep under a force of {test.force:g} N; allowed: > 0")
    if len(test.time) < FEWEST_SAMPLES or len(test.time) != len(test.strain):
        raise InvalidQuantity(
            f"creep at {test.force:g} N has {len(test.time)} times and {len(test.strain)} strains; "
            f"allowed: as many, at least {FEWEST_SAMPLES}"
        )
    if not (np.isfinite(test.time).all() and np.isfinite(test.strain).all()):
        raise InvalidQuantity(f"creep at {test.force:g} N has values that are not finite")
    if test.time[0] < 0 or (np.diff(test.time) <= 0).any():
        raise InvalidQuantity(
            f"the times of the creep at {test.force:g} N must increase from 0 s or later: one test for each force"
        )
    if np.max(test.strain) <= 0:
        raise InvalidQuantity(f"the creep at {test.force:g} N never strains; compressive strain is positive")
    if np.max(test.strain) >= 1:
        raise InvalidQuantity(
            f"the creep at {test.force:g} N strains by up to {np.max(test.strain):.3g}; allowed: below 1, at which nothing is "
            "left of the film: is it in percent? Then head its column with [%]"
        )
