"""Repeated samplings of one approach: what the trigger reports, and how much of its error filter, sampling and noise make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.errors import InvalidQuantity
from tactsim.experiments.threshold.contact_curve import Approach
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import Recording
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold.threshold_trigger import Threshold, ThresholdTrigger, TriggerState, reported_threshold

BLOCK = 10
"""Most trials that share the phase of sampling; the phases of the blocks, of equal sizes, divide the sampling interval evenly."""
FINER = 16
"""Sampling of the ideal chain, which stands for continuous time, over that of the real one."""
SILENT = Noise()
MOST_SAMPLES = 500_000
"""Longest recording of one approach, in samples."""
SETTLING = 2.0
"""Time in periods of the cut-off after which a low pass has forgotten its start: 12.6 time constants of the first order."""


def check_length(recording: str, duration: float, rate: float) -> None:
    """Refuse a recording of too many samples; its words stand before their number, its duration is in s, the rate in Hz.

    Raises
    ------
    InvalidQuantity
        With the number of samples.
    """
    samples = duration * rate
    if samples > MOST_SAMPLES:
        raise InvalidQuantity(
            f"{recording} {samples:.3g} samples; allowed: up to {MOST_SAMPLES}; "
            "press faster, shorten the lead or sample more slowly"
        )


@dataclass(frozen=True)
class Trials:
    """What one sensor reported in repeated approaches; arrays of shape (trials,)."""

    true_force: float
    """In N."""
    touch: float
    """Time in s from the beginning of the recordings to the true touch."""
    error: Array
    """Reported minus true force in N; meaningless where not valid."""
    delay: Array
    """Time in s from the true touch to the trigger; meaningless where not valid."""
    valid: Array
    false: Array
    missed: Array
    saturated: Array

    @classmethod
    def joined(cls, parts: list[Threshold], true_force: float, touches: list[float]) -> Self:
        """From the reports of blocks with their times of touch in s, and the true force in N."""
        touch = np.concatenate([np.full(part.force.shape, at) for part, at in zip(parts, touches, strict=True)])

        def column(name: str) -> Array:
            return np.concatenate([getattr(part, name) for part in parts])

        error, delay = column("force") - true_force, column("time") - touch
        return cls(
            true_force, touches[0], error, delay, column("valid"), column("false"), ~column("triggered"), column("saturated")
        )

    def mean_error(self) -> float | None:
        """Mean error in N of the valid trials, None without any."""
        return valid_mean(self.error, self.valid)

    def deviation(self) -> float | None:
        """Standard deviation in N of the valid trials, None for fewer than two."""
        return valid_deviation(self.error, self.valid)

    def mean_delay(self) -> float | None:
        """Mean time in s from touch to trigger of the valid trials, None without any."""
        return valid_mean(self.delay, self.valid)


def valid_mean(values: Array, valid: Array) -> float | None:
    """Mean of the valid of some values (n,) in their unit, None without any."""
    return float(values[valid].mean()) if valid.any() else None


def valid_deviation(values: Array, valid: Array) -> float | None:
    """Standard deviation of the valid of some values (n,) in their unit, None for fewer than two."""
    return float(values[valid].std(ddof=1)) if valid.sum() > 1 else None


@dataclass(frozen=True)
class ApproachSampling:
    """One approach as one sensor samples it, with the trigger armed ``lead`` s before the touch, its low passes settled."""

    sensor: ThresholdSensor
    approach: Approach
    area: float
    """Annular area in m^2."""
    lead: float
    settling: float
    """Time in s before the trigger is armed."""

    @classmethod
    def settled(
        cls, sensor: ThresholdSensor, approach: Approach, area: float, lead: float, low_passes: Sequence[LowPass | None]
    ) -> Self:
        """For an annular ``area`` in m^2 and a ``lead`` in s, with the time that the slowest low pass needs to settle."""
        settling = max((SETTLING / low.cutoff for low in low_passes if low is not None), default=0.0)
        return cls(sensor, approach, area, lead, settling)

    def trials(
        self,
        noise: Noise,
        low_passes: Sequence[LowPass | None],
        triggers: Sequence[ThresholdTrigger],
        *,
        trials: int,
        seed: tuple[int, ...],
    ) -> list[Trials]:
        """Reports for each low pass with its trigger, all from the same recordings; without noise one trial for each phase.

        Raises
        ------
        OutOfTime
            If the time limit has passed, or another thread has stopped the computation.
        """
        blocks = -(-trials // BLOCK)
        reports: list[list[Threshold]] = [[] for _ in low_passes]
        touches = []
        for block in range(blocks):
            check_time()
            copies = 1 if noise.silent else (block + 1) * trials // blocks - block * trials // blocks
            generator = np.random.default_rng([*seed, block])
            recording, touch = self.recorded(self.sensor, noise, generator, phase=(block + 0.5) / blocks, copies=copies)
            touches.append(touch)
            for low_pass, trigger, reported in zip(low_passes, triggers, reports, strict=True):
                reported.append(self._report(self.sensor, recording, low_pass, trigger, touch))
        return [Trials.joined(reported, self.approach.threshold_force, touches) for reported in reports]

    def ideal_error(self, low_pass: LowPass | None, level: float, *, films: bool = True) -> float | None:
        """Error in N in continuous time, without noise and rounding; None if nothing is reported.

        Without ``low_pass`` nothing is filtered; without ``films`` both sensors conduct what their calibration lines say.

        Raises
        ------
        InvalidQuantity
            If the level is not positive or not finite.
        """
        converter = self.sensor.chain.converter
        fine = Converter(low=converter.low, high=converter.high, bits=32)
        rate = FINER * self.sensor.chain.sampling_rate
        chain = self.sensor.chain.model_copy(update={"sampling_rate": rate, "converter": fine})
        sensor = (self.sensor if films else self.sensor.without_films()).model_copy(update={"chain": chain})
        recording, touch = self.recorded(sensor, SILENT, None, phase=0.5, copies=1)
        rest = sensor.readings(recording, low_pass)[1][0]
        report = self._report(sensor, recording, low_pass, ThresholdTrigger(rest, np.full(rest.shape, level)), touch)
        return float(report.force[0]) - self.approach.threshold_force if report.valid[0] else None

    def recorded(
        self, sensor: ThresholdSensor, noise: Noise, generator: np.random.Generator | None, *, phase: float, copies: int
    ) -> tuple[Recording, float]:
        """A recording, and when in it the tissue touches the small sensor, in s; ``phase`` in sampling intervals."""
        begin = self.settling + self.lead + phase / sensor.chain.sampling_rate
        time = sensor.chain.times(begin + self.approach.duration)
        plate, small = self.approach.at(time - begin)
        recording = sensor.record(time, plate, small, noise=noise, generator=generator, copies=copies)
        return recording, begin + self.approach.touch

    def _report(
        self, sensor: ThresholdSensor, recording: Recording, low_pass: LowPass | None, trigger: ThresholdTrigger, touch: float
    ) -> Threshold:
        state, time = self.captured(sensor, recording, low_pass, trigger)
        return reported_threshold(state, time, area=self.area, touch=touch)

    def captured(
        self, sensor: ThresholdSensor, recording: Recording, low_pass: LowPass | None, trigger: ThresholdTrigger
    ) -> tuple[TriggerState, Array]:
        """What the trigger, once armed, makes of a recording, and the times (n,) in s of the samples it saw."""
        armed = slice(int(np.ceil(self.settling * sensor.chain.sampling_rate)), None)
        large, small = (values[armed] for values in sensor.readings(recording, low_pass))
        return trigger.captured(large, small, np.any(recording.saturated[armed], axis=1)), recording.time[armed]
