"""What a grasp is computed with: the mesh of its block, and the finite element model on it."""

from __future__ import annotations

import numpy as np

from tactsim.errors import ConvergenceError
from tactsim.experiments.grasp.drawn_edges import following
from tactsim.experiments.grasp.setup import GraspSetup
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.models.any_block_source import AnySource, AutomaticSource
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.block_source import GradedSource, SourcedBlock, TetrahedraSource


def grasp_mesh(experiment: GraspSetup) -> SourcedBlock:
    """The mesh of the block, finer at the edges of jaws that are smaller than it; tetrahedra only if these are equal and centred.

    Raises
    ------
    InputError
        If the inclusions or the sizes do not suit the block.
    ConvergenceError
        If no mesh keeps the volumes and the shapes.
    """
    mesh, source = experiment.mesh, experiment.source
    try:
        return _sourced(experiment, source)
    except ConvergenceError:
        if not isinstance(mesh, AutomaticSource) or source is mesh.tetrahedra:
            raise
    return _sourced(experiment, mesh.tetrahedra)


def _sourced(experiment: GraspSetup, source: AnySource) -> SourcedBlock:
    """The mesh of this source between the jaws."""
    size, shapes, flats = experiment.block.size, experiment.shapes, experiment.flats
    widths = {(jaw.width, jaw.depth) for jaw in map(experiment.jaw, JAWS)}
    centred = not any(experiment.upper.offset + experiment.lower.offset)
    if isinstance(source, TetrahedraSource) and source.jaw is None and centred and len(widths) == 1 and flats:
        source = source.model_copy(update={"jaw": widths.pop()})
    if isinstance(source, GradedSource):
        source = following(source, experiment)
    return source.sourced(size, shapes, flats)


def grasp_model(experiment: GraspSetup, sourced: SourcedBlock) -> GraspModel:
    """The finite element model on a mesh of the block."""
    return GraspModel(
        sourced.block.mesh,
        experiment.materials,
        sourced.block.facets,
        jaws=[experiment.jaw(side) for side in JAWS],
        offsets=np.array([jaw.middle(experiment.block.size) for jaw in (experiment.upper, experiment.lower)]),
        balance=experiment.solver.balance,
    )
