"""The response of the annulus on atrial tissue to a preload and a harmonic load: thesis, section 4.7."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import atrial_shear_compliance, table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.histories import harmonic, step
from tactsim.analytic.response import response
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.array import Array
from tactsim.errors import UnknownName
from tactsim.interfaces import drawing, quantity
from tactsim.units import Force, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.quantities.annulus import OUTER_RADIUS, OuterRadius, Ratios

FREQUENCY, DELAY, STATIC = 1.0, 2.0, -0.2
"""Hz, s and N of the load as the text gives it; compression negative, section 4.7."""
OMEGA = 2 * np.pi * FREQUENCY
FAST = 1.0
"""Rate in 1/s above which a unit counts as fast: two units of the reading as viscosities, whose rates are 4.3 and 2.8."""
COEFFICIENT_DIGIT = 0.01e-6
"""Last digit of a coefficient that the thesis writes, 0.01 N/MPa, in N/Pa."""
RATE_DIGIT = 0.01
"""Last printed digit of a rate in 1/s."""
TRANSFORM_UNITS = {"static": "N", "numerator": "N/s", "delay": "s", "constant": "1/s^2", "largest": "N"}
POINTS = 601
"""Points of a drawn curve."""


def units_by_speed(chosen: str) -> GeneralizedKelvin:
    """The reading as viscosities with all its units, only the ``fast`` or only the ``slow`` ones, and the free spring.

    Raises
    ------
    UnknownName
        If the choice is not known.
    """
    model = table_4_1("viscosities")
    fast = model.times < 1 / FAST
    choices = {"all": np.ones_like(fast), "fast": fast, "slow": ~fast}
    if chosen not in choices:
        raise UnknownName("choice of units", chosen, choices)
    kept = choices[chosen]
    return GeneralizedKelvin(model.glassy_compliance, model.compliances[kept], model.times[kept])


def truncated(values: Array | float, step: float) -> Array:
    """The values with all digits below ``step`` cut off toward zero, as the thesis writes its numbers; of their shape."""
    return np.trunc(np.asarray(values) / step * (1 + 1e-12)) * step


@quantity(unit=lambda number: TRANSFORM_UNITS[number])
def load_transform(
    number: Literal["static", "numerator", "delay", "constant", "largest"], amplitude: Positive[Force] = 0.2
) -> float:
    """A number in SI of p = static / s + numerator exp(-delay s) / (s^2 + constant), or the largest force of that history.

    Parameters
    ----------
    number : which number
    amplitude : amplitude of the harmonic load; 0.2 N in the text
    """
    last = harmonic(amplitude, FREQUENCY, start=DELAY, mean=STATIC).segments[-1]
    (wave,) = last.harmonics
    return {
        "static": last.value,
        "numerator": wave.amplitude * wave.angular_frequency,
        "delay": last.start,
        "constant": wave.angular_frequency**2,
        "largest": last.value + wave.amplitude,
    }[number]


@quantity(unit="N/Pa")
def dynamic_coefficient(
    coefficient: Literal["cosine", "sine", "first", "second", "slow", "static_first", "static_second", "static_rest"],
    amplitude: Positive[Force] = 0.25,
    truncated_parts: bool = False,
) -> float:
    r"""A coefficient of 4 ro kappa eps0 in N/Pa; 4.7.2 prints N/MPa. With x_i = 1 / tau_i, amplitude A, static force F:

    .. math::
        -A \sum_i \frac{J_i \omega x_i}{\omega^2 + x_i^2} \text{ (cosine)}, \quad
        A \Big(J_0 + \sum_i \frac{J_i x_i^2}{\omega^2 + x_i^2}\Big) \text{ (sine)}, \quad
        \frac{A J_i \omega x_i e^{2 x_i}}{\omega^2 + x_i^2}, \quad -F J_i, \quad F \Big(J_0 + \sum_i J_i\Big)

    ``first`` and ``second`` are the transients of the two fast units, ``slow`` those of the six slow ones together, at 2 s;
    ``static_first`` and ``static_second`` are the creep of the fast units, ``static_rest`` what remains of the
    static response without the creep of the six slow units.

    Parameters
    ----------
    coefficient : which coefficient
    amplitude : amplitude of the harmonic load: 0.25 N in 4.7.1, 0.2 N in the text
    truncated_parts : whether every part loses its digits below 0.01 N/MPa before the parts are added, as in the thesis
    """
    parts = _static_parts(coefficient) if coefficient.startswith("static") else _dynamic_parts(coefficient, amplitude)
    return float(np.sum(truncated(parts, COEFFICIENT_DIGIT) if truncated_parts else parts))


def _dynamic_parts(coefficient: str, amplitude: float) -> Array:
    """Parts in N/Pa whose sum is the coefficient."""
    model = units_by_speed({"cosine": "all", "sine": "all", "slow": "slow"}.get(coefficient, "fast"))
    rates = 1 / model.times
    transients = amplitude * model.compliances * OMEGA * rates / (OMEGA**2 + rates**2)
    if coefficient == "sine":
        in_phase = amplitude * model.compliances * rates**2 / (OMEGA**2 + rates**2)
        return np.append(in_phase, amplitude * model.glassy_compliance)
    if coefficient in ("first", "second"):
        return _of_unit(coefficient, transients * np.exp(DELAY * rates))
    return -transients if coefficient == "cosine" else transients


def _static_parts(coefficient: str) -> Array:
    """Parts in N/Pa; the rest is the whole at infinite time less the creep of the six slow units."""
    fast, slow, whole = (units_by_speed(chosen) for chosen in ("fast", "slow", "all"))
    if coefficient != "static_rest":
        return _of_unit(coefficient, -STATIC * fast.compliances)
    return np.append(-STATIC * slow.compliances, STATIC * whole.equilibrium_compliance)


def _of_unit(coefficient: str, values: Array) -> Array:
    return values[[0]] if coefficient.endswith("first") else values[[1]]


@quantity(unit="1/s")
def dynamic_exponent(exponent: Literal["both", "first", "second", "angular_frequency"], as_written: bool = False) -> float:
    """An exponent or the angular frequency of 4.7.2 in 1/s: over exp((x1 + x2) t), with the fast rates x1 > x2, a unit of rate x
    leaves x1 + x2 - x.

    Parameters
    ----------
    exponent : x1 + x2; what the unit of rate x1, or that of x2, leaves of it; 2 pi f
    as_written : whether the sum is rounded to 0.01 1/s and the rate taken off cut there, as in the thesis
    """
    if exponent == "angular_frequency":
        return OMEGA
    first, second = 1 / units_by_speed("fast").times
    both = round((first + second) / RATE_DIGIT) * RATE_DIGIT if as_written else first + second
    rate = {"both": 0.0, "first": first, "second": second}[exponent]
    return float(both - (truncated(rate, RATE_DIGIT) if as_written else rate))


@quantity(unit="N/Pa")
def slow_creep(time: NonNegative[Time]) -> float:
    """Static response in N/Pa with all eight units less that with the two fast ones, times 4 ro kappa.

    Parameters
    ----------
    time : time since the static force began
    """
    whole, fast = (float(response(units_by_speed(chosen), step(STATIC), time)) for chosen in ("all", "fast"))
    return whole - fast


@drawing
def quasi_static_response(
    title: Title,
    ratios: Ratios,
    amplitudes: Annotated[tuple[Force, ...], Field(min_length=1, max_length=2)],
    end: Positive[Time],
    outer_radius: OuterRadius = OUTER_RADIUS,
) -> Data:
    """Displacement in m over time in s under a preload and a harmonic load, as Fig. 4.14; negative into the tissue, as in 4.7.1.

    With all eight units in the reading of 4.6.4; there is a panel for each amplitude.

    Parameters
    ----------
    amplitudes : amplitudes of the harmonic load
    end : longest time
    """
    tissue = atrial_shear_compliance("viscosities", "half_shear")
    times = np.linspace(0, end, POINTS)
    panels = []
    for amplitude in amplitudes:
        load = harmonic(amplitude, FREQUENCY, start=DELAY, mean=STATIC)
        annuli = {ratio: ViscoelasticAnnulus(outer_radius, ratio, tissue) for ratio in ratios}
        curves = [series(f"ri/ro = {ratio:g}", times, annulus.displacement(load, times)) for ratio, annulus in annuli.items()]
        panels.append(panel(f"displacement at {amplitude:g} N", "m", curves))
    return curves_figure(title, "time", "s", panels, even_panels=True)
