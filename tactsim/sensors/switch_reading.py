"""The sensing algorithm of chapter 5 on sampled signals: touch, switches closing while it loads, release."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.sensors.switch_array import SwitchArray, rising


@dataclass(frozen=True)
class Closing:
    """A switch (1 is the nearest to the face) found closed at a ``time`` in s, with the ``force`` in N on the force sensor."""

    switch: int
    time: float
    force: float


@dataclass(frozen=True)
class Touch:
    """One touch: its first sample at ``start`` in s, what closed in it, its release at ``end`` or None if it goes on."""

    start: float
    closings: tuple[Closing, ...] = ()
    end: float | None = None

    def times(self) -> Array:
        """Times (n,) in s since the touch began, T_i, in the order of closing."""
        return np.array([closing.time for closing in self.closings]) - self.start

    def intervals(self) -> Array:
        """Intervals (n,) in s, T_i - T_{i-1} with T_0 the beginning of the touch (eq. 5.2.1)."""
        return np.diff(self.times(), prepend=0.0)

    def complete(self, array: SwitchArray) -> bool:
        """Whether every switch closed, in the order of their heights."""
        return [closing.switch for closing in self.closings] == list(range(1, array.count + 1))

    def mean_rate(self, array: SwitchArray) -> float | None:
        """Mean rate in m/s; None if a switch did not close or they closed out of order."""
        if not self.complete(array):
            return None
        return array.mean_rate(self.start, np.array([closing.time for closing in self.closings]))


@dataclass(frozen=True)
class SwitchState:
    """What the algorithm carries from one block of samples to the next: ``largest`` force in N of the touch that goes on,
    ``register`` (count,) the last sample of the switches, infinite before the first."""

    touch: Touch | None = None
    largest: float = 0.0
    register: Array | None = None
    time: float = -np.inf


@dataclass(frozen=True)
class SwitchReading:
    """Touches that ended in a block of samples, and the state after it."""

    ended: tuple[Touch, ...]
    state: SwitchState = field(repr=False)

    @property
    def touches(self) -> tuple[Touch, ...]:
        """The ended touches and the one that goes on, if any."""
        return self.ended if self.state.touch is None else (*self.ended, self.state.touch)


def read_switches(
    array: SwitchArray, time: Array, force: Array, switches: Array, *, state: SwitchState | None = None
) -> SwitchReading:
    """Touches in the samples ``time`` (n,) in s, ``force`` (n,) and ``switches`` (n, count) in N; goes on from ``state``.

    A touch begins above the touch threshold and ends at the release. Within it a switch is recorded by the shift-register rule,
    once, and only while the touch loads: the force has not fallen by more than ``fall`` below its largest of the touch. The rule
    alone cannot detect unloading in noise, where half of the samples rise above the one before; the fall can, once it is
    reached.

    Raises
    ------
    InvalidQuantity
        If shapes differ, a value is not finite or the times do not increase, also from the last block on.
    """
    now = state or SwitchState()
    _check(array, time, force, switches, now.time)
    if not len(time):
        return SwitchReading((), now)
    register = np.full(array.count, np.inf) if now.register is None else now.register
    candidates = rising(switches, array.switch_threshold, register)
    rows = np.asarray(candidates.any(axis=1))
    ended: list[Touch] = []
    touch, largest = now.touch, now.largest
    for k, (instant, pressed, taken) in enumerate(zip(time.tolist(), force.tolist(), rows.tolist(), strict=True)):
        if touch is None and pressed > array.touch_threshold:
            touch, largest = Touch(instant), pressed
        elif touch is not None and pressed <= array.release:
            ended.append(replace(touch, end=instant))
            touch = None
        if touch is None:
            continue
        largest = max(largest, pressed)
        if taken and pressed >= largest - array.fall:
            touch = _recorded(touch, candidates[k], instant, pressed)
    return SwitchReading(tuple(ended), SwitchState(touch, largest, switches[-1].copy(), float(time[-1])))


def _recorded(touch: Touch, candidates: Array, time: float, force: float) -> Touch:
    """The touch with the switches that close for the first time in it."""
    known = {closing.switch for closing in touch.closings}
    new = [Closing(switch, time, force) for switch in (np.flatnonzero(candidates) + 1).tolist() if switch not in known]
    return replace(touch, closings=(*touch.closings, *new)) if new else touch


def _check(array: SwitchArray, time: Array, force: Array, switches: Array, last: float) -> None:
    count = len(time)
    if time.shape != (count,) or force.shape != (count,) or switches.shape != (count, array.count):
        raise InvalidQuantity(
            f"time {time.shape}, force {force.shape} and switches {switches.shape}; allowed: (n,), (n,) and (n, {array.count})"
        )
    for name, values in (("time", time), ("force", force), ("switches", switches)):
        if not np.isfinite(values).all():
            bad = int(np.flatnonzero(~np.isfinite(values).reshape(count, -1).all(axis=1))[0])
            raise InvalidQuantity(f"{name} of sample {bad} is not finite; allowed: finite numbers")
    steps = np.diff(time, prepend=last)
    if not (steps > 0).all():
        bad = int(np.flatnonzero(~(steps > 0))[0])
        raise InvalidQuantity(f"time of sample {bad} is {time[bad]:g} s, not after the sample before; allowed: increasing times")
