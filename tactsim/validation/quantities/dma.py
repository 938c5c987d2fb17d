"""Dynamic mechanical analysis from signals: thesis section 4.4, Fig. 4.8 to 4.10."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import scipy
from pydantic import Field

from tactsim.analytic.atrial import table_4_1
from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.identification.dma_data import DmaData, synthetic_dma
from tactsim.identification.dma_least_squares import fit_least_squares
from tactsim.identification.dma_objective import compliance_parts, objective, objective_slopes
from tactsim.identification.dma_signals import SHOWN_CYCLES, DmaSignals, complex_modulus
from tactsim.identification.dma_synthetic_signals import DmaMachine, synthetic_signals
from tactsim.interfaces import drawing, quantity
from tactsim.units import Frequency, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series

AREA, HEIGHT, MEAN_LOAD, AMPLITUDE = 100e-6, 5e-3, 5e-3, 2.5e-3
"""Specimen and loads, in SI, which the thesis does not print; they cancel in a modulus."""
PAUSE = 0.3
"""Pause that is drawn between two tests, over the duration of the first."""

SLOPE_SOUGHT, SLOPE_LEFT, MOST_SEARCHED = 1e-12, 1e-5, 5000
"""Slopes of an objective of 4.5.2 by the logarithms of constants, over the objective of no compliance: what the search goes for,
which round-off ends before, and what may be left; and its steps. With what suffices by default the curves chosen move by 1e-3 of
their distance from one processor to another."""

Cycles = Annotated[float, Field(ge=1, le=1000, description="Recorded cycles, whole or not.")]
NoisePart = Annotated[float, Field(ge=0, le=0.5, description="Noise of each sample over the amplitude of its oscillation.")]
Hold = Annotated[
    NonNegative[Time] | None,
    Field(description="Time of the mean load from rest before the oscillation; null is the steady state."),
]


def _signals(frequency: float, cycles: float, noise: float, hold: float | None, seed: int) -> DmaSignals:
    machine = DmaMachine(AREA, HEIGHT, MEAN_LOAD, AMPLITUDE, cycles=cycles, hold=hold, load_noise=noise, displacement_noise=noise)
    (signals,) = synthetic_signals(table_4_1(), [frequency], machine, seed=seed)
    return signals


@quantity(unit="1")
def dma_signal_error(
    number: Literal["difference", "standard_error", "difference_over_error"],
    frequency: Positive[Frequency],
    *,
    cycles: Cycles = 20.0,
    noise: NoisePart = 0.0,
    hold: Hold = None,
    seed: NonNegative[int] = 1,
) -> float:
    """Modulus from load and displacement signals of Table 4.1 against its own E*, dimensionless.

    ``difference`` is |E - E*| / |E*|; ``standard_error`` that of storage and loss modulus, summed in squares, over |E*|;
    ``difference_over_error`` their ratio.

    Parameters
    ----------
    number : which of them
    frequency : of the test
    seed : of the noise
    """
    estimate = complex_modulus(_signals(frequency, cycles, noise, hold, seed))
    true = complex(1 / table_4_1().complex_compliance(np.array([2 * np.pi * frequency]))[0])
    difference = abs(estimate.modulus - true) / abs(true)
    error = float(np.hypot(*estimate.modulus_errors)) / abs(true)
    return {"difference": difference, "standard_error": error, "difference_over_error": difference / error}[number]


@quantity(unit="rad")
def dma_signal_lag(frequency: Positive[Frequency], *, cycles: Cycles = 20.0, noise: NoisePart = 0.0) -> float:
    """Angle in rad by which the displacement lags behind the load in the signals of Table 4.1.

    Parameters
    ----------
    frequency : of the test
    """
    return float(np.angle(complex_modulus(_signals(frequency, cycles, noise, None, 1)).modulus))


@quantity(unit="1")
def objective_forms(
    noise: Annotated[float, Field(gt=0, le=0.5)], seeds: Annotated[tuple[NonNegative[int], ...], Field(min_length=1)]
) -> float:
    """Distance between the compliances that the two forms of eq. 4.5.2 choose, over the residual of the squared form.

    The norms are over elastic and viscous compliance at the eight frequencies; the number is the largest of several sets of data.

    Parameters
    ----------
    noise : of each compliance of Table 4.1 over itself
    seeds : of the noise, one for each set of data
    """
    return max(_apart_over_misfit(synthetic_dma(table_4_1(), noise=noise, seed=seed)) for seed in seeds)


def _apart_over_misfit(data: DmaData) -> float:
    """The same of one set of data; both searches begin at the constants that least squares find."""
    start, size = fit_least_squares(data, weighting="objective").constants.logarithms, float(np.linalg.norm(data.parts))

    def chosen(form: str, scale: float) -> Array:
        search = scipy.optimize.minimize(
            lambda logarithms: float(objective(logarithms, data, form)) / scale,
            start,
            method="BFGS",
            jac=lambda logarithms: objective_slopes(logarithms, data, form) / scale,
            options={"gtol": SLOPE_SOUGHT, "maxiter": MOST_SEARCHED},
        )
        left = float(np.abs(search.jac).max())
        if not left < SLOPE_LEFT:
            raise ConvergenceError(f"least {form} objective of 4.5.2: a slope of {left:.1e} is left")
        return compliance_parts(search.x, data.frequencies)

    squared, printed = chosen("squared", size**2), chosen("as_printed", size)
    return float(np.linalg.norm(printed - squared) / np.linalg.norm(squared - data.parts))


@drawing
def dma_successive_tests(
    title: Title, frequencies: Annotated[tuple[Positive[Frequency], ...], Field(min_length=2)], *, noise: NoisePart = 0.02
) -> Data:
    """Load in N and displacement in m over the first cycles of tests one after the other, as in Fig. 4.8.

    Parameters
    ----------
    frequencies : of the tests
    """
    loads, displacements, begin = [], [], 0.0
    for frequency in frequencies:
        signals = _signals(frequency, SHOWN_CYCLES, noise, None, 1)
        time = begin + signals.time - signals.time[0]
        loads.append(series(f"{frequency:g} Hz", time, signals.load))
        displacements.append(series(f"{frequency:g} Hz", time, signals.displacement))
        begin = time[-1] + PAUSE * SHOWN_CYCLES / frequencies[0]
    panels = [panel("load", "N", loads), panel("displacement", "m", displacements)]
    return curves_figure(title, "time", "s", panels, even_panels=True)


@drawing
def dma_phase(title: Title, frequency: Positive[Frequency], *, noise: NoisePart = 0.02) -> Data:
    """Load and displacement over their own amplitude, about their means, which shows the angle between them, as in Fig. 4.9.

    Parameters
    ----------
    frequency : of the test
    """
    signals = _signals(frequency, SHOWN_CYCLES, noise, None, 1)
    curves = []
    for name, values in (("load", signals.load), ("displacement", signals.displacement)):
        about = values - values.mean()
        curves.append(series(name, signals.time, about / (np.sqrt(2) * about.std())))
    return curves_figure(title, "time", "s", [panel("over its amplitude", "", curves)])
