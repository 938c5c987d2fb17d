"""A stored force as a sensor reads it: film, electronics and calibration, with the noise of the sample's own seed."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.sensors.calibration import LinearCalibration
from tactsim.sensors.film import Film
from tactsim.sensors.film_calibration import film_line
from tactsim.sensors.low_pass import LowPass
from tactsim.sensors.signal_chain import SignalChain
from tactsim.units import Force, FrozenModel

Array = np.ndarray


class ForceReading(FrozenModel):
    """A sensor under the whole force of a history.

    Source: thesis, chapter 2 and section 3.1.2; electronics as in `MatrixReadout`.
    """

    film: Film = Film()
    """What turns force into conductance."""
    chain: SignalChain = SignalChain(sampling_rate=200.0, low_pass=LowPass(cutoff=40.0))
    """Electronics."""
    calibration: LinearCalibration | None = None
    """From conductance to force; null is the line through the film's own conductances at the ``calibration_forces``."""
    calibration_forces: tuple[Annotated[Force, Field(ge=0)], Annotated[Force, Field(gt=0)]] = (0.0, 2.0)
    """Range of the constant forces of that calibration, read after 1 s."""

    def read(self, time: Array, force: Array, at: Array, generator: np.random.Generator) -> dict[str, Array]:
        """``voltage`` in V after the low pass and ``read_force`` in N at the times ``at`` in s.

        Forces (n,) in N at times (n,) in s are linear between these; a sensor cannot be pulled, so pulls read as no force.
        """
        line = self.calibration or _line(self.film, self.calibration_forces)
        times, applied = self.chain.sampled(time, np.maximum(force, 0.0))
        recording = self.chain.acquire(self.film.conductance(times, applied), generator)
        conductance = self.chain.conductance(np.clip(recording.filtered, 0.0, np.nextafter(self.chain.supply, 0)))
        sample = latest(times, at)
        return {"voltage": recording.filtered[sample], "read_force": line.force(conductance)[sample]}


@lru_cache(maxsize=16)
def _line(film: Film, forces: tuple[float, float]) -> LinearCalibration:
    """The calibration of a film, which all samples share."""
    return film_line(film, forces)


def latest(times: Array, at: Array) -> Array:
    """Index of the last of increasing ``times`` in s that is not after each time in ``at``."""
    return np.clip(np.searchsorted(times, at * (1 + 1e-12), side="right") - 1, 0, len(times) - 1)
