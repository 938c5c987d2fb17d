"""The path of a grasp: jaws that close or press, and pressures in lumens."""

from __future__ import annotations

import math
from functools import partial

from tactsim.experiments.grasp.lumen_pressure import lumen_history
from tactsim.experiments.grasp.regularisation import regularisation
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.experiments.grasp.tissue_alone import tissue_alone
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.penetration_effect import bonded_block_rate
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.first_guess import FIRST_PART, FirstGuess
from tactsim.mechanics.models.pressed_body import PressedBody
from tactsim.mechanics.outcome.sufficient_contact import SufficientContact
from tactsim.mechanics.paths.history_path import EquilibriumProblem, TimedPath, TimedState, TimeInterval, smooth_intervals

TOUCH = 0.02
"""First guess of a closing under a force, so that the jaws touch, over the penetration without multipliers."""
LUMEN = "lumen:"
"""Beginning of the names of facets inside a hollow tube."""


def grasp_path(experiment: GraspSetup, model: GraspModel) -> TimedPath:
    """The path through all histories of a grasp, from jaws that just touch.

    Without a tolerance of its own, a grasp gets one at its largest closing or force with which it misses as little force as a
    success may.

    Raises
    ------
    InvalidQuantity
        If the histories ask for too many steps.
    InputError
        If a jaw does not meet the block.
    """
    start = TimedState.at_rest(
        model.body, model.start(experiment.contact, regularisation(experiment)), 1 + len(experiment.lumens)
    )
    problem: EquilibriumProblem = grasped_block(experiment, model)
    if experiment.penetration_tolerance is None:
        problem = SufficientContact(problem, experiment.loading.least_and_most()[1], stiffest_block(experiment))
    return TimedPath(problem, experiment.time.policy(experiment.materials), grasp_intervals(experiment), start)


def grasp_intervals(experiment: GraspSetup) -> tuple[TimeInterval, ...]:
    """The smooth intervals of the closing or the force, and of the pressure in each lumen."""
    duration, lumens = experiment.duration, experiment.lumens
    histories = [experiment.loading.history(), *(lumen_history(lumen, duration) for lumen in lumens.values())]
    return smooth_intervals(histories, duration)


def grasped_block(experiment: GraspSetup, model: GraspModel) -> PressedBody:
    """What answers the closing in m or the force in N of each jaw, and the pressure in Pa of each lumen.

    The first guess of a closing is that of the tissue without the inclusions, or else a uniform compression by part of it, unless
    a tube is hollow: its wall gives way, and Newton does not find back from there.
    """
    hollow = any(name.startswith(LUMEN) for name in model.facets)
    facets = [model.facets[f"{LUMEN}{number}"] for number in experiment.lumens]
    return PressedBody(
        model,
        by_force=experiment.loading.control == "force",
        first_displacement=TOUCH * regularisation(experiment).softness,
        walls=[FollowerPressure(model.space, wall, model.body.pattern, 0.0) for wall in facets],
        first_guess=None if hollow else partial(_first_guess, experiment, model),
    )


def _first_guess(experiment: GraspSetup, model: GraspModel, rest: ContactEquilibrium, closing: float) -> FirstGuess:
    """Where Newton begins in the undeformed block at ``rest``, to be closed by ``closing`` in m."""
    tissue = tissue_alone(experiment, closing)
    if tissue is None:
        return FirstGuess(rest, model.compressed(FIRST_PART * closing))
    return FirstGuess(tissue.expected_by(rest, closing), model.begun_as(tissue.displacement(model.mesh.nodes, closing)))


def stiffest_block(experiment: GraspSetup) -> float:
    """Bound of the growth of the contact pressure in Pa/m: needed where the pressure in a lumen presses against the jaws too."""
    if not experiment.lumens:
        return math.inf
    return bonded_block_rate(shear_relaxation(experiment.block.tissue).instantaneous_modulus, experiment.block.size)
