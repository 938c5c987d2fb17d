"""When the small sensor is touched, the reading of the large one is captured: the threshold force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Force, Positive

UNTRIGGERED = -1
"""Index of a recording in which the small sensor never exceeded its level."""


class TriggerLevel(FrozenModel):
    """How large the small sensor's reading must be above its rest value to count as a touch."""

    multiple: Annotated[float, Field(gt=0, le=1e3)] = 6.0
    """Level as so many times the standard deviation of the small sensor's filtered reading at rest."""
    force: Positive[Force] | None = None
    """A fixed level, which replaces the multiple."""

    def above_rest(self, rest: Array, step: float) -> tuple[Array, Array]:
        """Rest value and level in N, from filtered readings ``rest`` in N, shape (time, ...); both of shape (...).

        The level of a multiple is never below ``step`` in N, the least force that the converter resolves.

        Raises
        ------
        InvalidQuantity
            If the recording is empty or not finite, or the step is not positive.
        """
        readings = np.asarray(rest, dtype=float)
        if readings.ndim == 0 or len(readings) == 0 or not np.isfinite(readings).all():
            raise InvalidQuantity("the recording at rest is empty or not finite; allowed: at least one finite reading in N")
        if not (math.isfinite(step) and step > 0):
            raise InvalidQuantity(f"the converter's step is {step:g} N; allowed: above 0")
        value = readings.mean(axis=0)
        if self.force is not None:
            return value, np.full_like(value, self.force)
        return value, np.maximum(self.multiple * readings.std(axis=0), step)


@dataclass(frozen=True)
class TriggerState:
    """What a trigger remembers between two blocks of samples; every array has the shape of the channels."""

    seen: int
    """Samples that have passed."""
    index: Array
    """Sample at which the level was exceeded, counted from the first; ``UNTRIGGERED`` before."""
    force: Array
    """Captured reading of the large sensor in N; 0 before."""
    saturated: Array
    """Whether a converter was at its end in any sample up to the captured one."""

    @property
    def triggered(self) -> Array:
        """Whether the level has been exceeded, of the shape of the channels."""
        return self.index != UNTRIGGERED


@dataclass(frozen=True)
class ThresholdTrigger:
    """Captures the large sensor's reading in the first sample in which the small one's exceeds ``rest + level``.

    Parameters
    ----------
    rest, level : array_like
        Value at rest and level above it in N, ``level > 0``; they broadcast to the shape of the channels.

    Raises
    ------
    InvalidQuantity
        If a level is not positive or a number is not finite.

    Source: thesis, 3.1.2: "at the instant when the smaller sensor is activated", the output of the larger one is recorded.
    """

    rest: Array
    level: Array

    def __post_init__(self) -> None:
        rest, level = np.asarray(self.rest, dtype=float), np.asarray(self.level, dtype=float)
        if not (np.isfinite(rest).all() and np.isfinite(level).all() and (level > 0).all()):
            raise InvalidQuantity(f"trigger level {level} N above a rest value of {rest} N; allowed: finite, level above 0")
        object.__setattr__(self, "rest", rest)
        object.__setattr__(self, "level", level)

    def start(self, shape: tuple[int, ...] = ()) -> TriggerState:
        """The state before the first sample of channels of this shape."""
        return TriggerState(0, np.full(shape, UNTRIGGERED), np.zeros(shape), np.zeros(shape, bool))

    def advanced(self, state: TriggerState, large: Array, small: Array, saturated: Array | None = None) -> TriggerState:
        """The state after a block of filtered readings in N, shape (time, ...); ``saturated`` flags samples, same shape.

        Raises
        ------
        InvalidQuantity
            If shapes differ or a reading is not finite.
        """
        large, small = np.asarray(large, dtype=float), np.asarray(small, dtype=float)
        flags = np.zeros(small.shape, bool) if saturated is None else np.asarray(saturated, dtype=bool)
        if large.shape != small.shape or flags.shape != small.shape or small.shape[1:] != state.index.shape:
            shapes = f"large {large.shape}, small {small.shape}, flags {flags.shape}"
            raise InvalidQuantity(f"readings have the shapes {shapes}; allowed: all (time, *{state.index.shape})")
        if not (np.isfinite(large).all() and np.isfinite(small).all()):
            raise InvalidQuantity("readings hold NaN or infinity; allowed: finite forces in N")
        if len(small) == 0:
            return state
        beyond = small > self.rest + self.level
        first = beyond.argmax(axis=0)
        fires = ~state.triggered & beyond.any(axis=0)
        captured = np.take_along_axis(large, first[None], axis=0)[0]
        last = np.where(fires, first, len(small) - 1)
        met = np.take_along_axis(np.logical_or.accumulate(flags, axis=0), last[None], axis=0)[0]
        return TriggerState(
            state.seen + len(small),
            np.where(fires, state.seen + first, state.index),
            np.where(fires, captured, state.force),
            state.saturated | (~state.triggered & met),
        )

    def captured(self, large: Array, small: Array, saturated: Array | None = None) -> TriggerState:
        """The state after a whole recording, shape (time, ...): what blocks of any length come to.

        Raises
        ------
        InvalidQuantity
            If shapes differ or a reading is not finite.
        """
        return self.advanced(self.start(np.shape(small)[1:]), large, small, saturated)


@dataclass(frozen=True)
class Threshold:
    """Thresholds reported by a trigger, each array of the shape of the channels."""

    index: Array
    """Sample, ``UNTRIGGERED`` if none."""
    time: Array
    """In s; the end of the recording where nothing was captured."""
    force: Array
    """In N; 0 where nothing was captured."""
    pressure: Array
    """Force over the annular area in Pa."""
    triggered: Array
    """Whether a threshold was captured."""
    false: Array
    """Whether it was captured before the tissue touched the small sensor."""
    saturated: Array
    """Whether a converter was at its end before."""

    @property
    def valid(self) -> Array:
        """Whether a threshold was captured after the touch and without saturation, of the shape of the channels."""
        return self.triggered & ~self.false & ~self.saturated


def reported_threshold(state: TriggerState, times: Array, *, area: float, touch: float | Array) -> Threshold:
    """What the sensor reports, from a state at the end of a recording sampled at ``times`` (n,) in s.

    Parameters
    ----------
    area
        Annular area in m^2.
    touch
        Time in s at which the tissue really touches the small sensor, one or of the channels' shape; infinite if it never does.

    Raises
    ------
    InvalidQuantity
        If the times are not those of the samples, do not increase, or the area is not positive.
    """
    times = np.asarray(times, dtype=float)
    if times.shape != (state.seen,) or state.seen == 0:
        raise InvalidQuantity(f"{times.size} times for {state.seen} samples; allowed: one for each, at least one")
    if not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise InvalidQuantity("the times of the samples must be finite and increase")
    if not (math.isfinite(area) and area > 0):
        raise InvalidQuantity(f"annular area {area:g} m^2; allowed: above 0")
    time = times[state.index]
    return Threshold(
        index=state.index,
        time=time,
        force=state.force,
        pressure=state.force / area,
        triggered=state.triggered,
        false=state.triggered & (time < touch),
        saturated=state.saturated,
    )
