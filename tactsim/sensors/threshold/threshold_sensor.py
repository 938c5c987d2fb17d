"""The threshold sensor of chapter 3 behind its electronics: two piezoresistive sensors, their chain, calibration and trigger."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.model import FrozenModel
from tactsim.sensors.electronics.calibration import THESIS_LINE, AnyCalibration
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import Recording, SignalChain
from tactsim.sensors.films.any_film import ConductingFilm
from tactsim.sensors.threshold.threshold_trigger import ThresholdTrigger, TriggerLevel
from tactsim.units import Time

LARGE, SMALL = 0, 1
"""Place of the channels on the second axis of a recording."""


class ForceSensor(FrozenModel):
    """One piezoresistive sensor: what it conducts, and the line by which its conductance is read as a force."""

    calibration: AnyCalibration = THESIS_LINE
    """Line of the reading."""
    film: ConductingFilm | None = None
    """What the sensor conducts, with creep; null is the calibration line itself."""

    def conductance(self, time: Array, force: Array) -> Array:
        """Conductance in S under forces in N, shape (time, ...), at times in s."""
        return self.calibration.conductance(force) if self.film is None else self.film.read(time, force)


class ThresholdSensor(FrozenModel):
    """Large and small sensor, read through equal chains; the small one triggers the capture of the large one's reading.

    Source: thesis, 3.1.1 and 3.1.2: low pass of first order at 10 Hz. The line of Fig. 3.4 is that of the larger sensor; the same
    is assumed for the smaller one.
    """

    large: ForceSensor = ForceSensor()
    """Behind the filler plate."""
    small: ForceSensor = ForceSensor()
    """In the hole."""
    chain: SignalChain = SignalChain(low_pass=LowPass(cutoff=10.0))
    """Electronics of each channel."""
    trigger: TriggerLevel = TriggerLevel()
    """When the small sensor counts as touched."""
    capture: Literal["filtered", "unfiltered"] = "filtered"
    """Which reading of the large sensor is captured; the trigger always works on the filtered one of the small sensor."""
    large_bears: Literal["plate_and_small", "plate"] = "plate_and_small"
    """What presses the large sensor: Fig. 3.2 lays the small one on it, so that it bears both."""
    rest: Annotated[Time, Field(ge=0.5, le=100)] = 10.0
    """Length of the recording without load from which rest value and noise of the small sensor are known."""

    @property
    def has_films(self) -> bool:
        """Whether a sensor conducts otherwise than its calibration line."""
        return self.large.film is not None or self.small.film is not None

    def without_films(self) -> Self:
        """The same sensor, conducting what its calibration lines say."""
        plain = {name: ForceSensor(calibration=getattr(self, name).calibration) for name in ("large", "small")}
        return self.model_copy(update=plain)

    def record(
        self, time: Array, plate: Array, small: Array, *, noise: Noise, generator: np.random.Generator | None, copies: int = 1
    ) -> Recording:
        """Converted samples, shape (time, 2, copies), of forces in N on plate and small sensor, each (time,).

        Each copy has its own noise.
        """
        borne = plate + small if self.large_bears == "plate_and_small" else plate
        conductance = np.stack([self.large.conductance(time, borne), self.small.conductance(time, small)], axis=1)
        chain = self.chain.model_copy(update={"noise": noise, "low_pass": None})
        return chain.acquire(np.repeat(conductance[:, :, None], copies, axis=2), generator)

    def readings(self, recording: Recording, low_pass: LowPass | None) -> tuple[Array, Array]:
        """The large sensor's reading as it is captured and the small one's filtered reading in N, each (time, copies)."""
        voltage, rate = recording.voltage, self.chain.sampling_rate
        filtered = voltage if low_pass is None else low_pass.filtered(voltage, rate)[0]
        captured = (voltage if self.capture == "unfiltered" else filtered)[:, LARGE]
        return self._force(self.large, captured), self._force(self.small, filtered[:, SMALL])

    def armed(self, low_pass: LowPass | None, *, noise: Noise, seed: list[int]) -> ThresholdTrigger:
        """The trigger set by a recording without load, with one level.

        Raises
        ------
        InvalidQuantity
            If the recording at rest is empty or not finite, or the step of the converter is not positive.
        """
        generator = np.random.default_rng(seed)
        time = self.chain.times(self.rest)
        recording = self.record(time, np.zeros(time.size), np.zeros(time.size), noise=noise, generator=generator)
        settled = 0 if low_pass is None else min(time.size // 2, int(2 * self.chain.sampling_rate / low_pass.cutoff))
        reading = self.readings(recording, low_pass)[1][settled:, 0]
        return ThresholdTrigger(*self.trigger.above_rest(reading, self._step(recording.voltage[0, SMALL, 0])))

    def _force(self, sensor: ForceSensor, voltage: Array) -> Array:
        return sensor.calibration.force(self.chain.conductance(voltage))

    def _step(self, voltage: float) -> float:
        """Force in N of one step of the converter at a voltage in V of the small sensor."""
        steps = np.array([voltage, voltage + self.chain.converter.step])
        return float(np.diff(self._force(self.small, steps))[0])
