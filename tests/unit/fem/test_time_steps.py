"""Steps of time follow their error, land on the stops, find events, and give up with the time they reached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tactsim.errors import ConvergenceError, TooShort
from tactsim.fem.paths.time_steps import TimeControl, TimeEvent, TimeMarcher


@dataclass
class Clock:
    """A state that is its time; ``step`` led to it."""

    time: float
    step: float = 0.0
    iterations: int = 2

    @property
    def unknowns(self):
        return np.array([self.time**2])


def marching(*, tolerance=1e-3, first=1e-3, scale=1.0, fail=lambda time: False):
    def advance(now, time, guess):
        if fail(time):
            raise ConvergenceError("too far")
        return Clock(time, time - now.time)

    control = TimeControl(tolerance, first=first, smallest=1e-6)
    return TimeMarcher(advance, lambda now, state: scale * state.step**3, control)


def test_steps_grow_until_the_error_reaches_its_tolerance():
    states = [state for state, _ in marching().march(Clock(0.0), [5.0], largest=5.0)]
    steps = np.array([state.step for state in states])
    assert states[-1].time == 5.0
    assert (steps[1:8] <= 2 * steps[:7] * (1 + 1e-12)).all()
    assert 0.06 < steps[-5] <= 0.1 * (1 + 1e-9), "the error is the cube of the step and stays below 1e-3"
    finer = [state for state, _ in marching(tolerance=1e-3 / 8).march(Clock(0.0), [5.0], largest=5.0)]
    assert len(finer) == pytest.approx(2 * len(states), rel=0.2)


def test_steps_land_on_every_stop_without_a_sliver():
    stops = [0.01, 0.011, 1.0, 1.0 + 1e-4, 3.0]
    states = [state for state, _ in marching(first=1e-4).march(Clock(0.0), stops, largest=1.0)]
    times = np.array([state.time for state in states])
    assert all(np.isclose(times, stop, rtol=1e-14).any() for stop in stops)
    assert np.diff(times).min() >= 4e-5


def test_an_event_is_located():
    event = TimeEvent(lambda state: state.time - np.sqrt(2))
    *_, (last, happened) = marching().march(Clock(0.0), [5.0], largest=1.0, event=event)
    assert happened
    assert last.time == pytest.approx(np.sqrt(2), rel=1e-6)


def test_a_step_that_never_converges_gives_up_with_its_time():
    marcher = marching(fail=lambda time: time > 1.0)
    with pytest.raises(ConvergenceError, match=r"gave up at (1|0\.9999\d*) s: too far"):
        list(marcher.march(Clock(0.0), [5.0], largest=1.0))
    assert marcher.rejected > 5


def hidden(until, *, error=lambda now, state: state.step**3):
    """Steps whose load cannot be seen before a time."""

    def advance(now, time, guess):
        if time < until:
            raise TooShort("hidden")
        return Clock(time, time - now.time)

    return TimeMarcher(advance, error, TimeControl(1e-3, first=1e-9, smallest=1e-12))


def test_a_step_that_is_too_short_is_lengthened_beyond_stops_that_no_step_can_end_at():
    marcher = hidden(1e-3)
    times = [state.time for state, _ in marcher.march(Clock(0.0), [1e-6, 1e-5, 1e-4, 1e-2, 1.0], largest=1.0)]
    assert 1e-3 <= times[0] <= 1e-2
    assert 1e-2 in times
    assert times[-1] == 1.0
    assert marcher.rejected >= 3


def test_a_stop_that_round_off_does_not_reach_ends_no_search():
    """The search for a step that is long enough would go on for ever there."""
    start, stop = 0.1, next(s for s in np.linspace(0.3, 1.0, 99) if 0.1 + (s - 0.1) < s)
    times = [state.time for state, _ in hidden(1.5, error=lambda now, state: 0.0).march(Clock(start), [stop, 3.0], largest=5.0)]
    assert times[-1] == 3.0


def test_steps_towards_a_load_that_is_hidden_are_shortened():
    """As where a force goes to zero: what can be seen of the way is accepted."""

    def advance(now, time, guess):
        if time > 0.9:
            raise TooShort("hidden")
        return Clock(time, time - now.time)

    marcher = TimeMarcher(advance, lambda now, state: state.step**3, TimeControl(1e-3, first=1e-3, smallest=1e-6))
    accepted = [0.0]
    with pytest.raises(ConvergenceError, match=r"gave up at 0\.\d+ s: hidden"):
        accepted.extend(state.time for state, _ in marcher.march(Clock(0.0), [0.5, 1.0], largest=1.0))
    assert accepted[-1] == pytest.approx(0.9, abs=1e-3)


@pytest.mark.parametrize(("stops", "largest"), [([1.0], 1.0), ([0.5, 1.0], 1e-3)])
def test_a_load_that_the_longest_step_hides_gives_up(stops, largest):
    with pytest.raises(ConvergenceError, match="gave up at 0 s: hidden"):
        list(hidden(2.0).march(Clock(0.0), stops, largest=largest))


def test_an_error_that_never_falls_gives_up():
    marcher = TimeMarcher(
        lambda now, time, guess: Clock(time), lambda now, state: 1.0, TimeControl(1e-3, first=0.1, smallest=1e-4)
    )
    with pytest.raises(ConvergenceError, match="the error"):
        list(marcher.march(Clock(0.0), [5.0], largest=1.0))
