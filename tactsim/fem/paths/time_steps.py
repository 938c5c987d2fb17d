"""Marching in time with a controlled error: the estimated error of each step decides the length of the next."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Generic, Protocol, TypeVar

from tactsim.array import Array
from tactsim.errors import ConvergenceError, TooShort
from tactsim.fem.paths.event import located
from tactsim.fem.paths.progress import Headway, check_steps
from tactsim.fem.paths.states import PathState, beyond

LENGTHENED = 10.0
"""Factor by which a first step is longer whose load was hidden in round-off; later ones, of loads that go, are shorter then."""


class TimedState(PathState, Protocol):
    """An accepted state at a time."""

    @property
    def time(self) -> float:
        """Time in s."""


State = TypeVar("State", bound=TimedState)


@dataclass(frozen=True)
class TimeControl:
    """How steps, in s, grow and shrink; the error of a step is of second to third order in its length."""

    tolerance: float
    first: float
    smallest: float
    growth: float = 2.0
    shrink: float = 0.2
    safety: float = 0.9
    many_iterations: int = 12

    def accepts(self, error: float) -> bool:
        """Whether a step may stay."""
        return error <= self.tolerance

    def next_step(self, step: float, error: float, iterations: int) -> float:
        """Length in s of the step after one of this length, error and number of iterations."""
        factor = self.safety * (self.tolerance / error) ** (1 / 3) if error > 0 else self.growth
        return step * min(max(factor, self.shrink), 1.0 if iterations > self.many_iterations else self.growth)


@dataclass(frozen=True)
class TimeEvent(Generic[State]):
    """A sign change from negative to positive of ``value``, located to ``tolerance`` of the step it happens in."""

    value: Callable[[State], float]
    tolerance: float = 1e-6


class TimeMarcher(Generic[State]):
    """Advances a state through a smooth span of time; ``rejected`` counts the steps that were rejected.

    Parameters
    ----------
    advance : (state, time, guess) -> the state at ``time``; raises ConvergenceError
    error : (state, next one) -> relative error of the step from one to the other
    control : step lengths
    """

    def __init__(
        self, advance: Callable[[State, float, Array], State], error: Callable[[State, State], float], control: TimeControl
    ):
        self._advance, self._error, self._control = advance, error, control
        self.rejected = 0

    def march(
        self, start: State, stops: Sequence[float], *, largest: float, event: TimeEvent[State] | None = None
    ) -> Iterator[tuple[State, bool]]:
        """Yield every accepted state up to the last of the times ``stops`` in s or the event, with whether it is the event.

        Raises
        ------
        ConvergenceError
            If no step longer than the smallest one is accepted, or no progress is made; the message names the time reached.
        InvalidQuantity
            If there would be too many steps.
        """
        check_steps((stops[-1] - start.time) / largest + len(stops), f"a longest step of {largest:.3g} s")
        now, path, wanted = start, {start.time: start}, min(self._control.first, largest)
        headway = Headway(start.time, stops[-1], "s")
        for number, stop in enumerate(stops):
            while now.time < stop * (1 - 1e-12):
                step = _landing(stop - now.time, min(wanted, largest))
                try:
                    reached = self._advance(now, now.time + step, beyond(path, step))
                    error = self._error(now, reached)
                    if not self._control.accepts(error):
                        raise _TooLong(f"the error {error:.1e} of a step of {step:.3g} s is above {self._control.tolerance:g}")
                    happened = event is not None and event.value(reached) >= 0
                    if event is not None and happened:
                        around, width = {**path, reached.time: reached}, event.tolerance * (reached.time - now.time)
                        reached = located(partial(self._advance, now), event.value, around, width)
                except ConvergenceError as failure:
                    self.rejected += 1
                    if isinstance(failure, TooShort) and now is start:
                        at_stop = step >= stop - now.time  # now.time + step may be less than stop by round-off
                        if step >= largest or (at_stop and stop == stops[-1]):
                            raise ConvergenceError(f"gave up at {now.time:.6g} s: {failure}", failure.history) from failure
                        wanted = LENGTHENED * step
                        if at_stop:
                            break  # no step can end at this stop
                        continue
                    error = error if isinstance(failure, _TooLong) else 4 * self._control.tolerance
                    wanted = self._control.next_step(step, error, 0)
                    if wanted < self._control.smallest:
                        raise ConvergenceError(f"gave up at {now.time:.6g} s: {failure}", failure.history) from failure
                    spent = failure.solutions if not isinstance(failure, _TooLong) else reached.iterations
                    headway.spent(spent, now.time, len(stops) - number + (stops[-1] - now.time) / largest, failure)
                    continue
                longer = self._control.next_step(step, error, reached.iterations)
                wanted = longer if step >= wanted else max(wanted, longer)
                path, now = {now.time: now, reached.time: reached}, reached
                yield now, happened
                if happened:
                    return
                headway.spent(now.iterations, now.time, len(stops) - number + (stops[-1] - now.time) / largest)


class _TooLong(ConvergenceError):
    """A step whose error is above the tolerance."""


def _landing(remaining: float, step: float) -> float:
    """The step, or one that lands on the end of what remains without a sliver before it."""
    if step >= remaining * (1 - 1e-9):
        return remaining
    return remaining / 2 if step > remaining / 2 else step
