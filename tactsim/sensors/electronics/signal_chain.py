"""Signal chain of resistive sensors: divider, buffer, noise, converter and low pass, whole records or chunks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.divider import divider_conductance, divider_slope, divider_voltage
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.units import Frequency, Positive, Resistance, Voltage

MOST_SAMPLES = 10**8
"""Longest record, in samples per channel."""


class Buffer(FrozenModel):
    """Unity-gain amplifier between divider and converter, with the errors of a real one.

    Source: thesis, 2.2.1, 3.1.2 and 6.2: it keeps the board from loading the divider; its errors are not given.
    """

    gain_error: Annotated[float, Field(gt=-0.5, lt=0.5)] = 0.0
    """Gain minus one."""
    offset: Voltage = 0.0
    """Voltage at its output for 0 V at its input."""

    def output(self, voltage: Array) -> Array:
        """Voltage in V at the output, of the shape of that at the input."""
        return voltage if self.gain_error == self.offset == 0 else (1 + self.gain_error) * voltage + self.offset


UNITY = Buffer()


@dataclass(frozen=True, eq=False)
class Recording:
    """What the chain delivers; the arrays but ``time`` have the shape ``(time, *channels)``."""

    time: Array
    """Times in s, shape (time,)."""
    voltage: Array
    """Converted voltage in V."""
    filtered: Array
    """Voltage in V after the low pass; the converted one if there is none."""
    saturated: Array
    """True where the sample lay outside the range of the converter; it reads the end of the range there."""


class SignalChain(FrozenModel):
    """Electronics of every channel, from the conductance of its sensor to filtered samples.

    The low pass acts on the converted samples. There is no filter before the converter, so what lies above half the sampling
    rate is folded below it, as in the thesis's set-up.

    Source: thesis, 2.2.1 (divider, supply of 5 V), 3.1.2 (buffer, low pass of 10 Hz) and 6.4 (board, low pass of 40 Hz).
    Section 3.1.2 gives a supply of 0.5 V (errata E27): 5 V is the default. The load resistor and the sampling rate are not
    printed (Fig. 3.5: 200 Hz); 1 kohm puts the line of 3.1.2 at 25 N in the middle of the range.
    """

    supply: Annotated[Voltage, Field(gt=0, le=1e6)] = 5.0
    """Voltage over sensor and load resistor."""
    load_resistor: Annotated[Resistance, Field(gt=0, le=1e12)] = 1e3
    """Resistor over which the voltage is read."""
    buffer: Buffer = UNITY
    """Amplifier in front of the converter."""
    noise: Noise = Noise()
    """Noise at the converter's input."""
    sampling_rate: Positive[Frequency] = 1000.0
    """Samples per second of each channel."""
    converter: Converter = Converter()
    """Range and resolution."""
    low_pass: LowPass | None = LowPass()
    """Filter of the samples; null is none."""

    @model_validator(mode="after")
    def _sampled_fast_enough(self) -> Self:
        if self.low_pass is not None:
            self.low_pass.check(self.sampling_rate)
        return self

    def times(self, duration: float) -> Array:
        """Sampling times (n,) ``k / sampling_rate`` in s from 0 up to a duration in s, both ends included.

        Raises
        ------
        InvalidQuantity
            If the duration is negative, not finite, or longer than `MOST_SAMPLES`.
        """
        if not 0 <= duration * self.sampling_rate <= MOST_SAMPLES:
            longest = MOST_SAMPLES / self.sampling_rate
            raise InvalidQuantity(f"duration {duration:g} s is not usable; allowed: 0 to {longest:g} s at this sampling_rate")
        return np.arange(int(np.floor(duration * self.sampling_rate + 1e-9)) + 1) / self.sampling_rate

    def sampled(self, time: Array, values: Array) -> tuple[Array, Array]:
        """Sampling times in s within a history, from its first time on, and its values there, linear between its points.

        Parameters
        ----------
        time
            Increasing times in s, shape (n,).
        values
            Values of any unit, shape (n, ...).

        Raises
        ------
        InvalidQuantity
            If the times do not increase, a number is not finite, or the shapes do not belong together.
        """
        time, values = _history(time, values)
        sampled = time[0] + self.times(float(time[-1] - time[0]))
        after = np.clip(np.searchsorted(time, sampled, side="right"), 1, max(time.size - 1, 1))
        if time.size == 1:
            return sampled, values
        share = np.clip((sampled - time[after - 1]) / (time[after] - time[after - 1]), 0.0, 1.0)
        share = share.reshape(-1, *[1] * (values.ndim - 1))
        return sampled, (1 - share) * values[after - 1] + share * values[after]

    def voltage(self, conductance: Array) -> Array:
        """Voltage in V of the divider for conductances in S of any shape, without buffer errors and noise (2.2.1).

        Raises
        ------
        InvalidQuantity
            If a conductance is negative, not finite or too large.
        """
        return divider_voltage(conductance, supply=self.supply, load=self.load_resistor)

    def conductance(self, voltage: Array) -> Array:
        """Conductance in S for voltages in V of any shape, the inverse of `voltage`; errors of the buffer remain in it.

        Raises
        ------
        InvalidQuantity
            If a voltage is not finite or not below the supply.
        """
        return divider_conductance(voltage, supply=self.supply, load=self.load_resistor)

    def read_conductance(self, voltage: Array) -> Array:
        """Conductance in S for samples in V, of their shape; one at or above the supply reads as the last number below it."""
        return self.conductance(np.minimum(voltage, self.largest_voltage))

    @property
    def largest_voltage(self) -> float:
        """Largest floating-point voltage in V below the supply, at which the conductance is still finite."""
        return float(np.nextafter(self.supply, 0))

    def conductance_step(self, conductance: Array) -> Array:
        """Change of the conductance in S that one step of the converter stands for, at a conductance in S, of its shape."""
        return self.converter.step / divider_slope(conductance, supply=self.supply, load=self.load_resistor)

    def acquire(self, conductance: Array, generator: np.random.Generator | None = None) -> Recording:
        """Samples of conductances in S of shape ``(time, *channels)`` at the times ``k / sampling_rate``.

        The low pass begins settled at the first sample. Only noise draws from the generator, first the phases of the channels;
        without noise it may be None.

        Raises
        ------
        InvalidQuantity
            If a conductance is negative or not finite, there is none, or noise has no generator.
        """
        return self.stream(generator).take(conductance)[0]

    def stream(self, generator: np.random.Generator | None = None) -> ChainStream:
        """The chain before its first sample, to be fed in chunks."""
        return ChainStream(self, generator)


