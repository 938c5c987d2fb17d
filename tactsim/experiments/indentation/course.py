"""The course of an indentation: load steps or a history of time, a finer mesh where sliding asks for it, the inner sensor."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from tactsim.contact.penalty import Regularisation
from tactsim.deadline import TOO_LONG
from tactsim.errors import Collapsed, Unfinished
from tactsim.experiments.indentation.record import IndentationRecord
from tactsim.experiments.indentation.setup import Displaced, IndentationSetup, Timed
from tactsim.fem.paths.loading import Event, PathFollower
from tactsim.fem.paths.progress import Headway
from tactsim.fem.paths.time_steps import TimeEvent
from tactsim.interfaces import Material
from tactsim.interfaces.run import Course, Findings
from tactsim.materials.viscoelasticity import flows, shear_relaxation
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.penetration_bounds import small_part
from tactsim.mechanics.models.pressed_body import PressedBody
from tactsim.mechanics.models.pressed_model import PressedModel
from tactsim.mechanics.models.section_model import SectionModel
from tactsim.mechanics.paths.history_path import TimedPath, TimedState, smooth_intervals
from tactsim.mesh.adaptation import Refinement
from tactsim.units import format_quantity

THRESHOLD_TOLERANCE = 1e-5
"""Tolerance of the displacement at the threshold, as a part of the recess."""
SMALL_DISPLACEMENT = 0.05
"""Displacement over the body's radius below which the penetration tolerance is in proportion to it, and pressures are less.

Why: in proportion to the tolerance alone, contact was the stiffer the smaller the displacement. In 3D points stuck and slipped by
turns, around the rim of a ball's contact they opened and closed, and 1 um found no way or took many short steps."""
SWITCH_LENGTH = 0.03
"""Length, as a part of the body's radius, over which a violated contact counts as much as the largest contact pressure."""
SPLIT_LENGTH = 2.0
"""An element is split when its deformed edge is this many times longer than the size wanted there."""
LONG = 1.3
"""Elements this many times too long are split along with those beyond ``SPLIT_LENGTH``, so that it happens rarely."""
LARGEST_GROWTH = 4.0
"""The mesh is not refined beyond this many times its first number of elements."""
FINER = 2.0
"""Factor of the mesh's refinement that is advised where an element collapsed: with it every such run that was tried came to
its end."""
RESTART = 0.5
"""First step on a refined mesh, as a part of the last one: there is nothing yet to extrapolate."""
PAST_PEAK = 0.95
"""When the rise has fallen to this part of its peak, the tissue slips out of the hole faster than it is pushed in."""
LEAST_PENETRATION = 2e-4
"""Tolerance of the penetration in radii, below which the contact is stiff only as far as the pressure asks: an elastic answer
then penetrates by less than this part of its displacement."""
AT_FIRST = 0.1
"""Stiffness of the contact of tissue that flows at the beginning, over that of the tissue at once.

Why: a contact as stiff as the tissue is at once meets each further point of the surface with a jolt. With a tenth, random
indentations of atrial tissue with friction took a third to all of the time, an annulus 527 linear systems instead of 1216. With a
thousandth they were faster still, but penetration made the beginning of a slow ramp 4 % softer than the closed form."""
TOUCH = 1e-3
"""First guess of a displacement in penetration tolerances, so that something touches."""

Adapted = Callable[[PressedModel, Refinement], None]


def indentation_course(setup: IndentationSetup) -> Course:
    """The run of an indentation in any dimension, with a clock or without."""
    path, record = _begun(setup)
    steps = (record.accept(state, event=touch) for state, touch in path.states(record.adapted))
    return Course(steps, record.findings, setup_is_timed=True, advice=partial(_advice, setup))


def _advice(setup: IndentationSetup, error: Unfinished) -> str:
    """The keys of the case by which a run that found no way on may come to its end."""
    if isinstance(error, Collapsed):
        return f"; smaller elements may lead on: mesh.refinement: {FINER * setup.mesh.refinement:g}"
    if str(error).startswith(TOO_LONG):
        return setup.if_slow.format(tolerance=format_quantity(setup.tolerance, "m"))
    return ""


def unloaded_indentation(setup: IndentationSetup) -> Findings:
    """The tissue and the body at first touch."""
    path, record = _begun(setup)
    return record.unloaded(TimedState(0.0, (0.0,), path.start, None))


def _begun(setup: IndentationSetup) -> tuple[DisplacementPath | HistoryPath, IndentationRecord]:
    """The path of an indentation at its start, and what will record it."""
    model, drive = setup.model(), setup.drive()
    path = HistoryPath(setup, drive, model) if isinstance(drive, Timed) else DisplacementPath(setup, drive, model)
    return path, IndentationRecord(setup, model, path)


def started(setup: IndentationSetup, model: PressedModel, modulus: float, part: float = 1.0) -> ContactEquilibrium:
    """The body at first touch of the undeformed tissue, whose contact is as stiff as a ``part`` of a shear modulus in Pa."""
    scale = Regularisation(setup.tolerance, part * modulus, switch_length=part * SWITCH_LENGTH * setup.contact_radius)
    body = setup.posed().body
    return model.start(body, model.touching_place(body), setup.contact, scale)


def _pressure_part(setup: IndentationSetup) -> float:
    """How much less a body presses than under usual displacements: in proportion to a small one, a ball to its root, as by Hertz.

    A flat body in a section counts as usual, since stiff contact costs nothing there.
    """
    share = small_part(setup.prescribed, SMALL_DISPLACEMENT * setup.contact_radius)
    if setup.body.contact_shape.tip is not None:
        return math.sqrt(share)
    return share if setup.measure == "solid" else 1.0


