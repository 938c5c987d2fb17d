"""What a grasp is computed with: the mesh of its block, and the finite element model on it."""

from __future__ import annotations

import numpy as np

from tactsim.errors import ConvergenceError
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.block_source import AutomaticSource, SourcedBlock, TetrahedraSource


def grasp_mesh(experiment: GraspSetup) -> SourcedBlock:
    """The mesh of the block; tetrahedra are finer at the edges of equal, centred jaws that are smaller than it.

    Raises
    ------
    InputError
        If the inclusions or the sizes do not suit the block.
    ConvergenceError
        If no mesh keeps the volumes and the shapes.
    """
    mesh, source, size, shapes = experiment.mesh, experiment.source, experiment.block.size, experiment.shapes
    widths = {(jaw.width, jaw.depth) for jaw in map(experiment.jaw, JAWS)}
    centred = not any(experiment.upper.offset + experiment.lower.offset)
    if isinstance(source, TetrahedraSource) and source.jaw is None and centred and len(widths) == 1 and not experiment.covered:
        source = source.model_copy(update={"jaw": widths.pop()})
    try:
        return source.sourced(size, shapes)
    except ConvergenceError:
        if not isinstance(mesh, AutomaticSource) or source is mesh.tetrahedra:
            raise
    return mesh.tetrahedra.sourced(size, shapes)


def grasp_model(experiment: GraspSetup, sourced: SourcedBlock) -> GraspModel:
    """The finite element model on a mesh of the block."""
    middle = np.array(experiment.block.size[:2]) / 2
    return GraspModel(
        sourced.block.mesh,
        experiment.materials,
        sourced.block.facets,
        jaws=[experiment.jaw(side) for side in JAWS],
        offsets=np.array([middle + experiment.upper.offset, middle + experiment.lower.offset]),
    )
