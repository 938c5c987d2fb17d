"""Where the mesh of a block comes from: made of tetrahedra, or built of cells.

What makes a mesh is loaded when one is made, so that a wrong word in a case is reported without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.mesh.any_inclusion import inclusion_name
from tactsim.mesh.block import FULL_SIDE, BlockMesh, BlockMeshSettings, LumpFilling, MesherSettings, part_of_usual
from tactsim.mesh.sizing import at_jaw_edges
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive

Size = tuple[float, float, float]
TOUCHING = 1e-5
"""Distance in m below which bodies touch, where no mesh is made to follow them."""
ROUND_OFF = 1e-9
"""Relative difference of lengths that are meant to be equal."""
GAP_SHARE = 0.125
"""Least distance of a lump from the faces, in element sizes near it, where cells are built around it."""


@dataclass(frozen=True)
class SourcedBlock:
    """A mesh of a block, the hash of its content, and where it comes from in words."""

    block: BlockMesh
    content: str
    origin: str
    made_before: bool = False
    """Whether it was read, so that the time in which it was made is none of this run's."""

    @classmethod
    def of(cls, block: BlockMesh, origin: str) -> Self:
        """A mesh that was just made."""
        from tactsim.mesh.mesh_store import content_hash

        return cls(block, content_hash(block.mesh), origin)


class BlockSource(FrozenModel):
    """What gives the mesh of a block."""

    finer: ClassVar[str] = "take a smaller mesh.edge_size at the edges of the jaws, a smaller mesh.inclusion_size at an inclusion"
    """What makes elements smaller where they lose their volume, in the words of the case."""
    nearer: ClassVar[str] = ""
    """What lets inclusions be nearer to each other and to faces, in the words of the case; empty if nothing does."""

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """The kind, and why its mesh cannot follow the inclusions in a block of this size in m, between jaws that have these
        ``flats`` (2, 2) in m inside it; None if it can."""
        return None

    def least_gap(self, size: Size) -> float:
        """Least distance in m between inclusions, and from faces, in a block of this size in m."""
        return TOUCHING


class SizedSource(MesherSettings, BlockSource):
    """Elements by the lengths of their edges."""

    nearer: ClassVar[str] = "less with a smaller mesh.inclusion_size"
    usual: ClassVar[dict[str, float]] = {"size": 3.3e-3, "inclusion_size": 2.6e-3}
    """Edge lengths in m that a case leaves out, in a block whose sides are `FULL_SIDE` at least."""
    size: Positive[Length] | None = None
    """Edge length far from inclusions and jaw edges; by default 3.3 mm, or 0.165 of the block's least side if that is less."""
    inclusion_size: Positive[Length] | None = None
    """Edge length at inclusions, smaller by itself at a thin wall; by default 2.6 mm, or 0.13 of the block's least side if that
    is less."""

    def settings(self, size: Size, flats: Sequence[Array] = ()) -> BlockMeshSettings:
        """The lengths themselves in a block of this size in m, between jaws that have these ``flats`` (2, 2) in m inside it."""
        part = part_of_usual(size)
        usual = {name: part * length for name, length in self.usual.items()}
        given = self.model_dump(exclude={"kind"}, exclude_none=True)
        settings = BlockMeshSettings.model_validate(usual | given)
        sides = [float(side) for flat in flats for side in np.diff(flat, axis=0)[0]]
        narrower = min([part, *(side / FULL_SIDE for side in sides)]) / part
        if self.edge_size is not None or narrower > 1 - ROUND_OFF:
            return settings
        return settings.model_copy(update={"edge_size": narrower * (settings.edge_size or at_jaw_edges(settings))})

    def least_gap(self, size: Size) -> float:
        """Least distance in m between inclusions, and from faces, in a block of this size in m."""
        return self.settings(size).least_gap


class TetrahedraSource(SizedSource):
    """Tetrahedra that follow the inclusions, made once and kept."""

    usual: ClassVar[dict[str, float]] = SizedSource.usual | {"size": 3e-3}
    """With 3.3 mm taxels that should be equal differed by up to 0.39 % of the largest, with 3 mm by 0.2 %."""
    kind: Literal["tetrahedra"] = "tetrahedra"
    size: Positive[Length] | None = None
    """Edge length far from inclusions and jaw edges; by default 3 mm, or 0.15 of the block's least side if that is less."""

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh of a block of this size in m, shipped, cached, or made now; finer at edges of narrow ``flats`` (2, 2) in m.

        Raises
        ------
        StorageError
            If a shipped mesh is not the one its manifest describes.
        InputError, ConvergenceError
            As ``tetrahedra.block_mesh``.
        """
        from tactsim.mesh.mesh_store import stored_block_mesh

        stored = stored_block_mesh(size, inclusions, self.settings(size, flats))
        return SourcedBlock(stored.block, stored.content, stored.origin, made_before=stored.origin != "made")


class LayersSource(SizedSource):
    """Layers of cells around one sphere or ellipsoid: lumps moved or turned have meshes of one topology."""

    kind: Literal["layers"]

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """That there is no sphere or ellipsoid, or not only one; ``flats`` (2, 2) do not matter."""
        served = len(inclusions) == 1 and inclusions[0].solids(np.asarray(size, float))[0].ball_image() is not None
        return None if served else "layers serves exactly one ball, stretched or not"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh of a block of this size in m around its only inclusion, whatever the ``flats`` (2, 2).

        Raises
        ------
        InputError
            If there is not exactly one inclusion.
        """
        from tactsim.mesh.structured_block import morphed_block

        if len(inclusions) != 1:
            raise InputError(f"mesh.kind: layers serves exactly one inclusion, not {len(inclusions)}; take kind: tetrahedra")
        return SourcedBlock.of(morphed_block(size, inclusions[0], self.settings(size)), "built in layers")


