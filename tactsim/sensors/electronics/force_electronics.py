"""A sensor with its electronics, from force to voltage and back to the force that it reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import numpy as np
from pydantic import model_validator

from tactsim.array import Array
from tactsim.interfaces import SensorFilm
from tactsim.model import FrozenModel, check_increasing
from tactsim.sensors.electronics.calibration import AnyCalibration, LinearCalibration
from tactsim.sensors.electronics.film_calibration import film_line
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import Recording, SignalChain
from tactsim.sensors.films.any_film import ConductingFilm
from tactsim.sensors.films.film import Film
from tactsim.units import Force, NonNegative, Positive


@dataclass(frozen=True, eq=False)
class Sensed:
    """Samples at ``time`` (n,) in s: ``applied`` and read ``force`` (n, ...) in N, and what the chain delivered."""

    time: Array
    applied: Array
    recording: Recording
    force: Array


class ForceElectronics(FrozenModel):
    """Sensors of one kind and their electronics.

    Source: thesis, chapter 2 and sections 3.1.2 and 6.1 to 6.4: low pass of 40 Hz.
    """

    film: ConductingFilm = Film()
    """What turns force into conductance."""
    chain: SignalChain = SignalChain(sampling_rate=200.0, low_pass=LowPass(cutoff=40.0))
    """Electronics of each channel."""
    calibration: AnyCalibration | None = None
    """From conductance to force; null is the least-squares line of the film's own conductances over ``calibration_forces``."""
    calibration_forces: tuple[NonNegative[Force], Positive[Force]] = (0.0, 2.0)
    """Range of the constant forces of that calibration, evenly spaced and each read after 1 s."""

    @model_validator(mode="after")
    def _rising(self) -> Self:
        check_increasing(calibration_forces=self.calibration_forces)
        return self

    @property
    def quiet(self) -> Self:
        """The same without noise."""
        return self.model_copy(update={"chain": self.chain.model_copy(update={"noise": Noise()})})

    def line_of(self, film: SensorFilm) -> LinearCalibration:
        """The calibration of sensors with this film."""
        return self.calibration or _own_line(film, self.calibration_forces)

    def sensed(
        self,
        time: Array,
        force: Array,
        generator: np.random.Generator,
        *,
        film: SensorFilm | None = None,
        gains: Array | float = 1.0,
    ) -> Sensed:
        """What sensors make of forces (n, ...) in N, linear between times (n,) in s; pulls read as no force.

        ``film`` replaces that of the model, ``gains`` are factors on the conductance of each channel.
        """
        film = film or self.film
        times, applied = self.chain.sampled(time, np.maximum(force, 0.0))
        recording = self.chain.acquire(gains * film.read(times, applied), generator)
        read = self.line_of(film).force(self.chain.read_conductance(recording.filtered))
        return Sensed(times, applied, recording, read)


@lru_cache(maxsize=16)
def _own_line(film: SensorFilm, forces: tuple[float, float]) -> LinearCalibration:
    """The calibration of a film, which all sensors share."""
    return film_line(film, forces)
