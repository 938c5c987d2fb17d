"""Complex modulus from the load and displacement signals of a dynamic mechanical analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from tactsim.analytic.spectrum import checked_number, read_only, real_array
from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.identification.columns import of_file, read_columns, tests_by
from tactsim.identification.dma_data import DmaData

COLUMNS = {"time": "s", "load": "N", "displacement": "m"}
SHOWN_CYCLES = 3.0
"""Cycles of signals that figures show, of a case and of a table alike."""
FEWEST_SAMPLES = 12
FEWEST_PERIODS = 1.0
SAMPLES_PER_PERIOD = 4.0
"""Largest gap between samples, as a part of the period: a quarter."""
MOST_UNEXPLAINED = 0.5
"""Part of the variance of the signals that a refined frequency may leave: a sine at a wrong frequency leaves nearly all."""
WHITE = 4.0
"""Standard deviations of the correlation of white noise, 1 / sqrt(n), beyond which residuals count as correlated."""
ROUND_OFF = 1e-12
"""Residuals below this part of a signal are round-off."""
SMALLEST_NOISE = 1e-13
"""Smallest relative noise that is reported, that of exact signals."""


@dataclass(frozen=True, eq=False)
class DmaSignals:
    """Load and displacement of one test at one frequency, both positive in compression (or both in tension).

    Raises
    ------
    InvalidQuantity
        With the row and the value, if the signals do not determine a modulus.
    """

    time: Array
    """In s, increasing, shape (n,)."""
    load: Array
    """In N, shape (n,)."""
    displacement: Array
    """In m, shape (n,)."""
    frequency: float
    """In Hz."""
    area: float
    """Rest area of the specimen's cross-section in m^2."""
    height: float
    """Rest height of the specimen in m."""

    def __post_init__(self) -> None:
        for name in ("frequency", "area", "height"):
            object.__setattr__(self, name, checked_number(name, getattr(self, name)))
        for name, unit in COLUMNS.items():
            values = real_array(name, getattr(self, name))
            if values.ndim != 1 or values.shape != np.shape(self.time):
                raise InvalidQuantity(f"{name} has shape {values.shape} and time {np.shape(self.time)}; allowed: one shape (n,)")
            for row in np.flatnonzero(~np.isfinite(values))[:1]:
                raise InvalidQuantity(f"{name} in row {row + 1} is {values[row]:g} {unit}; allowed: a finite number")
            object.__setattr__(self, name, read_only(values))
        self._check_sampling()
        for name, unit in (("load", "N"), ("displacement", "m")):
            if np.ptp(getattr(self, name)) == 0:
                raise InvalidQuantity(f"{name} is {getattr(self, name)[0]:g} {unit} throughout; allowed: an oscillation")

    def _check_sampling(self) -> None:
        if self.time.size < FEWEST_SAMPLES:
            raise InvalidQuantity(f"{self.time.size} samples; allowed: at least {FEWEST_SAMPLES}")
        gaps = np.diff(self.time)
        for row in np.flatnonzero(gaps <= 0)[:1]:
            raise InvalidQuantity(
                f"time in row {row + 2} is {self.time[row + 1]:g} s after {self.time[row]:g} s; allowed: increasing"
            )
        periods = self.frequency * (self.time[-1] - self.time[0])
        if periods < FEWEST_PERIODS * (1 - 1e-9):  # a record of exactly one period, up to round-off
            raise InvalidQuantity(f"the signals last {periods:.3g} periods of {self.frequency:g} Hz; allowed: at least one")
        row = int(np.argmax(gaps))
        if self.frequency * gaps[row] > (1 + 1e-9) / SAMPLES_PER_PERIOD:
            raise InvalidQuantity(
                f"{1 / (self.frequency * gaps[row]):.3g} samples per period of {self.frequency:g} Hz after row {row + 1}; "
                f"allowed: at least {SAMPLES_PER_PERIOD:g}"
            )