@dataclass(frozen=True, eq=False)
class ChainStream:
    """A chain between two chunks: what it must remember, as a value.

    ``recording, stream = stream.take(chunk)`` gives the samples of the chunk and the stream to continue with. Chunks of any
    length give together what `SignalChain.acquire` gives at once with a generator of the same seed, as noise is drawn in the
    order of time. The generator itself moves on with every chunk, so with noise a stream can be continued once.
    """

    chain: SignalChain
    generator: np.random.Generator | None
    samples: int = 0
    """Samples taken so far."""
    phases: Array | None = None
    """Phases in rad of the pick-up, of the shape of the channels, drawn with the first chunk."""
    filter_state: Array | None = None
    """State of the low pass (sections, 2, channels); None before the first sample."""

    def take(self, conductance: Array) -> tuple[Recording, ChainStream]:
        """Samples of the next conductances in S, shape ``(time, *channels)``, and the stream behind them.

        Raises
        ------
        InvalidQuantity
            If a conductance is negative or not finite, there is none, noise has no generator, or the channels have changed.
        """
        chain, conductance = self.chain, np.asarray(conductance, dtype=float)
        if not conductance.size or not conductance.ndim:
            raise InvalidQuantity(f"conductances of shape {conductance.shape}; allowed: (time, ...) with at least one sample")
        phases = self.phases
        if phases is None:
            phases = chain.noise.phases(conductance.shape[1:], self.generator)
        if phases.shape != conductance.shape[1:]:
            raise InvalidQuantity(f"channels of shape {conductance.shape[1:]} after {phases.shape}; allowed: the same throughout")
        time = np.arange(self.samples, self.samples + len(conductance)) / chain.sampling_rate
        analog = chain.buffer.output(chain.voltage(conductance))
        if not chain.noise.silent:
            analog = analog + chain.noise.sample(time, phases, self.generator)
        voltage, saturated = chain.converter.convert(analog)
        filtered, state = voltage, self.filter_state
        if chain.low_pass is not None:
            filtered, state = chain.low_pass.filtered(voltage, chain.sampling_rate, state)
        after = ChainStream(chain, self.generator, self.samples + len(conductance), phases, state)
        return Recording(time, voltage, filtered, saturated), after


def _history(time: Array, values: Array) -> tuple[Array, Array]:
    """Times and values as arrays that belong together."""
    time, values = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if time.ndim != 1 or not time.size or values.shape[:1] != time.shape:
        raise InvalidQuantity(f"times of shape {time.shape} with values of shape {values.shape}; allowed: (n,) with (n, ...)")
    if not (np.isfinite(time).all() and np.isfinite(values).all()):
        raise InvalidQuantity("times and values must be finite")
    late = np.flatnonzero(np.diff(time) <= 0)
    if late.size:
        k = int(late[0])
        raise InvalidQuantity(f"time {k + 2} is {time[k + 1]:g} s after {time[k]:g} s; times must increase")
    return time, values
