"""Which mesh serves a block with these inclusions between these jaws."""

from __future__ import annotations

from collections.abc import Sequence

from tactsim.contact.jaw import Jaw
from tactsim.errors import ConvergenceError
from tactsim.interfaces import Inclusion
from tactsim.mechanics.models.block_source import AnyBlockSource, AnySource, AutomaticSource, Size, SourcedBlock, TetrahedraSource


def chosen_source(mesh: AnyBlockSource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[Jaw]) -> AnySource:
    """Where the mesh of a block of a size in m comes from, as far as inclusions and jaws say without making it."""
    return mesh.chosen(size, shapes, covered=_covered(size, jaws)) if isinstance(mesh, AutomaticSource) else mesh


def grasp_mesh(
    mesh: AnyBlockSource, size: Size, shapes: Sequence[Inclusion], jaws: Sequence[Jaw], *, centred: bool
) -> SourcedBlock:
    """The mesh of a block of a size in m; tetrahedra are finer at the edges of ``centred`` jaws smaller than the block.

    Raises
    ------
    InputError
        If the inclusions or the sizes do not suit the block.
    ConvergenceError
        If no mesh keeps the volumes and the shapes.
    """
    source = chosen_source(mesh, size, shapes, jaws)
    widths = {(jaw.width, jaw.depth) for jaw in jaws}
    if isinstance(source, TetrahedraSource) and source.jaw is None and centred and len(widths) == 1 and not _covered(size, jaws):
        source = source.model_copy(update={"jaw": widths.pop()})
    try:
        return source.sourced(size, shapes)
    except ConvergenceError:
        if not isinstance(mesh, AutomaticSource) or source is mesh.tetrahedra:
            raise
    return mesh.tetrahedra.sourced(size, shapes)


def _covered(size: Size, jaws: Sequence[Jaw]) -> bool:
    """Whether all jaws are at least as large as the block."""
    return all(jaw.width >= size[0] and jaw.depth >= size[1] for jaw in jaws)
