"""How stiff the contact between jaws and tissue is."""

from __future__ import annotations

from tactsim.contact.penalty import Augmentation
from tactsim.experiments.grasp.drawn_edges import SOFTNESS_SHARE, drawn_radius
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.materials.viscoelasticity import flows, shear_relaxation
from tactsim.mechanics.contact.penetration_bounds import small_part

SOFTNESS, SOFTNESS_OF_HEIGHT = 25.0, 2.5e-3
"""Penetration that the contact would have without multipliers, over the tolerance and at most over the height of the block."""
SMALL_CLOSING = 1e-2
"""Closing over the height of the block below which pressures are less in proportion, and so is the contact's pressure scale.

Why: in proportion to the tolerance alone, contact was the stiffer the smaller the closing; points stuck and slipped by turns, and
1 um found no way."""
SWITCH_OF_HEIGHT = 0.05
"""Length over which a violated contact counts as much as the largest pressure, over the height of the block."""


def regularisation(experiment: GraspSetup) -> Augmentation:
    """The regularisation of a grasp's contact."""
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
