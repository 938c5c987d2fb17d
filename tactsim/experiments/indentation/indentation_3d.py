"""A rigid body pressed into tissue in space: the annulus off the axis and askew, up to the threshold of its inner sensor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.contact.penalty import Regularisation
from tactsim.contact.punch import Punch
from tactsim.contact.tilted import Tilted
from tactsim.errors import ConvergenceError
from tactsim.experiments.indentation.path import EVENT_TOLERANCE, PAST_PEAK, SWITCH_LENGTH
from tactsim.experiments.indentation.record_3d import SpaceIndentationRecord
from tactsim.experiments.indentation.setup_3d import SpaceIndentationSetup, SpaceMeshSettings
from tactsim.fem.loading import Event, PathFollower
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.solid_model import SpaceIndentationModel
from tactsim.mechanics.specimen import Specimen
from tactsim.units import format_quantity


class SpaceIndentation(SpaceIndentationSetup, Experiment):
    """A rigid body pressed into a cylindrical specimen in space, its axis anywhere and leaning."""

    kind: Literal["indentation_3d"] = "indentation_3d"

    history_units: ClassVar[dict[str, str]] = SpaceIndentationRecord.UNITS

    @classmethod
    def example(cls) -> Self:
        """A thin specimen under the sensor of chapter 3, with few elements."""
        specimen = Specimen(material="icf_stable", thickness=4e-3, radius=8e-3)
        mesh = SpaceMeshSettings(finest=0.25e-3, growth=1.0, sectors=2)
        return cls(specimen=specimen, recess=0.8e-3, displacement=0.5e-3, stop="displacement", mesh=mesh)

    def begin(self) -> Course:
        """Press until the threshold or the displacement; see ``SpaceIndentationRecord`` for what is reported."""
        model = self.space_model()
        record = SpaceIndentationRecord(self, model)
        states = space_indentation_path(self, model, record)
        return Course((record.accept(state, threshold=event) for state, event in states), record.findings, setup_is_timed=True)


def space_indentation_path(
    experiment: SpaceIndentationSetup, model: SpaceIndentationModel, record: SpaceIndentationRecord
) -> Iterator[tuple[ContactEquilibrium, bool]]:
    """Accepted states, each with whether it is the threshold; past it the inner sensor presses too.

    Raises
    ------
    ConvergenceError
        If the path cannot be followed to its end, or the rise has passed its peak below the threshold.
    """
    body, law, recess = experiment.posed_body, experiment.contact, experiment.recess
    record.starting_height = height = model.touching_height(body)
    softest = min(material.shear_modulus for material in experiment.specimen.materials)
    scale = Regularisation(experiment.tolerance, softest, switch_length=SWITCH_LENGTH * experiment.contact_radius)
    first = model.start([(body, np.array([0.0, 0.0, height]))], law, scale)
    if recess is None:
        yield from _followed(experiment, model, record, (first, None))
        return
    event = Event[ContactEquilibrium](lambda s: record.rise(s)[0] - recess, tolerance=EVENT_TOLERANCE * recess)
    peak, peak_load = 0.0, 0.0
    for state, touched in _followed(experiment, model, record, (first, event)):
        yield state, touched
        rise = record.rise(state)[0]
        peak, peak_load = max((peak, peak_load), (rise, state.load))
        if experiment.stop == "threshold" and rise < PAST_PEAK * peak and not touched:
            highest, where = format_quantity(peak, "m"), format_quantity(peak_load, "m")
            raise ConvergenceError(f"the tissue's rise peaked at {highest}, at a displacement of {where}, and is falling")
    if touched and experiment.stop == "displacement":
        punch = Punch(radius=experiment.body.inner_radius, height=experiment.body.height)
        sensor = Tilted(body=punch, tilt_x=experiment.tilt_x, tilt_y=experiment.tilt_y)
        contact = model.contact(sensor, law, state.contacts[0].place + recess * body.rotation[:, 2])
        yield from _followed(experiment, model, record, (model.with_contact(state, contact), None))


def _followed(
    experiment: SpaceIndentationSetup,
    model: SpaceIndentationModel,
    record: SpaceIndentationRecord,
    leg: tuple[ContactEquilibrium, Event[ContactEquilibrium] | None],
) -> Iterator[tuple[ContactEquilibrium, bool]]:
    """Accepted states from the first of a ``leg`` to its event or the displacement; counts the rejected steps."""
    follower = PathFollower(model.advance, experiment.control())
    for reached in follower.follow(leg[0], experiment.displacement, leg[1]):
        record.rejected_steps += follower.rejected
        follower.rejected = 0
        yield reached
