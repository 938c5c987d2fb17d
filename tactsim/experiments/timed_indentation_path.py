"""The course of a timed indentation: sudden changes by elastic load steps, smooth pieces by steps of time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tactsim.analytic.histories import Segment
from tactsim.contact.penalty import Regularisation
from tactsim.experiments.contact_equilibrium import ContactEquilibrium
from tactsim.experiments.indentation_model import IndentationModel
from tactsim.experiments.indentation_path import SWITCH_LENGTH
from tactsim.experiments.timed_indentation_setup import LOAD_STEPS, SMALLEST_SHARE, TimedIndentationSetup
from tactsim.fem.body import PastStress
from tactsim.fem.loading import Event, PathFollower, StepControl
from tactsim.fem.memory import Memory, elastic_stress, series_of, step_error
from tactsim.fem.time_steps import TimeControl, TimeEvent, TimeMarcher
from tactsim.materials.viscoelasticity import shear_relaxation

Array = np.ndarray

JUMP = StepControl(first=1.0, largest=1.0, smallest=1e-5)
"""Steps of a sudden change, as parts of it: at once if Newton can."""
LEAST_PENETRATION = 2e-4
"""Tolerance of the penetration in radii, below which the contact is stiff only as far as the pressure asks: an elastic answer
then penetrates by less than this part of its displacement."""
TOUCH = 1e-3
"""First guess of a displacement in penetration tolerances, so that something touches."""


@dataclass(frozen=True)
class TimedState:
    """An accepted state at a time in s; ``load`` in N or m is prescribed. ``memory`` is None if nothing relaxes."""

    time: float
    load: float
    contact: ContactEquilibrium
    memory: Memory | None
    past: PastStress | None = None
    """What the step that led here remembered."""

    @property
    def unknowns(self) -> Array:
        """Unknowns of the body and the displacement of the rigid body."""
        return np.append(self.contact.unknowns, self.contact.load)

    @property
    def iterations(self) -> int:
        """Newton iterations."""
        return self.contact.iterations


class TimedPath:
    """Follows the prescribed history; ``rejected`` counts the steps that were taken back."""

    def __init__(self, experiment: TimedIndentationSetup, model: IndentationModel):
        self._experiment, self._model = experiment, model
        self.height = model.touching_height(experiment.body)
        self.rejected = 0

    def states(self, event: TimeEvent[TimedState] | None = None) -> Iterator[tuple[TimedState, bool]]:
        """Every accepted state up to the end or the event, with whether it is the event.

        Raises
        ------
        ConvergenceError
            If the path cannot be followed to its end.
        """
        state = self._start()
        for segment in self._experiment.loading.segments():
            if segment.at(segment.start) != state.load:
                state, happened = self._jumped(state, segment.at(segment.start), event)
                yield state, happened
                if happened:
                    return
            for reached, happened in self._march(state, segment, event):
                state = reached
                yield state, happened
                if happened:
                    return

    def _start(self) -> TimedState:
        experiment, model = self._experiment, self._model
        stiffest = max(shear_relaxation(material).instantaneous_modulus for material in experiment.specimen.materials)
        share = min(1.0, experiment.tolerance / (LEAST_PENETRATION * experiment.contact_radius))
        length = SWITCH_LENGTH * experiment.contact_radius
        scale = Regularisation(experiment.tolerance, share * stiffest, switch_length=length)
        contact = model.start([(experiment.body, self.height)], experiment.contact, scale)
        series = series_of(model.body)
        return TimedState(0.0, 0.0, contact, None if series is None else Memory.at_rest(model.body, series))

    def _jumped(self, start: TimedState, target: float, event: TimeEvent[TimedState] | None) -> tuple[TimedState, bool]:
        """The state after a sudden, elastic change to another load, or at the event on the way, and whether it is that."""

        def advance(now: _JumpState, share: float, guess: Array) -> _JumpState:
            load = start.load + share * (target - start.load)
            return _JumpState(share, self._reached(now.state, now.state.time, load, guess))

        on_the_way = None if event is None else Event[_JumpState](lambda now: event.value(now.state), event.tolerance)
        follower = PathFollower(advance, JUMP)
        *_, (last, happened) = follower.follow(_JumpState(0.0, start), 1.0, on_the_way)
        self.rejected += follower.rejected
        if happened:
            return last.state, True
        # Once more with the contact as stiff as the new pressure asks, so that later steps do not have to.
        return self._reached(last.state, last.state.time, target, last.state.unknowns), False

    def _march(
        self, start: TimedState, segment: Segment, event: TimeEvent[TimedState] | None
    ) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states of a smooth piece."""
        experiment, duration = self._experiment, segment.end - segment.start
        first = experiment.first_step(duration)
        control = TimeControl(experiment.time.tolerance, first=first, smallest=SMALLEST_SHARE * first)
        periods = [2 * np.pi / wave.angular_frequency for wave in segment.harmonics]
        largest = min([duration, *periods]) / LOAD_STEPS if segment.slope or periods else duration

        def advance(now: TimedState, time: float, guess: Array) -> TimedState:
            return self._reached(now, time, segment.at(time), guess)

        if start.memory is not None:
            start = replace(start, memory=start.memory.at_kink())
        marcher = TimeMarcher(advance, self._error, control)
        stops = experiment.time.stops(segment.start, segment.end)
        for state, happened in marcher.march(start, stops, largest=largest, event=event):
            self.rejected += marcher.rejected
            marcher.rejected = 0
            yield state, happened

    def _reached(self, now: TimedState, time: float, load: float, guess: Array) -> TimedState:
        """The equilibrium at a time and load."""
        model, step = self._model, time - now.time
        past = None if now.memory is None else now.memory.past(step)
        if self._experiment.loading.control == "displacement":
            contact = model.equilibrium(now.contact, load, guess[:-1], past=past)
        else:
            travel = guess[-1] if guess[-1] > 0 else TOUCH * self._experiment.tolerance
            contact = model.equilibrium(now.contact, travel, guess[:-1], force=load, past=past)
        memory = None
        if now.memory is not None:
            memory = now.memory.advanced(elastic_stress(model.body, contact.kinematics), step)
        return TimedState(time, load, contact, memory, past)

    def _error(self, state: TimedState) -> float:
        """Estimated relative error of the stress."""
        return 0.0 if state.memory is None else step_error(self._model.body, state.memory)


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
