"""The course of a grasp: jaws that close or press, and pressures in lumens."""

from __future__ import annotations

import numpy as np

from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.experiments.indentation.timed_setup import FIRST_SHARE, SMALLEST_SHARE
from tactsim.fem.body import Body, PastStress
from tactsim.fem.pressure import FollowerPressure
from tactsim.fem.time_steps import TimeControl
from tactsim.mechanics.block_model import GraspModel
from tactsim.mechanics.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.history_path import Stretch, TimedPath, TimedState, stretches

Array = np.ndarray

SMALLEST_LOAD_STEP = 1e-3
"""Smallest load step of elastic tissue, as a part of the largest."""
MANY_ITERATIONS = 60
"""Newton iterations of a step, those of every augmentation together, beyond which the next one is not longer."""
TOUCH = 0.02
"""First guess of a closing under a force, so that the jaws touch, over the penetration without multipliers."""
LUMEN = "lumen:"
"""Beginning of the names of facets inside a hollow tube."""
FIRST_PART = 0.6
"""Part of a closing by which the first guess compresses the block: Newton comes from there in fewest iterations, of 0.5 to 1."""


def grasp_path(experiment: GraspSetup, model: GraspModel) -> TimedPath:
    """The path through all histories of a grasp, from jaws that just touch."""
    course = stretches(experiment.histories(), experiment.duration)
    contact = model.start(experiment.contact, experiment.regularisation())
    start = TimedState.at_rest(model.body, contact, 1 + len(experiment.lumens))
    return TimedPath(GraspedBlock(experiment, model), GraspPace(experiment), course, start)


class GraspedBlock:
    """Answers the closing in m or the force in N of each jaw, and the pressure in Pa of each lumen.

    The first guess of a closing is a uniform compression by part of it, unless a tube is hollow: its wall gives way, and Newton
    does not find back from there.
    """

    def __init__(self, experiment: GraspSetup, model: GraspModel):
        self._model, self._touch = model, TOUCH * experiment.softness
        self._by_force = experiment.loading.control == "force"
        self._hollow = any(name.startswith(LUMEN) for name in model.facets)
        facets = [model.facets[f"{LUMEN}{number}"] for number in experiment.lumens]
        self._walls = [FollowerPressure(model.space, wall, model.body.pattern, 0.0) for wall in facets]

    @property
    def body(self) -> Body:
        """The block."""
        return self._model.body

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, past: PastStress | None
    ) -> ContactEquilibrium:
        """The equilibrium under a closing or force and pressures; jaws without a force stay where they are."""
        model, pressures = self._model, [wall.at(p) for wall, p in zip(self._walls, loads[1:], strict=True)]
        if not self._by_force:
            if loads[0] > now.load and not now.unknowns.any() and not self._hollow:
                guess = np.append(model.compressed(FIRST_PART * loads[0]), loads[0])
            return model.equilibrium(now, loads[0], guess[:-1], past=past, loads=pressures)
        if loads[0] == 0:
            return model.equilibrium(now, now.load, guess[:-1], past=past, loads=pressures)
        travel = guess[-1] if guess[-1] > 0 else self._touch
        return model.equilibrium(now, travel, guess[:-1], force=loads[0], past=past, loads=pressures)


class GraspPace:
    """Equal load steps of elastic tissue; steps of time with a controlled error if a material relaxes."""

    def __init__(self, experiment: GraspSetup):
        self._settings, self._relaxes, self._shortest = experiment.time, experiment.relaxes, experiment.shortest_time

    def control(self, stretch: Stretch) -> TimeControl:
        """How steps of a stretch grow and shrink."""
        if not self._relaxes:
            largest = self.largest(stretch)
            return TimeControl(1.0, first=largest, smallest=SMALLEST_LOAD_STEP * largest, many_iterations=MANY_ITERATIONS)
        shortest = min(stretch.duration, self._shortest) if stretch.sudden else stretch.duration
        first = min(stretch.duration, self._settings.first or FIRST_SHARE * shortest)
        smallest = SMALLEST_SHARE * first
        return TimeControl(self._settings.tolerance, first=first, smallest=smallest, many_iterations=MANY_ITERATIONS)

    def largest(self, stretch: Stretch) -> float:
        """Longest step in s."""
        ramped = any(segment.slope != 0 for segment in stretch.segments)
        by_ramp = stretch.duration / (self._settings.steps if ramped else 1)
        return min(by_ramp, stretch.shortest_period / self._settings.per_period)

    def stops(self, stretch: Stretch) -> list[float]:
        """Times in s at which a step must end."""
        return self._settings.stops(stretch.start, stretch.end) if self._relaxes else [stretch.end]
