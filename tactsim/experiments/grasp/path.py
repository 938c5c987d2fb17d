"""The path of a grasp: jaws that close or press, and pressures in lumens."""

from __future__ import annotations

import math

from tactsim.contact.penalty import Augmentation
from tactsim.experiments.grasp.drawn_edges import SOFTNESS_SHARE, drawn_radius
from tactsim.experiments.grasp.lumen_pressure import lumen_history
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.materials.viscoelasticity import flows, shear_relaxation
from tactsim.mechanics.contact.penetration_bounds import small_part
from tactsim.mechanics.contact.penetration_effect import bonded_block_rate
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.pressed_body import PressedBody
from tactsim.mechanics.outcome.sufficient_contact import SufficientContact
from tactsim.mechanics.paths.history_path import EquilibriumProblem, TimedPath, TimedState, TimeInterval, smooth_intervals

SOFTNESS, SOFTNESS_OF_HEIGHT = 25.0, 2.5e-3
"""Penetration that the contact would have without multipliers, over the tolerance and at most over the height of the block."""
SMALL_CLOSING = 1e-2
"""Closing over the height of the block below which pressures are less in proportion, and so is the contact's pressure scale.

Why: in proportion to the tolerance alone, contact was the stiffer the smaller the closing; points stuck and slipped by turns, and
1 um found no way."""
SWITCH_OF_HEIGHT = 0.05
"""Length over which a violated contact counts as much as the largest pressure, over the height of the block."""
TOUCH = 0.02
"""First guess of a closing under a force, so that the jaws touch, over the penetration without multipliers."""
LUMEN = "lumen:"
"""Beginning of the names of facets inside a hollow tube."""
FIRST_PART = 0.6
"""Part of a closing by which the first guess compresses the block: of the parts from 0.5 to 1, Newton takes the fewest
iterations from this one."""


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


def regularisation(experiment: GraspSetup) -> Augmentation:
    """How stiff the contact is."""
    tissue = experiment.block.tissue
    softest = shear_relaxation(tissue).instantaneous_modulus
    height = experiment.block.size[2]
    softness = min(SOFTNESS * experiment.tolerance, SOFTNESS_OF_HEIGHT * height)
    softness = min(softness, max(experiment.tolerance, SOFTNESS_SHARE * drawn_radius(experiment)))
    part = small_part(experiment.loading.largest_displacement, SMALL_CLOSING * height)
    return Augmentation(
        experiment.tolerance,
        part * softest,
        switch_length=part * SWITCH_OF_HEIGHT * height,
        softness=softness,
        flows=flows(tissue),
    )


def grasped_block(experiment: GraspSetup, model: GraspModel) -> PressedBody:
    """What answers the closing in m or the force in N of each jaw, and the pressure in Pa of each lumen.

    The first guess of a closing is a uniform compression by part of it, unless a tube is hollow: its wall gives way, and Newton
    does not find back from there.
    """
    hollow = any(name.startswith(LUMEN) for name in model.facets)
    facets = [model.facets[f"{LUMEN}{number}"] for number in experiment.lumens]
    return PressedBody(
        model,
        by_force=experiment.loading.control == "force",
        first_displacement=TOUCH * regularisation(experiment).softness,
        walls=[FollowerPressure(model.space, wall, model.body.pattern, 0.0) for wall in facets],
        first_guess=None if hollow else lambda closing: model.compressed(FIRST_PART * closing),
    )


def stiffest_block(experiment: GraspSetup) -> float:
    """Bound of the growth of the contact pressure in Pa/m: needed where the pressure in a lumen presses against the jaws too."""
    if not experiment.lumens:
        return math.inf
    return bonded_block_rate(shear_relaxation(experiment.block.tissue).instantaneous_modulus, experiment.block.size)