class DisplacementPath:
    """Follows the displacement, and from time to time goes on with a finer mesh of the same tissue; ``model`` is that of the last
    state."""

    def __init__(self, setup: IndentationSetup, drive: Displaced, model: PressedModel):
        self.model, self._setup, self._drive = model, setup, drive
        self._followers: list[PathFollower[ContactEquilibrium]] = []
        self._size = setup.section().size()
        self._most = LARGEST_GROWTH * len(model.mesh.elements)
        modulus = min(material.shear_modulus for material in setup.specimen.materials)
        self.start = started(setup, model, modulus, _pressure_part(setup))

    @property
    def rejected(self) -> int:
        """Steps that were taken back, those of a path that gave up included."""
        return sum(follower.rejected for follower in self._followers)

    def states(self, adapted: Adapted) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states, each with whether it is the touch of the inner sensor; past it, this presses too.

        ``adapted`` is called with every refinement of the mesh.

        Raises
        ------
        ConvergenceError
            If the path cannot be followed to its end.
        Unfinished
            If the rise has passed its peak below the threshold.
        """
        setup, recess = self._setup, self._setup.recess
        if recess is None:
            yield from self.follow(self.start, None, adapted)
            return
        radius = setup.hole
        event = Event[ContactEquilibrium](
            lambda s: self.model.rise(s, radius)[0] - recess, tolerance=THRESHOLD_TOLERANCE * recess
        )
        peak, peak_load = 0.0, 0.0
        for state, touched in self.follow(self.start, event, adapted):
            yield state, touched
            rise = self.model.rise(state.contact, radius)[0]
            peak, peak_load = max((peak, peak_load), (rise, state.contact.load))
            if self._drive.stops_at_touch and rise < PAST_PEAK * peak and not touched:
                highest, where = format_quantity(peak, "m"), format_quantity(peak_load, "m")
                peaked = f"the tissue's rise peaked at {highest}, at a displacement of {where}, and is falling"
                raise Unfinished(f"the threshold was not reached: {peaked}")
        posed = setup.posed()
        if touched and not self._drive.stops_at_touch and posed.inner_sensor is not None:
            place = state.contact.contacts[0].place + recess * posed.axis
            with_sensor = self.model.with_body(state.contact, posed.inner_sensor, setup.contact, place)
            yield from self.follow(with_sensor, None, adapted)

    def follow(
        self, state: ContactEquilibrium, event: Event[ContactEquilibrium] | None, adapted: Adapted
    ) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states from one of them up to the event or the displacement.

        Raises
        ------
        ConvergenceError
            If the path cannot be followed.
        """
        control, target = self._drive.control, self._drive.displacement
        first, more, headway = control.first, True, Headway(state.load, target, control.unit)
        while more:
            more, before = False, state.load
            follower = PathFollower(self.model.equilibrium, replace(control, first=first))
            self._followers.append(follower)
            for reached, happened in follower.follow(state, target, event, headway=headway):
                first, before = max(control.first, RESTART * (reached.load - before)), reached.load
                state = reached
                yield TimedState(state.load, (state.load,), state, None), happened
                if not happened and state.load < target and (model := self._to_refine(state)) is not None:
                    state, more = self._refined(model, state, adapted), True
                    break

    def _to_refine(self, state: ContactEquilibrium) -> SectionModel | None:
        """The model, if elements of it have become too long for a state."""
        model = self.model
        if not (self._setup.mesh.adaptive and isinstance(model, SectionModel)) or len(model.mesh.elements) >= self._most:
            return None
        return model if len(model.too_coarse(state, self._size, SPLIT_LENGTH)) else None

    def _refined(self, model: SectionModel, state: ContactEquilibrium, adapted: Adapted) -> ContactEquilibrium:
        while len(marked := model.too_coarse(state, self._size, LONG)) and len(model.mesh.elements) < self._most:
            model, state, split = model.refined(state, marked)
            self.model = model
            adapted(model, split)
        return state


def _stiffness_in_contact(material: Material) -> float:
    """Shear modulus in Pa that the contact of a material that relaxes begins with."""
    at_once = shear_relaxation(material).instantaneous_modulus
    return AT_FIRST * at_once if flows(material) else at_once


class HistoryPath:
    """Follows a history of force or displacement; its mesh stays."""

    def __init__(self, setup: IndentationSetup, drive: Timed, model: PressedModel):
        self._setup, self._drive, self._model = setup, drive, model
        stiffest = max(_stiffness_in_contact(material) for material in setup.specimen.materials)
        share = min(1.0, setup.tolerance / (LEAST_PENETRATION * setup.contact_radius))
        start = TimedState.at_rest(model.body, started(setup, model, share * stiffest), 1)
        body = PressedBody(model, by_force=drive.by_force, first_displacement=TOUCH * setup.tolerance)
        course = smooth_intervals([drive.loading.history()], drive.loading.duration)
        self._path = TimedPath(body, drive.policy, course, start)

    @property
    def start(self) -> ContactEquilibrium:
        """The undeformed tissue at first touch."""
        return self._path.start.contact

    @property
    def rejected(self) -> int:
        """Steps that were taken back."""
        return self._path.rejected

    def states(self, adapted: Adapted | None = None) -> Iterator[tuple[TimedState, bool]]:
        """Accepted states, each with whether it is the touch of the inner sensor, at which the run may end.

        Raises
        ------
        ConvergenceError
            If the path cannot be followed to its end.
        """
        event = None
        if self._drive.stops_at_touch and self._setup.recess is not None:
            recess, radius = self._setup.recess, self._setup.hole
            event = TimeEvent[TimedState](lambda state: self._model.rise(state.contact, radius)[0] - recess)
        yield from self._path.states(event)
