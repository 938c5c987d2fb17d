"""Following a path: steps that grow and shrink, events located, and giving up with the history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from tactsim.errors import ConvergenceError
from tactsim.fem.paths.loading import Event, PathFollower, StepControl

CONTROL = StepControl(first=0.1, largest=0.4, smallest=0.01)


@dataclass(frozen=True)
class Point:
    """A scalar state."""

    load: float
    unknowns: np.ndarray
    iterations: int


class Scalar:
    """x^3 = load as a problem of one unknown; fails for steps above ``reach`` and beyond ``end``."""

    def __init__(self, reach: float = np.inf, end: float = np.inf, iterations: int = 3):
        self.reach, self.end, self.iterations = reach, end, iterations
        self.guesses: list[tuple[float, float]] = []

    def __call__(self, state: Point, load: float, guess: np.ndarray) -> Point:
        self.guesses.append((load, float(guess[0])))
        if load - state.load > self.reach or load > self.end:
            raise ConvergenceError("the step is too long", [1.0, 0.5])
        return Point(load, np.array([np.cbrt(load)]), self.iterations)


START = Point(0.0, np.zeros(1), 0)


def loads(follower: PathFollower, target: float, event: Event | None = None) -> list[float]:
    return [state.load for state, _ in follower.follow(START, target, event)]


def test_steps_grow_to_the_largest_and_end_at_the_target():
    reached = loads(PathFollower(Scalar(), CONTROL), 1.5)
    steps = np.diff([0.0, *reached])
    assert steps[:4] == pytest.approx([0.1, 0.16, 0.256, 0.4])
    assert steps.max() <= 0.4 * (1 + 1e-12)
    assert reached[-1] == 1.5


def test_many_iterations_shrink_the_step_and_a_middling_number_keeps_it():
    assert CONTROL.next_step(0.1, 7) == pytest.approx(0.16)
    assert CONTROL.next_step(0.3, 7) == 0.4
    assert CONTROL.next_step(0.1, 8) == CONTROL.next_step(0.1, 12) == 0.1
    assert CONTROL.next_step(0.1, 13) == pytest.approx(0.07)
    hard = loads(PathFollower(Scalar(iterations=20), CONTROL), 0.3)
    assert np.diff(np.diff([0.0, *hard[:-1]])).max() < 0


def test_a_failed_step_is_cut_and_counted_and_the_path_goes_on():
    follower = PathFollower(Scalar(reach=0.2), CONTROL)
    reached = loads(follower, 1.0)
    assert reached[-1] == 1.0
    assert follower.rejected > 0
    assert np.diff([0.0, *reached]).max() <= 0.2


def test_giving_up_reports_how_far_it_came_and_keeps_the_history():
    follower, accepted = PathFollower(Scalar(end=0.5), CONTROL), []

    def follow():
        for state, _ in follower.follow(START, 1.0):
            accepted.append(state.load)

    with pytest.raises(ConvergenceError, match=r"gave up at 0\.[45]\d* of 1: the step is too long") as caught:
        follow()
    assert caught.value.history == (1.0, 0.5)
    assert 0.5 - 2 * CONTROL.smallest < accepted[-1] <= 0.5


def test_an_event_is_located_within_its_tolerance_and_ends_the_path():
    event = Event(lambda state: float(state.unknowns[0]) - 0.9, 1e-6)
    *before, (last, is_event) = PathFollower(Scalar(), CONTROL).follow(START, 2.0, event)
    assert is_event
    assert not any(flag for _, flag in before)
    assert abs(last.load - 0.9**3) <= 1e-6
    assert last.unknowns[0] == np.cbrt(last.load)  # an equilibrium of its own, not an interpolation
    with pytest.raises(AssertionError):
        assert abs(last.load + 3e-6 - 0.9**3) <= 1e-6


@pytest.mark.parametrize("place", [0.1, 0.26, 2.0])
def test_an_event_at_an_accepted_load_or_at_the_target_is_found(place):
    event = Event(lambda state: state.load - place, 1e-9)
    *_, (last, is_event) = PathFollower(Scalar(), CONTROL).follow(START, 2.0, event)
    assert is_event
    assert last.load == pytest.approx(place, abs=1e-9)


def test_an_event_that_never_comes_lets_the_path_reach_its_target():
    *_, (last, is_event) = PathFollower(Scalar(), CONTROL).follow(START, 1.0, Event(lambda state: -1.0, 1e-6))
    assert (last.load, is_event) == (1.0, False)


def test_the_guess_extrapolates_the_last_step():
    scalar = Scalar()
    loads(PathFollower(scalar, CONTROL), 0.516)
    (first, flat), (second, extrapolated), (third, further) = scalar.guesses[:3]
    assert (first, flat) == (0.1, 0.0)  # the first step has nothing to extrapolate
    assert extrapolated == pytest.approx(np.cbrt(0.1) * second / first)
    slope = (np.cbrt(second) - np.cbrt(first)) / (second - first)
    assert further == pytest.approx(np.cbrt(second) + slope * (third - second))


def test_a_start_at_the_target_takes_no_step():
    assert loads(PathFollower(Scalar(), CONTROL), 0.0) == []
