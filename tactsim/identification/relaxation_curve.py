"""A Prony series from a measured relaxation curve: a non-negative spectrum on a grid of times, then its few units refined."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError, InvalidQuantity, shown
from tactsim.identification.certainty import COVERED, DRAWS, SEED, intervals, noise_of
from tactsim.identification.columns import read_columns
from tactsim.identification.dma_least_squares import PRIOR_DEVIATION
from tactsim.identification.dma_spectrum import ROUND_OFF, grid_of_times, nonnegative_spectrum, units_of
from tactsim.outside.text import one_line
from tactsim.relaxation import Relaxation

RESPONSES = {"stress": "Pa", "nominal stress": "Pa", "true stress": "Pa", "force": "N", "relaxation modulus": "Pa"}
"""Columns of a file that relax with the material at a held deformation, and their units."""
FEWEST_SAMPLES = 6
NEGLIGIBLE = 1e-3
"""Assumption: a unit with a smaller part of the response at once is left out; no load cell resolves it."""
MOST_EVALUATIONS = 2000
STEP = 1e-5
"""Of a log constant: central differences then are right to 1e-10."""
LARGEST_LOGARITHM = 700.0
"""Of a time in s that is drawn: beyond it lie no floating-point numbers, far in the tails of what a curve leaves open."""
LARGEST_RATIO = 4.0
"""Assumption: a curve determines a part whose interval of 95 % is not wider than this from end to end."""


@dataclass(frozen=True, eq=False)
class RelaxationCurve:
    """Response (n,) to a deformation that is held, at times (n,) in s since it began to rise; tension or compression.

    Raises
    ------
    InvalidQuantity
        If there are fewer than six samples, times do not increase from 0 s or later, or the response changes its sign.
    """

    time: Array
    response: Array
    """Stress in Pa, or whatever is in proportion to it, such as a force in N."""
    source: str = "relaxation curve"

    def __post_init__(self) -> None:
        time, response = (np.array(values, dtype=float).ravel() for values in (self.time, self.response))
        if time.shape != response.shape or time.size < FEWEST_SAMPLES:
            counts = f"{time.size} times and {response.size} responses"
            raise InvalidQuantity(f"{self.source}: {counts}; allowed: as many of both, at least {FEWEST_SAMPLES}")
        if not (np.isfinite(time).all() and time[0] >= 0 and (np.diff(time) > 0).all()):
            raise InvalidQuantity(f"{self.source}: the times must increase from 0 s or later")
        if not (np.isfinite(response).all() and ((response > 0).all() or (response < 0).all())):
            raise InvalidQuantity(f"{self.source}: the response must be finite and keep its sign; cut what comes before the load")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "response", np.abs(response))


@dataclass(frozen=True, eq=False)
class RelaxationFit:
    """A Prony series with how well it fits."""

    relaxation: Relaxation
    """What a material takes as its ``relaxation``."""
    instantaneous: float
    """Response to the same deformation at once, in the unit of the curve."""
    max_relative_error: float
    rms_relative_error: float
    fraction_intervals: Array
    """Lower and upper ends (2, units) of the intervals of 95 % of the fractions, if the material has so many units."""
    time_intervals: Array
    """The same (2, units) of the times in s."""
    equilibrium_interval: tuple[float, float]
    """The same of the part of the response that stays."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the curve leaves open."""
        ratios = np.vstack([self.time_intervals, self.fraction_intervals]).reshape(2, 2, -1)
        wide = (ratios[:, 1] > LARGEST_RATIO * ratios[:, 0]).any(axis=0)
        if not wide.any():
            return ()
        times = ", ".join(f"{self.relaxation.times[k]:.3g} s" for k in np.flatnonzero(wide))
        return (
            f"the curve does not determine the part that relaxes in {times}: other data as noisy would have given another "
            f"fraction or time by more than a factor of {LARGEST_RATIO:g} from end to end; trust the curve where it was measured",
        )

    def __str__(self) -> str:
        """Errors, line of a case file and intervals."""
        errors = f"largest relative error {100 * self.max_relative_error:.1f} %, rms {100 * self.rms_relative_error:.1f} %"
        fractions, times = (
            ", ".join(f"{low:.3g} to {high:.3g}" for low, high in ends.T)
            for ends in (self.fraction_intervals, self.time_intervals)
        )
        low, high = self.equilibrium_interval
        ranges = (
            f"{100 * COVERED:.0f} % intervals: fractions {fractions}; times in s {times}; part that stays {low:.3g} to {high:.3g}"
        )
        return f"{len(self.relaxation.times)} relaxation times: {errors}\n  {self.case_line}\n  {ranges}"

    @property
    def case_line(self) -> str:
        """The line of a case file."""
        fractions = ", ".join(f"{value:.5g}" for value in self.relaxation.fractions)
        times = ", ".join(f"{value:.5g} s" for value in self.relaxation.times)
        return f"relaxation: {{fractions: [{fractions}], times: [{times}]}}"


