"""What an identification from dynamic mechanical analysis reports beside quantities and history."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.identification.dma_signals import SHOWN_CYCLES, DmaSignals, ModulusEstimate, fitted_signals
from tactsim.model import FrozenModel
from tactsim.results.scene import Scene


class KelvinFit(FrozenModel):
    """What one method of fitting identified; constants by name in SI."""

    evaluations: int
    """Of the objective."""
    statement: str
    """How many constants the data determine, in words."""
    constants: dict[str, float]
    """Their values."""
    standard_errors_of_logarithms: dict[str, float | None]
    """Of each constant."""
    told: dict[str, bool]
    """Whether the data determine each constant."""
    singular_values: tuple[float, ...]
    """Of the sensitivity of the data to the logarithms of the constants, over the noise."""
    confidence: float
    """Of the band."""
    band: Literal["simultaneous", "pointwise"]
    """What the band holds at once: the whole curve, or each point of it."""
    generation: tuple[int, ...] = ()
    """Some generations of a genetic algorithm."""
    best_objective: tuple[float, ...] = ()
    """The best objective in each of them."""
    true_curves_inside_band: bool | None = None
    """Of synthetic data, whether the band holds the true curves."""


class ShownSignals(FrozenModel):
    """The beginning of the signals of one test, and the sines that fit them."""

    frequency: float
    """In Hz."""
    time: tuple[float, ...]
    """In s."""
    load: tuple[float, ...]
    """In N, at each time."""
    displacement: tuple[float, ...]
    """In m, at each time."""
    fitted_load: tuple[float, ...]
    """Sine, offset and drift, in N."""
    fitted_displacement: tuple[float, ...]
    """Sine, offset and drift, in m."""
    lag: float
    """Of the displacement behind the load, in rad."""

    @classmethod
    def of(cls, signals: DmaSignals, estimate: ModulusEstimate) -> Self:
        """The first cycles of a test, and what was fitted to it."""
        time = signals.time - signals.time[0]
        shown = time <= SHOWN_CYCLES / estimate.frequency * (1 + 1e-9)
        load, displacement = fitted_signals(signals, estimate.frequency)
        columns = (time, signals.load, signals.displacement, load, displacement)
        names = ("time", "load", "displacement", "fitted_load", "fitted_displacement")
        listed = {name: tuple(values[shown].tolist()) for name, values in zip(names, columns, strict=True)}
        return cls(frequency=estimate.frequency, **listed, lag=float(np.angle(estimate.modulus)))


class DmaScene(Scene):
    """The fits, by method."""

    kind: Literal["dma_identification"] = "dma_identification"
    data_frequencies: tuple[float, ...]
    """In Hz."""
    fits: dict[str, KelvinFit]
    """By the name of the method."""
    signals: tuple[ShownSignals, ...] = ()
    """Of the lowest and the highest frequency, if signals were analysed."""
