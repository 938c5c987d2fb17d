"""Warnings about a grasp: its mesh, its taxels, and what in its case looks like a slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tactsim.experiments.grasp.overhang import overhang_warnings
from tactsim.experiments.grasp.readings import JawReading
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.fem.assembly.material_forms import interpreted_warnings
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.outcome.plausibility import oddities
from tactsim.mesh.any_inclusion import inclusion_name
from tactsim.mesh.block import BlockMesh
from tactsim.results import StepRecord
from tactsim.units import format_quantity

RAGGED, SUCTION = 0.05, 0.01
"""Errors of a region's volume, and pulls on a taxel over the largest force on one, of which a user is warned."""
LET_GO = 1e-2
"""Force of the jaws over the largest before, below which they hold the block no more."""
VISIBLE = 0.01
"""Asymmetry of a symmetric grasp's forces of which a user is warned: what the least palpable lump changes a taxel by."""


def ragged(block: BlockMesh) -> list[str]:
    """Regions whose volume the mesh misses."""
    return [
        f"the mesh gives {name} {100 * error:+.0f} % of its volume too much or too little: take smaller elements"
        for name, error in zip(block.region_names, block.volume_errors, strict=True)
        if abs(error) > RAGGED
    ]


def smaller_elements(block: BlockMesh) -> list[str]:
    """A warning if elements had to be smaller than asked for to follow the inclusions."""
    if block.part == 1:
        return []
    return [
        f"elements at inclusions {block.part:g} times as long as mesh.inclusion_size: with longer ones the mesh missed the "
        "volume or the shape of an inclusion"
    ]


def suction(readings: Sequence[Mapping[str, JawReading]]) -> list[str]:
    """Taxels that are pulled, which contact without adhesion cannot do."""
    forces = [reading[side].taxels.taxels[2] for reading in readings for side in JAWS]
    least, most = (min(map(np.min, forces)), max(map(np.max, forces))) if forces else (0.0, 0.0)
    if least >= -SUCTION * most:
        return []
    pull = format_quantity(-float(least), "N")
    return [f"a taxel is pulled by up to {pull}: it is smaller than the mesh resolves; take smaller elements at the faces"]


def uneven(asymmetry: float | None) -> list[str]:
    """Forces of a symmetric grasp that the mesh makes unlike; None is a grasp without symmetry."""
    if asymmetry is None or asymmetry <= VISIBLE:
        return []
    return [
        f"the grasp is its own mirror image, but its taxels differ from theirs by up to {100 * asymmetry:.1f} % of the largest "
        "force: the mesh shows in the forces, and nothing smaller than this should be read from a single taxel; take smaller "
        "elements"
    ]


def let_go(steps: Sequence[StepRecord]) -> str:
    """What led a grasp to its failure if the jaws hardly pressed any more: nothing then holds the block, and no mesh helps."""
    forces = [step.values["reaction_force"] for step in steps]
    if not forces or forces[-1] >= LET_GO * max(forces):
        return ""
    last, largest = (format_quantity(force, "N") for force in (max(forces[-1], 0.0), max(forces)))
    return (
        f". The jaws had let go of the block: they pressed with {last}, after {largest}, so that nothing held it; let the "
        "loading end before that, for tissue that relaxes follows opening jaws slowly"
    )


def doubts(grasp: GraspSetup) -> list[str]:
    """What looks wrong in a case before it is computed: taxels beside the block, and sizes and materials like a wrong unit."""
    return [*overhang_warnings(grasp), *unlikely(grasp)]


def unlikely(grasp: GraspSetup) -> list[str]:
    """Sizes and materials that look like a wrong unit."""
    materials = {"block.tissue": grasp.block.tissue}
    materials |= {f"the material of {inclusion_name(k, e.shape)}": e.material for k, e in enumerate(grasp.inclusions, 1)}
    tissue = {f"block.size along {axis}": side for axis, side in zip("xyz", grasp.block.size, strict=True)}
    jaws = {f"{side}.{name}": getattr(getattr(grasp, side), name) for side in JAWS for name in ("width", "depth")}
    given = {name: length for name, length in jaws.items() if length is not None}  # others follow from the block
    warnings = oddities(materials, tissue=tissue, bodies=given | {"matrix.size": grasp.matrix.size})
    return [*warnings, *interpreted_warnings(materials)]
