"""Edges of jaws around which a closing draws the tissue: what they ask of cells and contact there.

Tissue follows a jaw that is smaller than the block around its rounded edge, once it is closed by more than the radius. A cell
that is longer than the radius cannot: its surface touches the edge at a point or two, which open and close in turns from one
augmentation of the contact to the next. With cells of half the radius, and a contact that gives way by a small part of it, it
follows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.materials.viscoelasticity import shear_relaxation
from tactsim.mechanics.models.block_source import GradedSource
from tactsim.mesh.graded.beside_jaws import THINNER
from tactsim.mesh.graded.lines import edge_thickness

CELL_SHARE = 0.5
"""Thickness of cells at such an edge over its radius, at most.

Jaws of 30 mm on a block of 60 x 60 x 30 mm of ICF, edges of 0.5 mm, closed by 2.5 mm at friction 0.2: with the usual cells of
1.2 mm it ends at 1.9 mm, with cells of 0.5 mm at 2.3 mm; with these it takes 52 s. Around edges of 1 mm cells of 1.2, 1 and 0.5
mm all lead to the end, 6.381, 6.377 and 6.394 N in 8, 5 and 13 s; cells of a third of the radius give 6.370 N."""
LEAST_OF_USUAL = 0.2
"""Thickness of such cells over the usual one, at least: sharper edges are left as they are.

Why: the block above needs the cells with edges of 0.5 mm too, a fifth as thick as usual. On a block of 40 x 40 x 20 mm edges
of 0.3 and 0.1 mm converge without them, in 6 to 18 s for a closing of 1.6 mm; with them 0.3 mm takes 45 s, 0.1 mm has no end."""
SOFTNESS_SHARE = 0.03
"""Penetration that the contact would have without multipliers, over the radius, at most: with 0.15 the augmentations there
overshoot (the case above with cells of 0.38 mm takes 101 s instead of 18 s), and at edges of 0.5 mm they find no end."""


def drawn_radius(experiment: GraspSetup) -> float:
    """Least radius in m of the rounded edges of jaws around which the closing draws the tissue, and cells can follow it; infinite
    if there is none."""
    size, flats = experiment.block.size, experiment.flats
    if not flats:
        return math.inf
    closing = _closing(experiment, flats)
    least = LEAST_OF_USUAL / CELL_SHARE * THINNER * edge_thickness(GradedSource().settings(size, flats))
    radii = [
        experiment.jaw(side).fillet
        for side, (low, high) in zip(JAWS, flats, strict=True)
        if (low > 0).any() or (high < size[:2]).any()
    ]
    return min((radius for radius in radii if least <= radius < closing), default=math.inf)


def _closing(experiment: GraspSetup, flats: Sequence[Array]) -> float:
    """Bound of the closing of each jaw in m: the prescribed one, or that of a relaxed column as wide as the smaller flat under
    the force; the tissue around it holds it back."""
    largest = experiment.loading.largest_displacement
    if largest is not None:
        return largest
    modulus = 3 * shear_relaxation(experiment.block.tissue).equilibrium_modulus
    area = min(float(np.prod(np.ptp(flat, axis=0))) for flat in flats)
    strain = experiment.loading.least_and_most()[1] / (modulus * area) if modulus * area > 0 else math.inf
    return strain * experiment.block.size[2] / 2


def following(source: GradedSource, experiment: GraspSetup) -> GradedSource:
    """The cells, so thin at the edges of jaws that they follow these, unless the case says how thin they are."""
    wanted = CELL_SHARE / THINNER * drawn_radius(experiment)
    usual = edge_thickness(source.settings(experiment.block.size, experiment.flats))
    if source.edge_size is not None or usual <= wanted:
        return source
    return source.model_copy(update={"edge_size": wanted})
