"""Following an equilibrium path: adaptive load steps, prediction, and events located by root finding on the step length."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Generic, Protocol, TypeVar

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.paths.event import located
from tactsim.fem.paths.progress import Headway, check_steps
from tactsim.fem.paths.states import PathState, beyond
from tactsim.units import format_quantity


class LoadedState(PathState, Protocol):
    """An accepted equilibrium at a value of the load parameter."""

    @property
    def load(self) -> float:
        """Load parameter."""


State = TypeVar("State", bound=LoadedState)


@dataclass(frozen=True)
class StepControl:
    """How load steps grow and shrink: all lengths in the unit of the load parameter."""

    first: float
    largest: float
    smallest: float
    growth: float = 1.6
    shrink: float = 0.7
    cut: float = 0.5
    unit: str = ""
    """SI unit of the load parameter, for messages; none of a dimensionless one."""
    few_iterations: int = 7
    many_iterations: int = 12

    def next_step(self, step: float, iterations: int) -> float:
        """Length of the step after one of length ``step`` that took ``iterations`` Newton iterations."""
        if iterations <= self.few_iterations:
            return min(step * self.growth, self.largest)
        return step if iterations <= self.many_iterations else step * self.shrink


@dataclass(frozen=True)
class Event(Generic[State]):
    """A sign change of ``value`` from negative to positive along the path, located to ``tolerance`` in the load parameter."""

    value: Callable[[State], float]
    tolerance: float


class PathFollower(Generic[State]):
    """Advances a state by accepted load steps; ``rejected`` counts the steps that were cut back.

    Parameters
    ----------
    advance : (state, load, guess) -> the equilibrium at ``load`` reached from ``state``; raises ConvergenceError
    control : step lengths
    """

    def __init__(self, advance: Callable[[State, float, Array], State], control: StepControl):
        self._advance, self._control = advance, control
        self.rejected = 0

    def follow(
        self, start: State, target: float, event: Event[State] | None = None, *, headway: Headway | None = None
    ) -> Iterator[tuple[State, bool]]:
        """Yield every accepted state from ``start`` up to ``target`` or to the event, with whether it is the event.

        ``headway`` is that of the whole path, if this is only a part of it.

        Raises
        ------
        ConvergenceError
            If no step longer than the smallest one converges, or the path makes no progress; the message names the load reached.
        InvalidQuantity
            If the largest step is so short that there would be too many.
        """
        check_steps((target - start.load) / self._control.largest, f"a largest step of {self._control.largest:.3g}")
        now, path, step = start, {start.load: start}, self._control.first
        headway = headway or Headway(start.load, target, self._control.unit)
        while now.load < target * (1 - 1e-12):
            load = min(now.load + step, target)
            try:
                reached = self._advance(now, load, beyond(path, load - now.load))
                happened = event is not None and event.value(reached) >= 0
                if event is not None and happened:
                    around = {**path, reached.load: reached}
                    reached = located(partial(self._advance, now), event.value, around, event.tolerance)
            except ConvergenceError as error:
                self.rejected += 1
                step = (load - now.load) * self._control.cut
                if step < self._control.smallest:
                    place, end = (format_quantity(value, self._control.unit) for value in (now.load, target))
                    raise ConvergenceError(f"gave up at {place} of {end}: {error}", error.history) from error
                headway.spent(error.solutions, now.load, (target - now.load) / self._control.largest, error)
                continue
            step = self._control.next_step(max(step, load - now.load), reached.iterations)
            path, now = {now.load: now, reached.load: reached}, reached
            yield now, happened
            if happened:
                return
            headway.spent(now.iterations, now.load, (target - now.load) / self._control.largest)