@dataclass(frozen=True)
class ModulusEstimate:
    """Complex modulus at one frequency with standard errors, from the residuals of the signals taken as white noise."""

    frequency: float
    """In Hz."""
    modulus: complex
    """E* = E_e + i E_v in Pa."""
    modulus_errors: tuple[float, float]
    """Standard errors of E_e and E_v in Pa."""
    compliance_errors: tuple[float, float]
    """Standard errors of D_e and D_v over their sizes, dimensionless."""
    correlation: float
    """Larger correlation of neighbouring residuals of load and displacement; 0 where only round-off is left."""
    white_limit: float
    """Correlation that white noise hardly exceeds, ``WHITE`` standard deviations; beyond it the errors are understated."""

    @property
    def has_white_residuals(self) -> bool:
        """Whether the standard errors may be believed: transients, harmonics or a wrong frequency leave correlated residuals."""
        return self.correlation <= self.white_limit


def read_dma_signals(path: str | Path, *, frequency: float, area: float, height: float) -> DmaSignals:
    """Signals in a CSV file with the header ``time [s], load [N], displacement [mm]`` in any order and units.

    Parameters
    ----------
    frequency, area, height
        In Hz, m^2 and m.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If a unit or a column is missing or the signals do not determine a modulus, with file and row.
    """
    columns = read_columns(path, COLUMNS)
    if set(columns) != set(COLUMNS):
        raise InvalidQuantity(f"{path}: columns {', '.join(columns)}; allowed: {', '.join(COLUMNS)}")
    with of_file(path):
        return DmaSignals(**columns, frequency=frequency, area=area, height=height)


def read_dma_tests(path: str | Path, *, area: float, height: float) -> list[DmaSignals]:
    """Signals of several tests in one CSV file ``frequency [Hz], time [s], load [N], displacement [mm]``, in order of frequency.

    The rows of a test have its frequency; its times increase, and may begin anywhere.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If a unit or a column is missing or the signals of a test do not determine a modulus, with file and frequency.
    """
    columns = read_columns(path, {"frequency": "Hz"} | COLUMNS, complete=True)
    tests = []
    with of_file(path):
        for frequency, signals in tests_by(columns, "frequency", "Hz", FEWEST_SAMPLES):
            try:
                tests.append(DmaSignals(**signals, frequency=frequency, area=area, height=height))
            except InvalidQuantity as error:
                raise InvalidQuantity(f"test at {frequency:g} Hz: {error}") from None
    return tests


def complex_modulus(signals: DmaSignals, *, refine: bool = False) -> ModulusEstimate:
    r"""Complex modulus by linear least squares of each signal.

    .. math:: x(t) = a \cos \omega t + b \sin \omega t + c + d t, \quad E^* = \frac{h}{A} \frac{a_F - i b_F}{a_u - i b_u}

    The variance of each residual, over n - 4 degrees of freedom, gives the covariance of a and b, and to first order that of E*
    and of D* = 1/E*. With ``refine`` the frequency that both signals share is first made to fit best, within half a cycle over
    the whole record; its own error is not in the standard errors.

    Raises
    ------
    InvalidQuantity
        If the moduli are not positive: one of the signals has the wrong sign, or they lead each other wrongly.
    ConvergenceError
        If the frequency is not found.

    Source: Ferry 1980, Viscoelastic Properties of Polymers, chapter 1; thesis section 4.4, eq. 4.4.2.
    """
    frequency = _refined_frequency(signals) if refine else signals.frequency
    load = _oscillation(signals, signals.load, frequency)
    displacement = _oscillation(signals, signals.displacement, frequency)
    shape = signals.height / signals.area
    modulus = shape * load.amplitude / displacement.amplitude
    if not (modulus.real > 0 and modulus.imag > 0):
        raise InvalidQuantity(
            f"at {frequency:g} Hz the elastic modulus is {modulus.real:g} Pa and the viscous {modulus.imag:g} Pa; allowed: > 0. "
            "Load and displacement must both be positive in compression, and the displacement lags"
        )
    compliance = 1 / modulus
    modulus_errors = _errors(modulus, load, displacement)
    compliance_errors = _errors(compliance, displacement, load)
    relative = (compliance_errors[0] / compliance.real, compliance_errors[1] / -compliance.imag)
    correlation, limit = max(load.correlation, displacement.correlation), WHITE / float(np.sqrt(signals.time.size))
    return ModulusEstimate(frequency, complex(modulus), modulus_errors, relative, correlation, limit)


