"""The run of a boundary value problem, and what it reports."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tactsim.errors import ConvergenceError
from tactsim.experiments.boundary_value.asked import Asked, unit_of
from tactsim.experiments.boundary_value.branching import unstable_in_words
from tactsim.experiments.boundary_value.conditions import SIDES
from tactsim.experiments.boundary_value.limit_load import LimitLoad
from tactsim.experiments.boundary_value.posing import PosedProblem, posed
from tactsim.experiments.boundary_value.probes import Probes
from tactsim.experiments.boundary_value.scene import BoundaryValueScene, TouchingBody
from tactsim.experiments.boundary_value.setup import MOST_STEPS, BoundaryValueSetup
from tactsim.fem.paths.time_steps import TimeControl
from tactsim.interfaces.run import Course, Findings
from tactsim.mechanics.models.loaded_body import LoadedBody
from tactsim.mechanics.outcome.contact_history import LAST
from tactsim.mechanics.outcome.contact_record import (
    ERROR_IN_TIME,
    ContactRecord,
    FollowedPath,
    penetration_allowed,
    solver_report,
)
from tactsim.mechanics.outcome.success import LARGEST_FORCE_ERROR
from tactsim.mechanics.paths.history_path import TimedPath, TimedState, TimeInterval, TimeStepPolicy, smooth_intervals
from tactsim.mechanics.paths.step_policy import SMALLEST_LOAD_STEP, StepPolicy, shortest_relaxation_time
from tactsim.results.quantity import Quantity
from tactsim.results.result import Status, StepRecord
from tactsim.units import format_quantity

WIDER = 10.0
"""Factor of a penetration tolerance that is advised where the contact does not converge."""
SHORTER = 100
"""Factor of the number of steps that is advised where not even the first is found."""
SAME_TIME = 1e-9
"""Relative difference of two times that is round-off."""


@dataclass(frozen=True)
class AskedTimes(TimeStepPolicy):
    """A policy with steps that end at further ``times`` in s as well."""

    policy: StepPolicy
    times: tuple[float, ...]

    def control(self, interval: TimeInterval) -> TimeControl:
        """That of the policy."""
        return self.policy.control(interval)

    def largest(self, interval: TimeInterval) -> float:
        """That of the policy, in s."""
        return self.policy.largest(interval)

    def stops(self, interval: TimeInterval) -> list[float]:
        """Those of the policy and the further times within the interval, one for times that only round-off parts."""
        start, end = interval.start * (1 + SAME_TIME), interval.end * (1 - SAME_TIME)
        within = sorted({time for time in self.times if start < time < end})
        stops = self.policy.stops(interval)
        return sorted([*within, *(stop for stop in stops if all(abs(stop - time) > SAME_TIME * time for time in within))])


def boundary_value_course(problem: BoundaryValueSetup) -> Course:
    """The run of a problem."""
    path, record = _begun(problem)
    limit = LimitLoad(record.model, path.start)
    return Course(_accepted(record, path, limit), record.findings, setup_is_timed=True)


def unloaded_problem(problem: BoundaryValueSetup) -> Findings:
    """The body, and the rigid bodies at first touch."""
    path, record = _begun(problem)
    return record.unloaded(path.start)


def _begun(problem: BoundaryValueSetup) -> tuple[TimedPath, BoundaryValueRecord]:
    """The path of a problem at its start, and what will record it."""
    model = posed(problem)
    probes = Probes(problem, model)
    common = problem.common_amplitude
    histories = [(common if one is None else one.amplitude or common).history() for one in model.followed]
    materials, relaxes = list(problem.materials.values()), problem.relaxes
    policy = StepPolicy(
        problem.time, shortest_relaxation_time(materials), per_ramp=problem.steps, per_period=problem.steps, sparing=not relaxes
    )
    times = tuple(one.time for one in problem.asked.values() if one.time is not None)
    course = smooth_intervals(histories, problem.duration)
    start = TimedState.at_rest(model.model.body, model.model.at_rest(), len(histories))
    path = TimedPath(model.model, AskedTimes(policy, times), course, start)
    return path, BoundaryValueRecord(problem, model, probes, path)


def _accepted(record: BoundaryValueRecord, path: TimedPath, limit: LimitLoad) -> Iterator[StepRecord]:
    """The accepted states of a path, recorded; one that gives up says if its load is at a limit or its contact too exact."""
    try:
        for state, _ in path.states():
            limit.observe(state)
            yield record.accept(state)
    except ConvergenceError as error:
        hints = limit.in_words() or record.wider_in_words() or _shorter_in_words(record)
        raise ConvergenceError(f"{error}{hints}", error.history, error.solutions) from error


def _shorter_in_words(record: BoundaryValueRecord) -> str:
    """That more load steps begin with a shorter one, if not even the first was found; empty otherwise."""
    problem, given = record.problem, record.problem.steps
    more = min(SHORTER * given, MOST_STEPS)
    if record.steps or more == given or problem.relaxes or problem.begins_with_jump:
        return ""
    shortest = f"{1 / SMALLEST_LOAD_STEP:.0f} times as short"
    return (
        f"; not even a first step was found, nor one {shortest}: steps: {more} instead of {given} begins with shorter ones, as a "
        "thin sheet needs that is limp while it is flat"
    )


def _time_reached(step: StepRecord) -> str:
    """The time of a step, in words."""
    return format_quantity(step.values["time"], "s")


class BoundaryValueRecord(ContactRecord[LoadedBody]):
    """Collects the accepted states of a problem."""

    def __init__(self, problem: BoundaryValueSetup, posed: PosedProblem, probes: Probes, path: FollowedPath):
        size = posed.parts.size
        super().__init__(
            posed.model,
            path,
            tolerance=problem.largest_penetration(size),
            stiffest=math.inf if posed.model.conditions.only_contacts_act else 3 * problem.stiffest / size,
            reached=_time_reached,
        )
        self.problem, self._probes, self._mirrors = problem, probes, posed.parts.domain.mirrors
        self._touched = [False] * len(problem.contacts)

    def values(self, state: TimedState) -> dict[str, float]:
        """What is asked for, and what every step records."""
        contacts = state.contact.contacts
        self._touched = [
            before or bool((one.state.pressure > 0).any()) for before, one in zip(self._touched, contacts, strict=True)
        ]
        return {
            "time": state.time,
            **self._probes.values(state),
            "max_penetration": state.contact.penetration,
            **self.quality.values(self.model.body, state.contact),
        }

    def kept_as(self, state: TimedState, event: bool) -> Sequence[str]:
        """The last state."""
        return ("last",)

    def wider_in_words(self) -> str:
        """That a wider penetration tolerance costs little of the force; empty if it would cost more than is allowed."""
        cost = WIDER * self.steps[-1].values["penetration_force_error"] if self.steps else 0.0
        if not 0 < cost <= LARGEST_FORCE_ERROR:
            return ""
        given, wider = (format_quantity(factor * self.tolerance, "m") for factor in (1.0, WIDER))
        return (
            f"; instead of {given}, penetration_tolerance: {wider} is easier to reach and takes away some {cost:.1g} of the "
            "force, as penetration_force_error then says"
        )

    def verdict(self) -> tuple[Status, str]:
        """A path that came to its end has converged, unless a number that is asked for is none."""
        for name, one in self.problem.asked.items():
            step = self._step_of(one)
            if step is not None and not math.isfinite(step.values[name]):
                return Status.FAILED, f"{name} is {step.values[name]}, not a finite number"
        return Status.CONVERGED, "end of the amplitudes"

    @property
    def _reported(self) -> list[StepRecord]:
        """The steps at which a number is asked for, and the last one."""
        steps = {step.step: step for one in self.problem.asked.values() if (step := self._step_of(one)) is not None}
        return [*(steps[number] for number in sorted(steps)), *super()._reported]

    def quantities(self) -> dict[str, Quantity]:
        """What is asked for, each at its time, and the quality of the answer."""
        described = {name: self._quantity(name) for name in self.problem.asked}
        return {name: one for name, one in described.items() if one is not None} | super().quantities()

    def _quantity(self, name: str) -> Quantity | None:
        """A number at its time; None if the run did not come so far."""
        one = self.problem.asked[name]
        words = one.words if one.factor == 1 else f"{one.words}, times {one.factor:g}"
        unit = unit_of(one, self.problem.dimension)
        if unit != one.unit:
            words += ", per metre of depth"
        when = LAST if one.time is None else f", at {format_quantity(one.time, 's')}"
        step = self._step_of(one)
        return None if step is None else Quantity(step.values[name], unit, words + when)

    def _step_of(self, one: Asked) -> StepRecord | None:
        """The last step at the time at which a number is asked for; None if the run did not come so far."""
        steps = reversed(self.steps)
        return next(
            (step for step in steps if one.time is None or abs(step.values["time"] - one.time) <= SAME_TIME * one.time), None
        )

    def assumptions(self) -> list[str]:
        """Which part of the body is computed, and what contact and time allow."""
        assumptions = ["forces are per metre of depth"] if self.problem.dimension == "plane_strain" else []
        if mirrors := tuple(self._mirrors):
            assumptions.append(f"symmetry about {', '.join(mirrors)}: forces, energy and volume are those of the part computed")
        if self.problem.contacts:
            assumptions.append(penetration_allowed(self.tolerance))
        if self.problem.relaxes:
            assumptions.append(ERROR_IN_TIME.format(self.problem.time.tolerance))
        return assumptions

    def warnings(self) -> list[str]:
        """Warnings about volumes and ellipticity, about an unstable end, and about rigid bodies that never touched."""
        together = zip(self.problem.contacts, self._touched, strict=True)
        last = self._kept["last"].state
        unstable = unstable_in_words(self._kept["last"].model, last)
        return [
            *super().warnings(),
            *self._probes.doubts(last),
            *([unstable] if unstable else []),
            *(
                f"rigid body {number} ({one.body.kind} from the {one.side}) never touches the body at {one.face}, its force is "
                "zero: do its displacement and side lead it there?"
                for number, (one, touched) in enumerate(together, 1)
                if not touched
            ),
        ]

    def _touching(self) -> tuple[TouchingBody, ...]:
        """The rigid bodies where they first touch, and where they came to."""
        sides, begin = SIDES[self.problem.dimension], [moved.posed for moved in self.model.conditions.contacts]
        last = self._kept["last"].state.contact.contacts if "last" in self._kept else begin
        return tuple(
            TouchingBody(
                body=one.body, axis=sides[one.side], place=tuple(first.place.tolist()), reached=tuple(now.place.tolist())
            )
            for one, first, now in zip(self.problem.contacts, begin, last, strict=True)
        )

    def scene(self) -> BoundaryValueScene:
        """What the figure reads."""
        return BoundaryValueScene(
            dimension=self.problem.dimension,
            asked={name: unit_of(one, self.problem.dimension) for name, one in self.problem.asked.items()},
            touching=self._touching(),
            solver=solver_report(self),
        )
