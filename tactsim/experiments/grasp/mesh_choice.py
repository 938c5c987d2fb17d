"""Which mesh serves a block with these inclusions between these jaws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.contact.jaw import Jaw
from tactsim.errors import ConvergenceError
from tactsim.interfaces import Inclusion
from tactsim.mechanics.models.block_source import (
    AnyBlockSource,
    AnySource,
    AutomaticSource,
    GradedSource,
    Size,
    SourcedBlock,
    TetrahedraSource,
)
from tactsim.mesh.any_inclusion import inclusion_name


@dataclass(frozen=True)
class PlacedJaw:
    """A jaw, and the place (2,) in m of the middle of its face on the block, whose corner is the origin."""

    jaw: Jaw
    middle: Array

    @property
    def flat(self) -> Array:
        """Low and high corner (2, 2) in m of the flat of the face, without the rounded edges, seen along z."""
        turn = np.abs(self.jaw.rotation[:2, :2])
        half = turn @ (np.array([self.jaw.width, self.jaw.depth]) / 2 - self.jaw.fillet)
        return np.stack([self.middle - half, self.middle + half])


def chosen_source(mesh: AnyBlockSource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[PlacedJaw]) -> AnySource:
    """Where the mesh of a block of a size in m comes from, as far as inclusions and jaws say without making it."""
    return mesh.chosen(size, shapes, _flats(size, jaws)) if isinstance(mesh, AutomaticSource) else mesh


def grasp_mesh(mesh: AnyBlockSource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[PlacedJaw]) -> SourcedBlock:
    """The mesh of a block of a size in m, finer at the edges of jaws that are smaller than the block.

    Tetrahedra are finer there only if both jaws are equal and stand in the middle.

    Raises
    ------
    InputError
        If the inclusions or the sizes do not suit the block.
    ConvergenceError
        If no mesh keeps the volumes and the shapes.
    """
    source = chosen_source(mesh, size, shapes, jaws)
    try:
        return _sourced(source, size, shapes, jaws)
    except ConvergenceError:
        if not isinstance(mesh, AutomaticSource) or source is mesh.tetrahedra:
            raise
    return _sourced(mesh.tetrahedra, size, shapes, jaws)


def _sourced(source: AnySource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[PlacedJaw]) -> SourcedBlock:
    """The mesh of a source between these jaws."""
    flats = _flats(size, jaws)
    if isinstance(source, GradedSource):
        return source.sourced(size, shapes, flats)
    widths = {(placed.jaw.width, placed.jaw.depth) for placed in jaws}
    centred = all((placed.middle == np.array(size[:2]) / 2).all() for placed in jaws)
    if isinstance(source, TetrahedraSource) and source.jaw is None and centred and len(widths) == 1 and flats:
        source = source.model_copy(update={"jaw": widths.pop()})
    return source.sourced(size, shapes)


def _flats(size: Size, jaws: Sequence[PlacedJaw]) -> list[Array]:
    """The flats of the jaws, none if all jaws are at least as large as the block."""
    if all(placed.jaw.width >= size[0] and placed.jaw.depth >= size[1] for placed in jaws):
        return []
    return [placed.flat for placed in jaws]


def check_served(mesh: AnyBlockSource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[PlacedJaw]) -> None:
    """Refuse a kind of mesh that cannot follow the inclusions.

    Raises
    ------
    ValueError
        With the kind, the inclusion and what to take instead.
    """
    from tactsim.mesh.graded.block import graded_misfit

    for number, shape in enumerate(shapes, 1):
        if shape.hollow and mesh.kind == "structured":
            raise ValueError(
                f"mesh.kind: structured cannot follow the wall of {inclusion_name(number, shape)}; take kind: tetrahedra"
            )
    one_ball = len(shapes) == 1 and shapes[0].solids(np.asarray(size, float))[0].ball_image() is not None
    if mesh.kind == "layers" and not one_ball:
        raise ValueError("mesh.kind: layers serves exactly one sphere or ellipsoid; take kind: tetrahedra")
    misfit = graded_misfit(size, shapes, _flats(size, jaws)) if mesh.kind == "graded" else None
    if misfit is not None:
        raise ValueError(f"mesh.kind: graded: {misfit}; take kind: tetrahedra")
