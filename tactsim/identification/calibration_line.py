"""Line C = m F + n of a sensor from forces and voltages, with intervals and the linearity figures of thesis 3.1.2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.sensors.electronics.divider import divider_conductance, divider_slope

FEWEST_POINTS = 3
"""Two constants and one degree of freedom for the noise."""
SETTLED, MOST_ITERATIONS = 1e-12, 50
"""Relative change of the line at which Gauss-Newton ends, and when it gives up."""


@dataclass(frozen=True, eq=False)
class CalibrationFit:
    """A fitted line per sensor; ``...`` stands for the shape of the sensors."""

    slope: Array
    """m in S/N, shape (...)."""
    intercept: Array
    """n in S, shape (...)."""
    covariance: Array
    """Of m and n, shape (2, 2, ...)."""
    slope_interval: Array
    """Lower and upper end in S/N, shape (2, ...)."""
    intercept_interval: Array
    """Lower and upper end in S, shape (2, ...)."""
    confidence: float
    noise: Array
    """Standard deviation in V of a reading, from the residuals, shape (...)."""
    force_error: Array
    """Force by the line less force applied in N, shape (points, ...); 0 where a point was left out."""
    used: Array
    """Whether a point was fitted, shape (points, ...)."""
    linearity_positive: Array
    """Largest force error over the full scale, shape (...)."""
    linearity_negative: Array
    """Smallest (most negative) force error over the full scale, shape (...)."""
    rms: Array
    """Root mean square of the force error in N, shape (...)."""
    full_scale: Array
    """In N, shape (...)."""

    @property
    def excluded(self) -> Array:
        """Number of saturated points left out per sensor, shape (...)."""
        return np.count_nonzero(~self.used, axis=0)

    def band(self, force: Array) -> Array:
        """Half width in S of the confidence band of the line at forces in N of shape (k,), shape (k, ...)."""
        force = np.asarray(force, dtype=float).reshape(-1, *[1] * self.slope.ndim)
        mm, mn, nn = self.covariance[0, 0], self.covariance[0, 1], self.covariance[1, 1]
        return self._factor() * np.sqrt(np.maximum(force**2 * mm + 2 * force * mn + nn, 0.0))

    def _factor(self) -> Array:
        return scipy.stats.t.ppf(0.5 + self.confidence / 2, np.count_nonzero(self.used, axis=0) - 2)


def fit_calibration_line(
    force: ArrayLike,
    voltage: ArrayLike,
    *,
    supply: float,
    load: float,
    saturated: ArrayLike | None = None,
    confidence: float = 0.95,
    full_scale: float | None = None,
) -> CalibrationFit:
    r"""Least-squares line of every sensor, its residuals taken in voltage, where the noise is alike at every force.

    .. math:: \sum_i \bigl(V_i - V(m F_i + n)\bigr)^2 \to \min, \qquad V(C) = V^+ \frac{R C}{1 + R C}

    This is C = m F + n fitted with each conductance weighted by ``dV/dC`` squared: one step of voltage means more conductance at
    a high one. The noise's size comes from the residuals, the intervals from Student's distribution with points - 2 degrees of
    freedom. Forces are taken as exact, as the testing machine's error of 0.01 N is not known for these data.

    Linearity: the largest and the smallest difference of the force that the line reads from the one applied, over the full scale.
    Source: thesis, 2.2.1 (line and divider), 3.1.2 and Fig. 3.4 (linearity: +3.9 % and -6.15 % of full scale).

    Parameters
    ----------
    force
        Applied forces in N, shape (points,) or that of the voltages.
    voltage
        Voltages in V, shape (points, ...), with one fit for each entry of ``...``.
    supply, load
        In V and ohm.
    saturated
        True for points that are to be left out, shape of the voltages; they are counted in ``excluded``.
    full_scale
        In N; the largest force applied to each sensor if None.

    Raises
    ------
    InvalidQuantity
        If the points are too few, at one force or not finite, a force is negative, a voltage not below the supply, or the line
        does not rise.
    ConvergenceError
        If no line follows the data.
    """
    if not 0 < confidence < 1:
        raise InvalidQuantity(f"confidence is {confidence:g}; allowed: between 0 and 1")
    if full_scale is not None and not 0 < full_scale < np.inf:
        raise InvalidQuantity(f"full_scale is {full_scale:g} N; allowed: above 0")
    forces, voltages, used = _checked(force, voltage, saturated)
    measured = divider_conductance(np.where(used, voltages, 0.0), supply=supply, load=load)
    slope, intercept = _gauss_newton(forces, voltages, measured, used, {"supply": supply, "load": load})
    fitted = slope * forces + intercept
    residual = np.where(used, voltages - supply * load * fitted / (1 + load * fitted), 0.0)
    sensitivity = np.where(used, divider_slope(fitted, supply=supply, load=load), 0.0)
    points = np.count_nonzero(used, axis=0)
    noise = np.sqrt((residual**2).sum(axis=0) / (points - 2))
    covariance = noise**2 * _cofactors(forces, sensitivity)
    error = np.where(used, (measured - intercept) / slope - forces, 0.0)
    scale = forces.max(axis=0, where=used, initial=0.0) if full_scale is None else np.full(slope.shape, full_scale)
    reach = scipy.stats.t.ppf(0.5 + confidence / 2, points - 2) * np.sqrt(np.stack([covariance[0, 0], covariance[1, 1]]))
    return CalibrationFit(
        slope=slope,
        intercept=intercept,
        covariance=covariance,
        slope_interval=np.stack([slope - reach[0], slope + reach[0]]),
        intercept_interval=np.stack([intercept - reach[1], intercept + reach[1]]),
        confidence=confidence,
        noise=noise,
        force_error=error,
        used=used,
        linearity_positive=error.max(axis=0, where=used, initial=-np.inf) / scale,
        linearity_negative=error.min(axis=0, where=used, initial=np.inf) / scale,
        rms=np.sqrt((error**2).sum(axis=0) / points),
        full_scale=scale,
    )


def _checked(applied: ArrayLike, measured: ArrayLike, saturated: ArrayLike | None) -> tuple[Array, Array, Array]:
    """Forces and voltages of one shape, and the points that can be used."""
    try:
        force, voltage = np.asarray(applied, dtype=float), np.asarray(measured, dtype=float)
    except (TypeError, ValueError):
        raise InvalidQuantity("forces and voltages must be arrays of real numbers") from None
    if force.ndim == 1 and voltage.ndim > 1:
        force = force.reshape(-1, *[1] * (voltage.ndim - 1))
    if not voltage.ndim or force.shape[:1] != voltage.shape[:1] or np.ndim(force) != voltage.ndim:
        raise InvalidQuantity(f"forces of shape {force.shape} with voltages of shape {voltage.shape}; allowed: (n,) and (n, ...)")
    force = np.broadcast_to(force, voltage.shape)
    used = np.ones(voltage.shape, dtype=bool) if saturated is None else ~np.asarray(saturated, dtype=bool)
    if used.shape != voltage.shape:
        raise InvalidQuantity(f"saturated of shape {used.shape} with voltages of shape {voltage.shape}; allowed: the same")
    for name, values in (("force", force), ("voltage", voltage)):
        if not np.isfinite(values).all():
            raise InvalidQuantity(f"{np.count_nonzero(~np.isfinite(values))} of {values.size} values of {name} are not finite")
    if (force < 0).any():
        raise InvalidQuantity(f"a force is {force.min():g} N; allowed: 0 or more, as the sensor only carries pressure")
    points = np.count_nonzero(used, axis=0)
    if np.any(points < FEWEST_POINTS):
        left = f" after {np.count_nonzero(~used)} saturated were left out" if not used.all() else ""
        raise InvalidQuantity(f"{points.min()} points{left}; allowed: at least {FEWEST_POINTS}")
    span = force.max(axis=0, where=used, initial=0.0) - force.min(axis=0, where=used, initial=np.inf)
    if np.any(span <= 0):
        raise InvalidQuantity("all forces are equal; allowed: at least two different forces")
    return force, voltage, used


def _gauss_newton(force: Array, voltage: Array, measured: Array, used: Array, divider: dict[str, float]) -> tuple[Array, Array]:
    """Slope and intercept of least squared residuals in voltage, beginning at the line through weighted conductances."""
    weight = np.where(used, divider_slope(np.maximum(measured, 0.0), **divider), 0.0)
    slope, intercept = _solved(force, weight, weight * measured)
    for _ in range(MOST_ITERATIONS):
        _check_rising(slope)
        fitted = slope * force + intercept
        weight = np.where(used, divider_slope(fitted, **divider), 0.0)
        loaded = divider["load"] * fitted
        if not np.all(loaded[used] > -0.5):
            break
        step_slope, step_intercept = _solved(force, weight, used * (voltage - divider["supply"] * loaded / (1 + loaded)))
        slope, intercept = slope + step_slope, intercept + step_intercept
        reach = np.abs(step_slope) * force.max(axis=0) + np.abs(step_intercept)
        if np.all(reach <= SETTLED * slope * force.max(axis=0)):
            _check_rising(slope)
            return slope, intercept
    raise ConvergenceError("no line C = m F + n follows the data; look at forces and voltages, supply and load resistor")


def _check_rising(slope: Array) -> None:
    if not np.all(slope > 0):
        raise InvalidQuantity(f"the conductance changes by {np.min(slope):g} S/N; allowed: above 0, as it rises with the force")


def _cofactors(force: Array, weight: Array) -> Array:
    """Inverse of the normal matrix of m and n, shape (2, 2, ...), about the weighted mean force."""
    squared, total = weight**2, (weight**2).sum(axis=0)
    middle = (squared * force).sum(axis=0) / total
    slope = 1 / (squared * (force - middle) ** 2).sum(axis=0)
    cross = -middle * slope
    return np.stack([np.stack([slope, cross]), np.stack([cross, 1 / total + middle**2 * slope])])


def _solved(force: Array, weight: Array, weighted: Array) -> tuple[Array, Array]:
    """Weighted least-squares slope and intercept about the weighted mean force, which keeps round-off small."""
    squared, total = weight**2, (weight**2).sum(axis=0)
    middle = (squared * force).sum(axis=0) / total
    slope = (weight * weighted * (force - middle)).sum(axis=0) / (squared * (force - middle) ** 2).sum(axis=0)
    return slope, (weight * weighted).sum(axis=0) / total - slope * middle
