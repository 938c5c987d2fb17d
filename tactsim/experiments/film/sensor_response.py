"""A piezoresistive sensor under a force over time: film, electronics, calibration, and the way back through the film's model."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.experiments.film.force_signal import AnyForceSignal, Square
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course, Findings
from tactsim.model import check_increasing
from tactsim.results.quantity import Quantity
from tactsim.results.result import rows
from tactsim.sensors.electronics.calibration import THESIS_LINE, AnyCalibration
from tactsim.sensors.electronics.signal_chain import Recording, SignalChain
from tactsim.sensors.films.any_film import ConductingFilm
from tactsim.sensors.films.film import Film
from tactsim.sensors.response_errors import hysteresis, range_errors, root_mean_square
from tactsim.units import Force, NonNegative, format_quantity

MOST_SAMPLES = 100_000
"""Longest recording, in samples: the inverse of the film takes about a minute for it."""


class SensorResponse(Experiment):
    """What a sensor reads of a force, and how far that is from the force.

    Source: thesis, section 3.1.2 and Fig. 3.5.
    """

    kind: Literal["sensor_response"] = "sensor_response"
    force: AnyForceSignal
    """The force on the sensor."""
    film: ConductingFilm = Film()
    """What turns force into conductance."""
    chain: SignalChain = SignalChain()
    """What turns conductance into samples."""
    calibration: AnyCalibration = THESIS_LINE
    """What turns conductance back into force; by default F = 20.94 C - 0.132."""
    ranges: Annotated[tuple[NonNegative[Force], ...], Field(min_length=2)] = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 25.0)
    """Borders of the ranges of force for which the error is reported, increasing."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    history_units: ClassVar[dict[str, str]] = {
        "time": "s",
        "force": "N",
        "conductance": "S",
        "voltage": "V",
        "filtered_voltage": "V",
        "read_force": "N",
        "unfiltered_force": "N",
        "model_force": "N",
        "saturated": "1",
    }

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        check_increasing(ranges=self.ranges)
        return self

    @classmethod
    def example(cls) -> Self:
        """Two periods of the square wave of Fig. 3.5b."""
        return cls(force=Square(kind="square", duration=2.0), chain=SignalChain(sampling_rate=200.0))

    def begin(self) -> Course:
        """One step for every sample.

        Raises
        ------
        InvalidQuantity
            If there are too many samples, or the force changes too fast for them.
        """
        times = self._times()
        force = self.force.sampled(times)
        conductance = self.film.read(times, force)
        recording = self.chain.acquire(conductance, np.random.default_rng(self.seed))
        read, raw = (self._linear(voltage) for voltage in (recording.filtered, recording.voltage))
        model = self._modelled(times, recording)
        columns = (times, force, conductance, recording.voltage, recording.filtered, read, raw, model, recording.saturated)
        return Course.computed(
            Findings(
                "end of the record",
                rows(self.history_units, columns),
                quantities=self._quantities(force, conductance, recording, {"read": read, "raw": raw, "model": model}),
                assumptions=(*self.film.assumptions(), "one straight line as calibration, without regard to history"),
                warnings=self._warnings(force, recording),
            )
        )

    def _times(self) -> Array:
        """Sampling times in s.

        Raises
        ------
        InvalidQuantity
            If there are too many, or the force changes too fast for them.
        """
        rate, duration = self.chain.sampling_rate, self.force.duration
        if duration * rate > MOST_SAMPLES:
            raise InvalidQuantity(
                f"force: {duration:.3g} s at a sampling_rate of {format_quantity(rate, 'Hz')} are {duration * rate:.3g} samples; "
                f"allowed: up to {MOST_SAMPLES}; take a shorter force or sample more slowly"
            )
        if self.force.highest_frequency > rate / 2:
            fastest, given = (format_quantity(value, "Hz") for value in (self.force.highest_frequency, rate))
            raise InvalidQuantity(
                f"force: its frequency of {fastest} is above half the sampling_rate of {given}, so that samples would show "
                "another force; lower it or sample faster"
            )
        return self.chain.times(duration)

    def _linear(self, voltage: Array) -> Array:
        """Force in N by the straight line; a saturated voltage at the supply reads as the last one below it."""
        return self.calibration.force(self.chain.read_conductance(voltage))

    def _modelled(self, times: Array, recording: Recording) -> Array:
        """Force in N by the inverse of the film's model from unfiltered samples, up to the first saturated one."""
        good = int(np.argmax(recording.saturated)) if recording.saturated.any() else len(times)
        conductance = self.chain.conductance(np.maximum(recording.voltage[:good], 0.0))
        force = np.zeros(len(times))
        if good:
            force[:good] = self.film.force(times[:good], conductance)
            force[good:] = force[good - 1]
        return force

    def _inversion(self, times: Array, force: Array, conductance: Array, error: Array, good: Array) -> float | None:
        """Largest error of the model's force, in steps of the converter at that force, among ``good`` samples; None if none."""
        step = self.chain.conductance_step(conductance) / self.film.sensitivity(times, force)
        loaded = good & (force > 0)
        return float((np.abs(error)[loaded] / step[loaded]).max()) if loaded.any() else None

    def _quantities(
        self, force: Array, conductance: Array, recording: Recording, readings: dict[str, Array]
    ) -> dict[str, Quantity]:
        read, raw, model = readings["read"], readings["raw"], readings["model"]
        good = ~np.logical_or.accumulate(recording.saturated)
        inversion = self._inversion(recording.time, force, conductance, model - force, good)
        quantities = {
            "rms_error": Quantity(root_mean_square(read - force), "N", "root mean square of read minus applied force, filtered"),
            "rms_error_unfiltered": Quantity(root_mean_square(raw - force), "N", "the same without the low pass"),
            "largest_error": Quantity(float(np.abs(read - force).max()), "N", "largest difference of read and applied force"),
            "hysteresis": Quantity(
                hysteresis(force, raw) / float(force.max() or 1.0), "1", "widest loop of the unfiltered reading over the force"
            ),
            "saturated_fraction": Quantity(float(recording.saturated.mean()), "1", "samples outside the range of the converter"),
        }
        if inversion is not None:
            words = "largest error of the force computed by the inverse of the film, in steps of the converter there"
            quantities["inversion_steps"] = Quantity(inversion, "1", f"{words}; up to the first saturated sample")
        return quantities | self._by_range(force, raw, model, good)

    def _by_range(self, force: Array, raw: Array, model: Array, good: Array) -> dict[str, Quantity]:
        """Errors by range of force; those of the inverse from the ``good`` samples, before the first saturated one."""
        quantities = {"ranges": Quantity(list(self.ranges), "N", "borders of the ranges of force [border]")}
        every = np.ones(len(force), bool)
        for name, reading, how, chosen in (
            ("model", model, "inverse of the film", good),
            ("linear", raw, "straight line", every),
        ):
            errors = range_errors(force[chosen], reading[chosen], self.ranges)
            where = f"by the {how} without low pass [range of force]" + ("" if chosen is every else "; to saturation")
            quantities[f"{name}_range_rms_error"] = Quantity([r.rms for r in errors], "N", f"root mean square error {where}")
            quantities[f"{name}_range_largest_error"] = Quantity([r.largest for r in errors], "N", f"largest error {where}")
        quantities["range_samples"] = Quantity([r.samples for r in errors], "1", "samples [range of force]")
        return quantities

    def _warnings(self, force: Array, recording: Recording) -> tuple[str, ...]:
        warnings = list(self.film.warnings(float(force.max())))
        if recording.saturated.any():
            first = format_quantity(float(recording.time[recording.saturated][0]), "s")
            warnings.append(
                f"{int(recording.saturated.sum())} samples are outside the range of the converter, first at {first}; "
                "they are flagged in history.csv, and the inverse of the film ends there"
            )
        return tuple(warnings)
