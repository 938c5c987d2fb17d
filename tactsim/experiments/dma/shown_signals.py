"""What a figure shows of the signals of a dynamic mechanical analysis: the first cycles of two tests with their fits."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.experiments.dma.scene import ShownSignals
from tactsim.experiments.dma.source import SignalsAnalysis
from tactsim.identification.dma_signals import DmaSignals, ModulusEstimate, fitted_signals

CYCLES = 3.0
"""Cycles that are shown."""


def shown_signals(analysis: SignalsAnalysis) -> tuple[ShownSignals, ...]:
    """The tests of the lowest and of the highest frequency."""
    pairs = list(zip(analysis.signals, analysis.estimates, strict=True))
    return tuple(_shown(signals, estimate) for signals, estimate in (pairs[0], pairs[-1]))


def _shown(signals: DmaSignals, estimate: ModulusEstimate) -> ShownSignals:
    time = signals.time - signals.time[0]
    kept = time <= CYCLES / estimate.frequency * (1 + 1e-9)
    load, displacement = fitted_signals(signals, estimate.frequency)

    def listed(values: Array) -> tuple[float, ...]:
        return tuple(values[kept].tolist())

    return ShownSignals(
        frequency=estimate.frequency,
        time=listed(time),
        load=listed(signals.load),
        displacement=listed(signals.displacement),
        fitted_load=listed(load),
        fitted_displacement=listed(displacement),
        lag=float(np.angle(estimate.modulus)),
    )