def read_relaxation_curve(path: str | Path) -> RelaxationCurve:
    """The curve in a CSV file with a header such as ``time [s], stress [kPa]``; a ``force [N]`` does as well.

    Raises
    ------
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If it holds no usable curve.
    """
    columns, place = read_columns(path, {"time": "s", **RESPONSES}), one_line(path)
    responses = [name for name in columns if name != "time"]
    if "time" not in columns or len(responses) != 1:
        raise InvalidQuantity(f"{place}: columns {', '.join(columns)}; needed: time and one of {', '.join(RESPONSES)}")
    return RelaxationCurve(columns["time"], columns[responses[0]], place)


def fit_relaxation(curve: RelaxationCurve | str | Path, *, rise: float = 0.0) -> RelaxationFit:
    r"""Prony series of the response to a deformation that rises at a constant rate within a time T and is then held.

    .. math::
        \sigma(t) = \sigma_0 \Bigl(g_\infty + \sum_i g_i\, \frac{\tau_i}{T}\bigl(e^{T / \tau_i} - 1\bigr) e^{-t / \tau_i}\Bigr),
        \quad t \ge T, \qquad g_\infty + \sum_i g_i = 1

    The sum of squared relative errors is made least under :math:`g \ge 0`, first on a grid of times from the first to the last
    sample, where it has one minimum with few units, then over their times too. What relaxes faster than the first sample or
    slower than the last one cannot be told from the response at once and from the equilibrium.

    >>> import tactsim as ts
    >>> import numpy as np
    >>> from tactsim.identification.relaxation_curve import RelaxationCurve
    >>> time = np.geomspace(0.01, 60, 60)
    >>> curve = RelaxationCurve(time, 0.5 + 0.3 * np.exp(-time / 0.1) + 0.2 * np.exp(-time / 2))
    >>> ts.fit_relaxation(curve).case_line
    'relaxation: {fractions: [0.3, 0.2], times: [0.1 s, 2 s]}'

    Parameters
    ----------
    curve
        Or the CSV file that holds it.
    rise
        T in s, 0 for a step; samples before T are left out.

    Raises
    ------
    InputError
        If it is neither a `RelaxationCurve` nor a path.
    StorageError
        If the file cannot be read.
    InvalidQuantity
        If the curve cannot be used, does not relax, or relaxes to nothing.
    ConvergenceError
        If the fit does not converge.

    Source: Boltzmann's superposition, as in Tschoegl 1989, chapter 2; the spectrum, Lawson & Hanson 1974, chapter 23, and Jakes
    1995, doi:10.1135/cccc19951781.
    """
    if not isinstance(curve, RelaxationCurve | str | Path):
        raise InputError(f"fit_relaxation: {shown(curve)} is not a curve; expected the path of a CSV file, or a RelaxationCurve")
    measured = curve if isinstance(curve, RelaxationCurve) else read_relaxation_curve(curve)
    if not (np.isfinite(rise) and rise >= 0):
        raise InvalidQuantity(f"rise is {rise:g} s; allowed: 0 or more")
    held = measured.time >= rise
    if np.count_nonzero(held) < FEWEST_SAMPLES:
        raise InvalidQuantity(f"{measured.source}: fewer than {FEWEST_SAMPLES} samples after a rise of {rise:g} s")
    time, response = measured.time[held], measured.response[held]
    rough = _spectral_start(time, response, rise, measured.source)
    logarithms = _refined(rough, time, response, rise)
    errors = _relative_errors(logarithms, time, response, rise)
    amplitudes, times = np.exp(logarithms[: len(rough) // 2 + 1]), np.exp(logarithms[len(rough) // 2 + 1 :])
    order = np.argsort(times)
    whole = float(amplitudes.sum())
    fractions = tuple(float(value) for value in (amplitudes[1:] / whole)[order])
    drawn_parts, drawn_times = _drawn(logarithms, time, response, rise)
    stays = intervals(drawn_parts[:, 0])
    return RelaxationFit(
        Relaxation(fractions=fractions, times=tuple(float(value) for value in times[order])),
        whole,
        float(np.abs(errors).max()),
        float(np.sqrt(np.mean(errors**2))),
        intervals(drawn_parts[:, 1:][:, order]),
        intervals(drawn_times[:, order]),
        (float(stays[0]), float(stays[1])),
    )


def _drawn(logarithms: Array, time: Array, response: Array, rise: float) -> tuple[Array, Array]:
    r"""Parts (draws, 1 + units), equilibrium first, and times (draws, units) that other data of the same noise would have given.

    To first order in the logarithms of constants and parts: :math:`\delta = A^{-1} (S^T e / \sigma^2 + z / \ln 10)` with
    :math:`A = S^T S / \sigma^2 + 1 / (\ln 10)^2`, the slopes S of the relative errors, their noise e of the mean square
    :math:`\sigma^2`, and z a draw of the prior, a factor of ten about the fit, for what the data do not say.
    """
    slopes = _slopes(logarithms, time, response, rise)
    noise = noise_of(_relative_errors(logarithms, time, response, rise), np.linalg.qr(slopes)[0])
    if not noise.known:
        raise InvalidQuantity(f"{time.size} samples leave nothing to judge {logarithms.size} constants by; measure more of them")
    size = max(float(np.sqrt(np.mean(noise.deviations**2))), ROUND_OFF)
    precision = slopes.T @ slopes / size**2 + np.eye(logarithms.size) / PRIOR_DEVIATION**2
    prior = np.random.default_rng(SEED + 1).standard_normal((DRAWS, logarithms.size)) / PRIOR_DEVIATION
    changes = np.linalg.solve(precision, (noise.drawn(slopes) / size**2 + prior).T).T
    count = logarithms.size // 2 + 1
    parts = np.exp(logarithms[:count]) / np.exp(logarithms[:count]).sum()
    of_parts = changes[:, :count] - (changes[:, :count] @ parts)[:, None]
    log_times = np.clip(logarithms[count:] + changes[:, count:], -LARGEST_LOGARITHM, LARGEST_LOGARITHM)
    return np.exp(np.minimum(np.log(parts) + of_parts, 0.0)), np.exp(log_times)


def _slopes(logarithms: Array, time: Array, response: Array, rise: float) -> Array:
    """Derivatives (n, m) of the relative errors by the log constants, by central differences."""
    steps = STEP * np.eye(logarithms.size)
    return np.stack(
        [
            (
                _relative_errors(logarithms + step, time, response, rise)
                - _relative_errors(logarithms - step, time, response, rise)
            )
            / (2 * STEP)
            for step in steps
        ],
        axis=-1,
    )


def _basis(time: Array, times: Array, rise: float) -> Array:
    """Response at each time per unit of equilibrium and of each relaxing part, shape (n, 1 + times)."""
    averaged = times / rise * -np.expm1(-rise / times) if rise else np.ones_like(times)
    return np.column_stack([np.ones_like(time), averaged * np.exp(-(time[:, None] - rise) / times)])


def _spectral_start(time: Array, response: Array, rise: float, source: str) -> Array:
    """Log amplitudes, equilibrium first, and log times of the spectrum, neighbours on the grid made one."""
    since = time - rise
    shortest, longest = max(since[since > 0].min(), rise / 10), since.max()
    grid = grid_of_times(shortest, longest)
    spectrum = nonnegative_spectrum(_basis(time, grid, rise), response, response)
    strengths, times = map(np.array, units_of(spectrum, grid))
    kept = strengths > NEGLIGIBLE * spectrum.sum()
    if not kept.any():
        raise InvalidQuantity(f"{source}: the response does not relax by a thousandth; leave the relaxation out")
    if spectrum[0] <= NEGLIGIBLE * spectrum.sum():
        raise InvalidQuantity(
            f"{source}: the response relaxes to nothing, or the curve ends before its equilibrium shows; "
            "a relaxation of tactsim is that of a solid: measure for longer"
        )
    return np.concatenate([np.log(spectrum[:1]), np.log(strengths[kept]), times[kept]])


def _relative_errors(logarithms: Array, time: Array, response: Array, rise: float) -> Array:
    units = len(logarithms) // 2
    fitted = _basis(time, np.exp(logarithms[units + 1 :]), rise) @ np.exp(logarithms[: units + 1])
    return fitted / response - 1


def _refined(start: Array, time: Array, response: Array, rise: float) -> Array:
    """Least squares of the relative errors over amplitudes and times, each within a factor of ten of its start."""
    limits = (start - np.log(10), start + np.log(10))
    fit = scipy.optimize.least_squares(
        _relative_errors, start, bounds=limits, args=(time, response, rise), xtol=1e-12, ftol=1e-12, max_nfev=MOST_EVALUATIONS
    )
    if not fit.success:
        raise ConvergenceError(f"relaxation times: no least squares within {MOST_EVALUATIONS} evaluations")
    refined: Array = fit.x
    return refined
