"""The course of an experiment over time: sudden changes by elastic load steps, smooth intervals by time steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np

from tactsim.analytic.histories import History, Segment
from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.history_variables import HistoryVariables, elastic_stress, series_of, size_of, step_error
from tactsim.fem.equilibrium.diagnosis import collapsed_in_words
from tactsim.fem.paths.loading import Event, PathFollower, StepControl
from tactsim.fem.paths.progress import check_steps
from tactsim.fem.paths.time_steps import TimeControl, TimeEvent, TimeMarcher
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.fields.volume_ratios import POOR_SHARE, poor_share

JUMP = StepControl(first=1.0, largest=1.0, smallest=1e-5)
"""Steps of a sudden change, as parts of it: at once if Newton can."""
SURE = 1 / 64
"""Part of a sudden change so short that elements which lose their volume in it do so because they are too large: a longer one may
have led to another equilibrium than that on the way, and is halved."""
SAME = 1e-9
"""Relative difference of two values, and of two times over the whole duration, that is round-off."""


@dataclass(frozen=True)
class TimeInterval:
    """A smooth interval of time from ``start`` to ``end`` in s, with one segment on it for each prescribed value."""

    start: float
    end: float
    segments: tuple[Segment, ...]
    sudden: bool = False
    """Whether a prescribed value jumps at its start."""

    @property
    def duration(self) -> float:
        """Duration in s."""
        return self.end - self.start

    @property
    def shortest_period(self) -> float:
        """Shortest period in s of a harmonic, infinite if there is none."""
        waves = (wave for segment in self.segments for wave in segment.harmonics if wave.angular_frequency > 0)
        return min((2 * np.pi / wave.angular_frequency for wave in waves), default=np.inf)

    @property
    def ramped(self) -> bool:
        """Whether a prescribed value has a slope on it."""
        return any(segment.slope != 0 for segment in self.segments)

    @property
    def changes(self) -> bool:
        """Whether a prescribed value changes on it."""
        return self.ramped or any(segment.harmonics for segment in self.segments)

    def at(self, time: float) -> tuple[float, ...]:
        """The prescribed values at a time in s."""
        return tuple(segment.at(time) for segment in self.segments)

    def begins_at(self, loads: Sequence[float]) -> bool:
        """Whether the values at its start are these, up to round-off."""
        sizes = [
            abs(s.value) + abs(s.slope * self.duration) + sum(abs(wave.amplitude) for wave in s.harmonics) for s in self.segments
        ]
        differences = np.abs(np.subtract(self.at(self.start), loads))
        return bool((differences <= SAME * (np.array(sizes) + np.abs(loads))).all())


def smooth_intervals(histories: Sequence[History], end: float) -> tuple[TimeInterval, ...]:
    """The smooth intervals of several histories from 0 to ``end`` in s, on the union of their breakpoints."""
    starts = np.unique(np.concatenate([history.starts for history in histories]))
    starts = starts[starts < end * (1 - SAME)]
    starts = starts[np.append(True, np.diff(starts) > SAME * end)]
    ends = [*starts[1:].tolist(), end]
    course, loads = [], (0.0,) * len(histories)
    for a, b in zip(starts.tolist(), ends, strict=True):
        interval = TimeInterval(a, b, tuple(_covering(history, a, b).part(a, b) for history in histories))
        course.append(replace(interval, sudden=not interval.begins_at(loads)))
        loads = interval.at(b)
    return tuple(course)


def _covering(history: History, start: float, end: float) -> Segment:
    """The segment that holds between two times without a breakpoint."""
    return history.segments[int(np.searchsorted(history.starts, (start + end) / 2, side="right")) - 1]


class EquilibriumProblem(Protocol):
    """A body whose equilibrium follows from prescribed values."""

    @property
    def body(self) -> Body:
        """The body that deforms."""

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, relaxation: RelaxationStep | None
    ) -> ContactEquilibrium:
        """The equilibrium at prescribed values, reached from ``now``; raises ConvergenceError.

        ``guess`` (size + 1,) holds the unknowns of the body and the displacement of the rigid bodies in m.
        """


class TimeStepPolicy(Protocol):
    """How long the time steps are."""

    def control(self, interval: TimeInterval) -> TimeControl:
        """How steps of an interval grow and shrink."""

    def largest(self, interval: TimeInterval) -> float:
        """Longest step in s."""

    def stops(self, interval: TimeInterval) -> list[float]:
        """Times in s at which a step must end, the last one the end of the interval."""


@dataclass(frozen=True)
class TimedState:
    """An accepted state at a time in s; ``loads`` are prescribed. ``history_variables`` is None if nothing relaxes."""

    time: float
    loads: tuple[float, ...]
    contact: ContactEquilibrium
    history_variables: HistoryVariables | None
    relaxation: RelaxationStep | None = None
    """Coefficients of the time step that ended here."""

    @classmethod
    def at_rest(cls, body: Body, contact: ContactEquilibrium, count: int) -> TimedState:
        """The beginning: ``count`` prescribed values that are zero."""
        series = series_of(body)
        return cls(0.0, (0.0,) * count, contact, None if series is None else HistoryVariables.at_rest(body, series))

    @property
    def unknowns(self) -> Array:
        """Unknowns of the body and the displacement of the rigid bodies in m, (size + 1,)."""
        return np.append(self.contact.unknowns, self.contact.load)

    @property
    def isochoric(self) -> Array | None:
        """The relaxed isochoric stress (6, E, Q) in Pa; None if nothing relaxes."""
        return None if self.history_variables is None else self.history_variables.stress

    @property
    def iterations(self) -> int:
        """Newton iterations."""
        return self.contact.iterations


class TimedPath:
    """Follows prescribed histories from ``start``.

    Raises
    ------
    InvalidQuantity
        If the histories ask for too many steps.
    """

    def __init__(
        self, problem: EquilibriumProblem, step_policy: TimeStepPolicy, course: Sequence[TimeInterval], start: TimedState
    ):
        self._problem, self._step_policy, self._course, self.start = problem, step_policy, course, start
        self._followers: list[PathFollower[_JumpState] | TimeMarcher[TimedState]] = []
        asked = sum(len(step_policy.stops(interval)) + interval.duration / step_policy.largest(interval) for interval in course)
        check_steps(asked, "loading, with the steps and stops that time sets for its pieces,")

    @property
    def rejected(self) -> int:
        """Steps that were taken back, those of a path that gave up included."""
        return sum(follower.rejected for follower in self._followers)

    def states(self, event: TimeEvent[TimedState] | None = None) -> Iterator[tuple[TimedState, bool]]:
        """Every accepted state up to the end or the event, with whether it is the event.

        Raises
        ------
        ConvergenceError
            If the path cannot be followed to its end.
        """
        state = self.start
        for interval in self._course:
            if interval.sudden:
                state, happened = self._jumped(state, interval.at(interval.start), event)
                yield state, happened
                if happened:
                    return
            for reached, happened in self._march(state, interval, event):
                state = reached
                yield state, happened
                if happened:
                    return

    def _jumped(
        self, start: TimedState, target: tuple[float, ...], event: TimeEvent[TimedState] | None
    ) -> tuple[TimedState, bool]:
        """The state after a sudden, elastic change to other values, or at the event on the way, and whether it is that."""

        def advance(now: _JumpState, share: float, guess: Array) -> _JumpState:
            loads = tuple(a + share * (b - a) for a, b in zip(start.loads, target, strict=True))
            reached = self._reached(now.state, now.state.time, loads, guess)
            if share - now.load > SURE and self._lost_volume(now.state, reached):
                raise ConvergenceError("elements of the equilibrium that Newton found do not keep their volume", [])
            return _JumpState(share, reached)

        within = None if event is None else Event[_JumpState](lambda now: event.value(now.state), event.tolerance)
        follower = PathFollower(advance, JUMP)
        self._followers.append(follower)
        *_, (last, happened) = follower.follow(_JumpState(0.0, start), 1.0, within)
        if happened:
            return last.state, True
        # Once more with the contact as stiff as the new pressure asks, so that later steps do not have to.
        return self._reached(last.state, last.state.time, target, last.state.unknowns), False

    def _lost_volume(self, before: TimedState, reached: TimedState) -> bool:
        """Whether more of the body than before misses the volume that its pressure asks for, and than is warned of, or an element
        is about to turn inside out that was not."""
        body, now, then = self._problem.body, reached.contact, before.contact
        share, earlier = (poor_share(body, body.volume_error(state.unknowns, state.kinematics)) for state in (now, then))
        collapsed, already = (collapsed_in_words(body, state.kinematics, state.unknowns) for state in (now, then))
        return share > max(POOR_SHARE, earlier) or (collapsed is not None and already is None)

    def _march(
        self, start: TimedState, interval: TimeInterval, event: TimeEvent[TimedState] | None
    ) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states of a smooth interval."""

        def advance(now: TimedState, time: float, guess: Array) -> TimedState:
            return self._reached(now, time, interval.at(time), guess)

        if start.history_variables is not None:
            start = replace(start, history_variables=start.history_variables.at_slope_change())
        marcher = TimeMarcher(advance, partial(self._error, interval), self._step_policy.control(interval))
        self._followers.append(marcher)
        stops, largest = self._step_policy.stops(interval), self._step_policy.largest(interval)
        yield from marcher.march(start, stops, largest=largest, event=event)

    def _reached(self, now: TimedState, time: float, loads: tuple[float, ...], guess: Array) -> TimedState:
        """The equilibrium at a time and prescribed values."""
        step = time - now.time
        relaxation = None if now.history_variables is None else now.history_variables.relaxation_step(step)
        contact = self._problem.equilibrium(now.contact, loads, guess, relaxation)
        history_variables = None
        if now.history_variables is not None:
            elastic = elastic_stress(self._problem.body, contact.kinematics, contact.unknowns)
            history_variables = now.history_variables.advanced(elastic, step)
        return TimedState(time, loads, contact, history_variables, relaxation)

    def _error(self, interval: TimeInterval, before: TimedState, state: TimedState) -> float:
        """Estimated error of the stress over its size, which counts at least as if it had grown all the interval as it does now.

        Why: a body that touches its first points makes a kink, after which the stress has only begun to grow. Beside what there
        is of it the error of a step with the kink is as large however short the step.
        """
        if state.history_variables is None or before.history_variables is None:
            return 0.0
        body = self._problem.body
        growth = size_of(body, state.history_variables.stress) - size_of(body, before.history_variables.stress)
        lasting = min(state.time - interval.start, interval.shortest_period / (2 * np.pi))
        return step_error(body, state.history_variables, max(growth, 0.0) * lasting / (state.time - before.time))


@dataclass(frozen=True)
class _JumpState:
    """A state on the way of a sudden change; ``load`` is the part of the way."""

    load: float
    state: TimedState

    @property
    def unknowns(self) -> Array:
        """Unknowns of the state."""
        return self.state.unknowns

    @property
    def iterations(self) -> int:
        """Newton iterations of the state."""
        return self.state.iterations
