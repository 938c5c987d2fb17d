"""The path of a grasp: jaws that close or press, and pressures in lumens."""

from __future__ import annotations

from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.fem.pressure import FollowerPressure
from tactsim.mechanics.block_model import GraspModel
from tactsim.mechanics.history_path import TimedPath, TimedState, smooth_intervals
from tactsim.mechanics.pressed_body import PressedBody

TOUCH = 0.02
"""First guess of a closing under a force, so that the jaws touch, over the penetration without multipliers."""
LUMEN = "lumen:"
"""Beginning of the names of facets inside a hollow tube."""
FIRST_PART = 0.6
"""Part of a closing by which the first guess compresses the block: Newton comes from there in fewest iterations, of 0.5 to 1."""


def grasp_path(experiment: GraspSetup, model: GraspModel) -> TimedPath:
    """The path through all histories of a grasp, from jaws that just touch."""
    course = smooth_intervals(experiment.histories(), experiment.duration)
    contact = model.start(experiment.contact, experiment.regularisation())
    start = TimedState.at_rest(model.body, contact, 1 + len(experiment.lumens))
    return TimedPath(grasped_block(experiment, model), experiment.time.policy(experiment.materials), course, start)


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
        first_displacement=TOUCH * experiment.softness,
        walls=[FollowerPressure(model.space, wall, model.body.pattern, 0.0) for wall in facets],
        first_guess=None if hollow else lambda closing: model.compressed(FIRST_PART * closing),
    )
