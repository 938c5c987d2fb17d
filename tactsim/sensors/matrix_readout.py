"""From the forces of all taxels to voltages and read forces: film, electronics and calibration of every channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import SensorFilm
from tactsim.sensors.electronics.calibration import LinearCalibration
from tactsim.sensors.electronics.channel_scatter import ChannelScatter
from tactsim.sensors.electronics.force_electronics import ForceElectronics
from tactsim.units import NonNegative

MOST_NUMBERS = 2_000_000
"""Samples of all channels together that one reading may hold."""


@dataclass(frozen=True, eq=False)
class MatrixReading:
    """Readings at ``time`` (n,) in s; arrays of shape (n, *channels)."""

    time: Array
    applied: Array
    """Force in N, linear between the given times, from zero at the beginning, pulls left out."""
    voltage: Array
    """Samples in V, before the low pass."""
    filtered: Array
    """Samples in V after the low pass."""
    force: Array
    """Force in N by the calibration from the filtered samples."""
    saturated: Array
    """Whether a sample lies outside the range of the converter, or its filtered voltage is not below the supply."""
    strongest_pull: float
    """Largest tension in N that was left out; 0 if no taxel was pulled."""
    missed: float = 0.0
    """Largest change of a force in N between the last sample and the last force given."""


class MatrixReadout(ForceElectronics):
    """Sensors of one kind and their electronics; without an active area of its own, the film has that of the taxel.

    Source: thesis, chapter 2 and sections 6.1 to 6.4: 3 x 3 sensors per jaw, low pass of 40 Hz.
    """

    scatter: ChannelScatter | None = ChannelScatter()
    """How channels differ; null makes them equal."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    def line(self, area: float) -> LinearCalibration:
        """The calibration of a taxel of an area in m^2."""
        return self.line_of(self.film_of(area))

    def read(self, time: Array, force: Array, area: float) -> MatrixReading:
        """Readings of forces (n, *channels) in N at times (n,) in s; before the first of them they rise from nothing at 0 s.

        Parameters
        ----------
        time, force : array
            Forces are linear between times. A taxel cannot be pulled: small tensions of a
            numerical contact are set to zero and reported.
        area : float
            Of a taxel in m^2.

        Raises
        ------
        InvalidQuantity
            If times or forces are not usable, or the reading would hold more than two million numbers.
        """
        if not len(time) or time[0] < 0:
            raise InvalidQuantity("forces must begin at 0 s or later, with at least one sample")
        if time[0] > 0:
            time, force = np.concatenate([[0.0], time]), np.concatenate([np.zeros_like(force[:1]), force])
        numbers = (1 + float(time[-1] - time[0]) * self.chain.sampling_rate) * force[0].size
        if numbers > MOST_NUMBERS:
            raise InvalidQuantity(f"a reading of {numbers:.3g} numbers; allowed: {MOST_NUMBERS}; lower sampling_rate")
        gains = 1.0 if self.scatter is None else self.scatter.gains(force.shape[1:], self.line(area))
        sensed = self.sensed(time, force, np.random.default_rng(self.seed), film=self.film_of(area), gains=gains)
        recording = sensed.recording
        return MatrixReading(
            time=sensed.time,
            applied=sensed.applied,
            voltage=recording.voltage,
            filtered=recording.filtered,
            force=sensed.force,
            saturated=recording.saturated | (recording.filtered > self.chain.largest_voltage),
            strongest_pull=float(max(0.0, -force.min(initial=0.0))),
            missed=float(np.abs(np.maximum(force[-1], 0.0) - sensed.applied[-1]).max()),
        )

    def film_of(self, area: float) -> SensorFilm:
        """The film of a taxel of an area in m^2."""
        return self.film if self.film.active_area else self.film.model_copy(update={"active_area": area})
