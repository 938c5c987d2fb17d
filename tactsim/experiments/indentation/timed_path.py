"""The course of a timed indentation: one body, pressed by its displacement or its force."""

from __future__ import annotations

import numpy as np

from tactsim.contact.penalty import Regularisation
from tactsim.experiments.indentation.path import SWITCH_LENGTH
from tactsim.experiments.indentation.timed_setup import LOAD_STEPS, SMALLEST_SHARE, TimedIndentationSetup
from tactsim.fem.body import Body, PastStress
from tactsim.fem.time_steps import TimeControl
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.history_path import Stretch, TimedPath, TimedState, stretches
from tactsim.mechanics.section_model import IndentationModel

Array = np.ndarray

LEAST_PENETRATION = 2e-4
"""Tolerance of the penetration in radii, below which the contact is stiff only as far as the pressure asks: an elastic answer
then penetrates by less than this part of its displacement."""
TOUCH = 1e-3
"""First guess of a displacement in penetration tolerances, so that something touches."""


class TimedIndentationPath(TimedPath):
    """Follows the prescribed history; ``height`` in m is that of the body at first touch."""

    def __init__(self, experiment: TimedIndentationSetup, model: IndentationModel):
        self.height = model.touching_height(experiment.body)
        stiffest = max(shear_relaxation(material).instantaneous_modulus for material in experiment.specimen.materials)
        share = min(1.0, experiment.tolerance / (LEAST_PENETRATION * experiment.contact_radius))
        length = SWITCH_LENGTH * experiment.contact_radius
        scale = Regularisation(experiment.tolerance, share * stiffest, switch_length=length)
        contact = model.start([(experiment.body, self.height)], experiment.contact, scale)
        start = TimedState.at_rest(model.body, contact, 1)
        course = stretches([experiment.loading.history()], experiment.loading.duration)
        super().__init__(PressedBody(experiment, model), IndentationPace(experiment), course, start)


class PressedBody:
    """Answers the displacement in m or the force in N of the body."""

    def __init__(self, experiment: TimedIndentationSetup, model: IndentationModel):
        self._model, self._tolerance = model, experiment.tolerance
        self._by_force = experiment.loading.control == "force"

    @property
    def body(self) -> Body:
        """The tissue."""
        return self._model.body

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, past: PastStress | None
    ) -> ContactEquilibrium:
        """The equilibrium at a displacement or force, reached from ``now``."""
        if not self._by_force:
            return self._model.equilibrium(now, loads[0], guess[:-1], past=past)
        travel = guess[-1] if guess[-1] > 0 else TOUCH * self._tolerance
        return self._model.equilibrium(now, travel, guess[:-1], force=loads[0], past=past)


class IndentationPace:
    """Steps of time with a controlled error."""

    def __init__(self, experiment: TimedIndentationSetup):
        self._experiment = experiment

    def control(self, stretch: Stretch) -> TimeControl:
        """Begins with the first step of the settings."""
        first = self._experiment.first_step(stretch.duration)
        return TimeControl(self._experiment.time.tolerance, first=first, smallest=SMALLEST_SHARE * first)

    def largest(self, stretch: Stretch) -> float:
        """Longest step in s."""
        duration = stretch.duration
        return min(duration, stretch.shortest_period) / LOAD_STEPS if stretch.changes else duration

    def stops(self, stretch: Stretch) -> list[float]:
        """Times in s at which a step must end."""
        return self._experiment.time.stops(stretch.start, stretch.end)
