"""Load and displacement signals of a dynamic mechanical analysis as a generalized Kelvin model gives them, with noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.histories import Harmonic, History, Segment
from tactsim.analytic.response import response
from tactsim.analytic.spectrum import checked_number
from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.identification.dma_signals import DmaSignals


@dataclass(frozen=True)
class DmaMachine:
    """A machine that prescribes the load on a specimen and records load and displacement, as in thesis Fig. 4.8.

    Raises
    ------
    InvalidQuantity
        If a number is out of its range.
    """

    area: float
    """Rest area of the specimen's cross-section in m^2."""
    height: float
    """Rest height of the specimen in m."""
    mean_load: float
    """In N."""
    amplitude: float
    """Of the load, in N."""
    cycles: float = 20.0
    """Recorded at each frequency; any number of at least one, whole or not."""
    samples_per_cycle: int = 50
    hold: float | None = None
    """Time in s for which the mean load is held from rest; None records the steady state."""
    precycles: float = 0.0
    """Cycles behind the hold that are not recorded."""
    load_noise: float = 0.0
    """Standard deviation of the noise of the load over the amplitude of its oscillation."""
    displacement_noise: float = 0.0
    """The same of the displacement."""

    def __post_init__(self) -> None:
        for name in ("area", "height", "amplitude", "cycles", "samples_per_cycle"):
            checked_number(name, getattr(self, name))
        for name in ("precycles", "load_noise", "displacement_noise"):
            checked_number(name, getattr(self, name), zero=True)
        if self.hold is not None:
            checked_number("hold", self.hold, zero=True)
        if self.mean_load < self.amplitude:
            raise InvalidQuantity(
                f"mean_load is {self.mean_load:g} N and amplitude {self.amplitude:g} N; allowed: a mean of at least the "
                "amplitude, or the specimen is let go"
            )

    def times(self, frequency: float) -> Array:
        """Times (n,) in s from the beginning of the record."""
        return np.arange(round(self.cycles * self.samples_per_cycle) + 1) / (self.samples_per_cycle * frequency)

    def record(self, model: GeneralizedKelvin, frequency: float, generator: np.random.Generator) -> DmaSignals:
        r"""The signals at a frequency in Hz; the strain is exact.

        .. math:: F(t) = F_0 + F_1 \sin \omega t, \qquad \varepsilon(t) = \int_{0^-}^t J(t - s)\, d\sigma(s)

        and in the steady state :math:`\varepsilon = \varepsilon_0 + \mathrm{Im}[D^*(\omega) (F_1 / A) e^{i \omega t}]` with the
        mean strain after a long time.
        """
        times, angular = self.times(frequency), 2 * np.pi * frequency
        swing = model.complex_compliance(np.array([angular]))[0] * self.amplitude / self.area
        if self.hold is None:
            load = self.mean_load + self.amplitude * np.sin(angular * times)
            rest = (model.glassy_compliance + model.compliances.sum()) * self.mean_load / self.area
            strain = rest + (swing * np.exp(1j * angular * times)).imag
        else:
            history = self._history(angular, self.hold)
            instants = self.hold + self.precycles / frequency + times
            load, strain = history.value(instants) * self.area, response(model, history, instants)
        deviations = (self.load_noise * self.amplitude, self.displacement_noise * abs(swing) * self.height)
        noises = [deviation * generator.standard_normal(times.size) for deviation in deviations]
        columns = {"time": times, "load": load + noises[0], "displacement": strain * self.height + noises[1]}
        return DmaSignals(**columns, frequency=frequency, area=self.area, height=self.height)

    def _history(self, angular: float, held: float) -> History:
        """Stress in Pa over time in s: the mean held, then the oscillation about it."""
        mean = self.mean_load / self.area
        swing = Segment(held, np.inf, mean, harmonics=(Harmonic(self.amplitude / self.area, angular),))
        return History((Segment(0.0, held, mean), swing) if held > 0 else (swing,))


def synthetic_signals(
    model: GeneralizedKelvin, frequencies: Sequence[float], machine: DmaMachine, *, seed: int
) -> list[DmaSignals]:
    """The tests at several frequencies in Hz, each from a specimen at rest; the noise of each hangs on the seed and its place."""
    return [
        machine.record(model, float(frequency), np.random.default_rng([seed, number]))
        for number, frequency in enumerate(frequencies)
    ]
