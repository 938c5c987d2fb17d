"""Forces on a sensor over time: a chirp, a square wave, pieces one after the other, or a measured record."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
import scipy
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.identification.columns import of_file, read_columns
from tactsim.mechanics.paths.loading import ForceLoading, Sine
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.sensors.films.film import HOLM
from tactsim.sensors.films.force_history import checked_forces, checked_times
from tactsim.units import Force, Frequency, NonNegative, Positive, Time, format_quantity


class Wave(FrozenModel):
    """A force between two bounds."""

    low: NonNegative[Force]
    """Smallest force."""
    high: NonNegative[Force]
    """Largest force."""
    duration: Positive[Time]
    """Length."""

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        if self.low >= self.high:
            low, high = format_quantity(self.low, "N"), format_quantity(self.high, "N")
            raise ValueError(f"low {low} must be below high {high}")
        return self

    def sampled(self, time: Array) -> Array:
        """Force in N at times in s, of their shape."""
        return self.low + (self.high - self.low) * self.share(time)

    @property
    @abstractmethod
    def highest_frequency(self) -> float:
        """In Hz."""

    @abstractmethod
    def share(self, time: Array) -> Array:
        """Part of the way from the smallest to the largest force, between 0 and 1, of the shape of the times."""


class Chirp(Wave):
    """A sine whose frequency rises linearly, from the smallest force on.

    Source: thesis, 3.1.2 and Fig. 3.5a: 0.1 to 2.6 N, 0.2 to 2 Hz; the duration is not printed.
    """

    kind: Literal["chirp"]
    low: NonNegative[Force] = 0.1
    """Smallest force."""
    high: NonNegative[Force] = 2.6
    """Largest force."""
    start_frequency: Positive[Frequency] = 0.2
    """Frequency at the beginning."""
    end_frequency: Positive[Frequency] = 2.0
    """Frequency at the end."""
    duration: Positive[Time] = 20.0
    """Length."""

    @property
    def highest_frequency(self) -> float:
        """In Hz."""
        return max(self.start_frequency, self.end_frequency)

    def share(self, time: Array) -> Array:
        """Half of one plus the chirp, which begins at minus one, at times in s, of their shape."""
        return (1 + scipy.signal.chirp(time, self.start_frequency, self.duration, self.end_frequency, phi=180)) / 2


class Square(Wave):
    """Jumps between two forces; with an increment the upper one climbs from the lower one, period by period.

    Source: thesis, 3.1.2 and Fig. 3.5b: 0.1 to 2.5 N "with 0.1 N interval" at 1 Hz; the duration is not printed.
    """

    kind: Literal["square"]
    low: NonNegative[Force] = 0.1
    """Smallest force."""
    high: NonNegative[Force] = 2.5
    """Largest force."""
    frequency: Positive[Frequency] = 1.0
    """Frequency."""
    increment: Positive[Force] | None = None
    """Growth of the upper force with each period; null jumps between the bounds at once."""
    duration: Positive[Time] = 24.0
    """Length."""

    @property
    def highest_frequency(self) -> float:
        """In Hz, that of the fundamental."""
        return self.frequency

    def share(self, time: Array) -> Array:
        """Zero in the first half of a period, then one or what the increments have reached, at times in s, of their shape."""
        phase = self.frequency * np.asarray(time) * (1 + 1e-12)
        up = (1 - scipy.signal.square(2 * np.pi * phase)) / 2
        if self.increment is None:
            return up
        return up * np.minimum(1.0, (np.floor(phase) + 1) * self.increment / (self.high - self.low))


class Pieces(FrozenModel):
    """Jumps, ramps, holds, sines and samples one after the other."""

    kind: Literal["pieces"]
    loading: ForceLoading
    """The pieces."""

    @property
    def highest_frequency(self) -> float:
        """Of the sines in Hz, 0 without one."""
        return max((piece.frequency for piece in self.loading.pieces if isinstance(piece, Sine)), default=0.0)

    @property
    def duration(self) -> float:
        """Length in s."""
        return self.loading.duration

    def sampled(self, time: Array) -> Array:
        """Force in N at times in s, of their shape, within the bounds of the pieces: round-off takes none below zero."""
        least, most = self.loading.least_and_most()
        return np.clip(self.loading.history().value(np.asarray(time)), min(least, 0.0), most)


class Record(FrozenModel):
    """A measured or computed force, linear between its samples; times count from the first one."""

    kind: Literal["file"]
    path: InputPath
    """CSV file, beside the case or in the working folder, with the columns ``time [s], force [N]``."""
    highest_frequency: ClassVar[float] = 0.0

    @property
    def duration(self) -> float:
        """Length in s."""
        return float(self._columns[0][-1])

    def sampled(self, time: Array) -> Array:
        """Force in N at times in s, of their shape."""
        return np.interp(time, *self._columns)

    @cached_property
    def _columns(self) -> tuple[Array, Array]:
        columns = read_columns(self.path, {"time": "s", "force": "N"}, complete=True)
        with of_file(self.path):
            times = checked_times(columns["time"])
            return times - times[0], checked_forces(columns["force"], len(times), HOLM)


AnyForceSignal = Annotated[Chirp | Square | Pieces | Record, Field(discriminator="kind")]