class GradedSource(SizedSource):
    """Few cells, thin at the faces, rounded around spheres and ellipsoids, in rings around tubes: the fastest for its accuracy.
    Several lumps are served where along x, y or z one of each two ends before the other begins."""

    usual: ClassVar[dict[str, float]] = {"size": 6e-3, "inclusion_size": 2e-3, "edge_size": 1.6e-3}
    kind: Literal["graded"] = "graded"
    size: Positive[Length] | None = None
    """Edge length far from the inclusion and the faces; by default 6 mm, or 0.3 of the block's least side if that is less."""
    inclusion_size: Positive[Length] | None = None
    """Edge length at the inclusion, about; three to five cells across it at least, by its size and place. By default 2 mm, or 0.1
    of the block's least side if that is less."""
    edge_size: Positive[Length] | None = None
    """Thickness of cells at the faces, from which they grow at once; by default 1.6 mm, or 0.08 of the least side of the block
    and of the jaws' flats if that is less. Where a jaw is smaller than the block, they are three quarters as thick, and thin also
    on both sides of its edges; by default at most half as thick as these are round where they close by more than their radius."""
    growth: Annotated[float, Field(gt=0, le=2)] = 1.0
    """By how much a cell is thicker than the one before it, nearer to a face, over that one's thickness."""
    filling: LumpFilling = "cells"
    """What a lump holds: cells, or a fan of tetrahedra from its surface to its middle, which saves a seventh to a fifth of the
    unknowns. Taxels are the same to 0.05 % of the largest; strains in the lump are those of one element from its middle to its
    surface."""

    def least_gap(self, size: Size) -> float:
        """Least distance in m between the inclusion and the faces of a block of this size in m."""
        return GAP_SHARE * self.settings(size).inclusion_size

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """Which of the inclusions are of other forms, in each other's way, or below the edge of ``flats`` (2, 2) in m."""
        from tactsim.mesh.graded.block import graded_misfit

        reason = graded_misfit(size, inclusions, flats, self.settings(size, flats))
        return reason and f"graded: {reason}"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh of a block of this size in m around its inclusions, if any; with the edges of ``flats`` (2, 2) in m.

        Raises
        ------
        InputError, ConvergenceError
            As ``graded_block``.
        """
        from tactsim.mesh.graded.block import graded_block

        block = graded_block(size, inclusions, self.settings(size, flats), flats)
        origin = "graded cells"
        if block.fewer_layers:
            origin += f", layers fewer than usual around inclusions close to each other or to a face: {block.fewer_layers}"
        return SourcedBlock.of(block, origin)


class StructuredSource(BlockSource):
    """A grid of equal cells, six tetrahedra each; an inclusion takes those whose centre lies in it, so that it is ragged."""

    finer: ClassVar[str] = "take more mesh.cells"
    kind: Literal["structured"]
    cells: tuple[Annotated[int, Field(ge=1, le=500)], Annotated[int, Field(ge=1, le=500)], Annotated[int, Field(ge=1, le=500)]]
    """Number of cells along x, y and z."""

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """Which hollow inclusion its elements cannot follow; ``flats`` (2, 2) do not matter."""
        hollow = next((inclusion_name(k, one) for k, one in enumerate(inclusions, 1) if one.hollow), None)
        return hollow and f"structured cannot follow the wall of {hollow}"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh of a block of this size in m, whatever the ``flats`` (2, 2).

        Raises
        ------
        InputError
            If the cells are so coarse that no element lies in an inclusion.
        """
        from tactsim.mesh.structured_block import structured_block

        block = structured_block(size, self.cells, inclusions)
        for number, volume in enumerate(block.volumes[:, 0]):
            if volume == 0:
                raise InputError(
                    f"mesh.cells {list(self.cells)} are too coarse: no element lies in {block.region_names[number]}; "
                    "take more cells, or leave mesh out: the inclusions then decide on it"
                )
        return SourcedBlock.of(block, "structured")
