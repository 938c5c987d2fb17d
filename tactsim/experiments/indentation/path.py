"""The course of an indentation: steps to the threshold, a finer mesh where sliding asks for it, the inner sensor's contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from tactsim.contact.penalty import Regularisation
from tactsim.contact.punch import Punch
from tactsim.errors import ConvergenceError
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.fem.loading import Event, PathFollower
from tactsim.fem.progress import Headway
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.section_model import IndentationModel
from tactsim.units import format_quantity

EVENT_TOLERANCE = 1e-5
"""Tolerance of the displacement at the threshold, as a part of the recess."""
SWITCH_LENGTH = 0.03
"""Length, as a part of the body's radius, over which a violated contact counts as much as the largest contact pressure."""
TOO_LONG = 2.0
"""An element is split when its deformed edge is this many times longer than the size wanted there."""
LONG = 1.3
"""Elements this many times too long are split along with those that are ``TOO_LONG``, so that it happens rarely."""
LARGEST_GROWTH = 4.0
"""The mesh is not refined beyond this many times its first number of elements."""
RESTART = 0.5
"""First step on a refined mesh, as a part of the last one: there is nothing yet to extrapolate."""
PAST_PEAK = 0.95
"""When the rise has fallen to this part of its peak, the tissue slips out of the hole faster than it is pushed in."""


def indentation_path(
    experiment: IndentationSetup, model: IndentationModel, record: IndentationRecord
) -> Iterator[tuple[ContactEquilibrium, bool]]:
    """Accepted states, each with whether it is the threshold.

    Raises
    ------
    ConvergenceError
        If the path cannot be followed to its end, or the rise has passed its peak below the threshold.
    """
    first, course = started(experiment, model, record)
    recess, touched = experiment.recess, False
    event = None
    if recess is not None:
        event = Event[ContactEquilibrium](lambda s: record.rise(s)[0] - recess, tolerance=EVENT_TOLERANCE * recess)
    peak, peak_load = 0.0, 0.0
    for state, touched in course.follow(first, event):
        yield state, touched
        if recess is not None and not touched:
            rise = record.rise(state)[0]
            peak, peak_load = max((peak, peak_load), (rise, state.load))
            if experiment.stop == "threshold" and rise < PAST_PEAK * peak:
                highest, where = format_quantity(peak, "m"), format_quantity(peak_load, "m")
                raise ConvergenceError(f"the tissue's rise peaked at {highest}, at a displacement of {where}, and is falling")
    if recess is not None and touched and experiment.stop == "displacement":
        sensor = Punch(radius=experiment.body.inner_radius, height=experiment.body.height)
        contact = course.model.contact(sensor, experiment.contact, record.starting_height - state.load + recess)
        yield from course.follow(course.model.with_contact(state, contact), None)


def started(
    experiment: IndentationSetup, model: IndentationModel, record: IndentationRecord
) -> tuple[ContactEquilibrium, Course]:
    """The body at first touch of the undeformed tissue, and the course from there."""
    record.starting_height = height = model.touching_height(experiment.body)
    softest = min(material.shear_modulus for material in experiment.specimen.materials)
    scale = Regularisation(experiment.tolerance, softest, switch_length=SWITCH_LENGTH * experiment.contact_radius)
    state = model.start([(experiment.body, height)], experiment.contact, scale)
    return state, Course(experiment, model, record)


class Course:
    """Follows the path, and from time to time goes on with a finer mesh of the same body."""

    def __init__(self, experiment: IndentationSetup, model: IndentationModel, record: IndentationRecord):
        self.model, self._experiment, self._record = model, experiment, record
        self._size = experiment.size()
        self._most = LARGEST_GROWTH * len(model.mesh.elements)

    def follow(
        self, state: ContactEquilibrium, event: Event[ContactEquilibrium] | None
    ) -> Iterator[tuple[ContactEquilibrium, bool]]:
        """Accepted states up to the event or the displacement."""
        control, target = self._experiment.control(), self._experiment.displacement
        first, more, headway = control.first, True, Headway(state.load, target)
        while more:
            more, before = False, state.load
            follower = PathFollower(self.model.advance, replace(control, first=first))
            for reached, happened in follower.follow(state, target, event, headway=headway):
                first, before = max(control.first, RESTART * (reached.load - before)), reached.load
                self._record.rejected_steps += follower.rejected
                follower.rejected = 0
                state = reached
                yield state, happened
                if not happened and state.load < target and self._needs_refinement(state):
                    state, more = self._refine(state), True
                    break

    def _needs_refinement(self, state: ContactEquilibrium) -> bool:
        if not self._experiment.mesh.adaptive or len(self.model.mesh.elements) >= self._most:
            return False
        return len(self.model.too_coarse(state, self._size, TOO_LONG)) > 0

    def _refine(self, state: ContactEquilibrium) -> ContactEquilibrium:
        while len(marked := self.model.too_coarse(state, self._size, LONG)) and len(self.model.mesh.elements) < self._most:
            self.model, state, split = self.model.refined(state, marked)
            self._record.adapted(self.model, split)
        return state