def dma_from_estimates(estimates: Sequence[ModulusEstimate]) -> DmaData:
    """Complex compliance at the frequencies of several estimates, in increasing order, with its noise.

    Raises
    ------
    InvalidQuantity
        If a frequency is repeated.
    """
    estimates = sorted(estimates, key=lambda estimate: estimate.frequency)
    noise = np.array([estimate.compliance_errors for estimate in estimates]).reshape(-1, 2).T
    return DmaData(
        np.array([estimate.frequency for estimate in estimates]),
        1 / np.array([estimate.modulus for estimate in estimates]),
        np.maximum(noise, SMALLEST_NOISE),
    )


def _design(time: Array, frequency: float) -> Array:
    """Columns cos, sin, offset and drift, shape (n, 4), with the time from the middle of the record."""
    middle = time - (time[0] + time[-1]) / 2
    phase = 2 * np.pi * frequency * middle
    return np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase), middle / np.ptp(middle)])


@dataclass(frozen=True)
class _Oscillation:
    """Complex ``amplitude`` a - i b of a signal, ``covariance`` (2, 2) of (a, b), ``correlation`` of neighbouring residuals."""

    amplitude: complex
    covariance: Array
    correlation: float


def _oscillation(signals: DmaSignals, values: Array, frequency: float) -> _Oscillation:
    """The oscillation of one signal (n,) at a frequency in Hz."""
    design = _design(signals.time, frequency)
    coefficients, *_ = np.linalg.lstsq(design, values, rcond=None)
    residual = values - design @ coefficients
    variance = residual @ residual / (residual.size - coefficients.size)
    covariance = variance * np.linalg.inv(design.T @ design)[:2, :2]
    square = float(residual @ residual)
    exact = square <= residual.size * (ROUND_OFF * float(np.abs(values).max())) ** 2
    correlation = 0.0 if exact else abs(float(residual[1:] @ residual[:-1])) / square
    return _Oscillation(complex(coefficients[0], -coefficients[1]), covariance, correlation)


def _errors(ratio: complex, numerator: _Oscillation, denominator: _Oscillation) -> tuple[float, float]:
    """Standard errors of the real and imaginary part of a ``ratio`` in proportion to that of two amplitudes, to first order."""
    variance = np.zeros(2)
    for sign, signal in ((1, numerator), (-1, denominator)):
        step = ratio * (sign / signal.amplitude) * np.array([1, -1j])
        for k, row in enumerate((step.real, step.imag)):
            variance[k] += row @ signal.covariance @ row
    return float(np.sqrt(variance[0])), float(np.sqrt(variance[1]))


def _refined_frequency(signals: DmaSignals) -> float:
    """The frequency in Hz with the least residuals of both signals, each over its standard deviation."""
    both = np.column_stack([signals.load, signals.displacement])
    both = (both - both.mean(axis=0)) / both.std(axis=0)

    def residuals(frequency: Array) -> Array:
        design = _design(signals.time, float(frequency[0]))
        return (both - design @ np.linalg.lstsq(design, both, rcond=None)[0]).ravel()

    reach = 0.5 / np.ptp(signals.time)
    bounds = (max(signals.frequency - reach, signals.frequency / 2), signals.frequency + reach)
    fit = scipy.optimize.least_squares(
        residuals, [signals.frequency], bounds=bounds, x_scale=reach, xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    unexplained = 2 * fit.cost / both.size
    at_border = bool(fit.active_mask.any())  # the best frequency lies beyond what was searched
    if not fit.success or at_border or unexplained > MOST_UNEXPLAINED:
        raise ConvergenceError(f"no frequency near {signals.frequency:g} Hz fits the signals; give it within {reach:.2g} Hz")
    return float(fit.x[0])


def fitted_signals(signals: DmaSignals, frequency: float) -> tuple[Array, Array]:
    """Sine, offset and drift that fit load (n,) in N and displacement (n,) in m best at a frequency in Hz."""
    design = _design(signals.time, frequency)
    load, displacement = (design @ np.linalg.lstsq(design, v, rcond=None)[0] for v in (signals.load, signals.displacement))
    return load, displacement
