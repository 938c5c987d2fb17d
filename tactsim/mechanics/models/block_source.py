"""Where the mesh of a block comes from: made of tetrahedra, built of cells, or read from a file.

What makes a mesh is loaded when one is made, so that a wrong word in a case is reported without it.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.mesh.affordable import check_unknowns
from tactsim.mesh.any_inclusion import inclusion_name
from tactsim.mesh.block import BlockMesh, BlockMeshSettings
from tactsim.mesh.foreign import LengthUnit
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.units import Length, NonNegative, Positive, format_quantity

if TYPE_CHECKING:
    from tactsim.mesh.fitting.labelling import Surfaces

Size = tuple[float, float, float]
FITS = 1e-6
"""Largest difference between the extent of a mesh from a file and the block, over the block's longest side."""
LEAST_SHARED = 0.5
"""Least part that a region of a mesh from a file shares with the inclusion of the case, of what either fills."""
TOUCHING = 1e-5
"""Distance in m below which bodies touch, where no mesh is made to follow them."""
GAP_SHARE = 0.125
"""Least distance of a lump from the faces, in element sizes near it, where cells are built around it."""


@dataclass(frozen=True)
class SourcedBlock:
    """A mesh of a block, the hash of its content, and where it comes from in words."""

    block: BlockMesh
    content: str
    origin: str

    @classmethod
    def of(cls, block: BlockMesh, origin: str) -> Self:
        """A mesh that was just made."""
        from tactsim.mesh.mesh_store import content_hash

        return cls(block, content_hash(block.mesh), origin)


def _sizes(source: BlockMeshSettings) -> BlockMeshSettings:
    """The element sizes of a source alone, by which meshes are named."""
    return BlockMeshSettings.model_validate(source.model_dump(exclude={"kind"}))


class BlockSource(FrozenModel):
    """What gives the mesh of a block."""

    finer: ClassVar[str] = "take a smaller mesh.edge_size at the edges of the jaws, a smaller mesh.inclusion_size at an inclusion"
    """What makes elements smaller where they lose their volume, in the words of the case."""

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """The kind, and why its mesh cannot follow the inclusions in a block of this size in m, between jaws that have these
        ``flats`` (2, 2) in m inside it; None if it can."""
        return None


class TetrahedraSource(BlockMeshSettings, BlockSource):
    """Tetrahedra that follow the inclusions, made once and kept."""

    kind: Literal["tetrahedra"] = "tetrahedra"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion]) -> SourcedBlock:
        """The mesh of a block of this size in m, shipped, from the cache, or made now."""
        from tactsim.mesh.mesh_store import stored_block_mesh

        stored = stored_block_mesh(size, inclusions, _sizes(self))
        return SourcedBlock(stored.block, stored.content, stored.origin)


class LayersSource(BlockMeshSettings, BlockSource):
    """Layers of cells around one sphere or ellipsoid: lumps moved or turned have meshes of one topology."""

    kind: Literal["layers"]

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """That there is no sphere or ellipsoid, or not only one."""
        served = len(inclusions) == 1 and inclusions[0].solids(np.asarray(size, float))[0].ball_image() is not None
        return None if served else "layers serves exactly one ball, stretched or not"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion]) -> SourcedBlock:
        """The mesh of a block of this size in m around its only inclusion.

        Raises
        ------
        InputError
            If there is not exactly one inclusion.
        """
        from tactsim.mesh.structured_block import morphed_block

        if len(inclusions) != 1:
            raise InputError(f"mesh.kind: layers serves exactly one inclusion, not {len(inclusions)}; take kind: tetrahedra")
        return SourcedBlock.of(morphed_block(size, inclusions[0], _sizes(self)), "built in layers")


class GradedSource(BlockMeshSettings, BlockSource):
    """Few cells, thin at the faces, rounded around spheres and ellipsoids, in rings around tubes: the fastest for its accuracy.
    Several lumps are served where along x, y or z one of each two ends before the other begins."""

    kind: Literal["graded"] = "graded"
    size: Positive[Length] = 6e-3
    """Edge length far from the inclusion and the faces."""
    inclusion_size: Positive[Length] = 2e-3
    """Edge length at the inclusion, about; three to five cells across it at least, by its size and place."""
    edge_size: Positive[Length] | None = 1.6e-3
    """Thickness of cells at the faces, from which they grow at once; null means a third of size. Where a jaw is smaller than the
    block, they are three quarters as thick, and thin also on both sides of its edges."""
    growth: Annotated[float, Field(gt=0, le=2)] = 1.0
    """By how much a cell is thicker than the one before it, nearer to a face, over that one's thickness."""

    @property
    def least_gap(self) -> float:
        """Least distance in m between the inclusion and the faces."""
        return GAP_SHARE * self.inclusion_size

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """Which of the inclusions are of other forms, in each other's way, or below the edge of a jaw."""
        from tactsim.mesh.graded.block import graded_misfit

        reason = graded_misfit(size, inclusions, flats)
        return reason and f"graded: {reason}"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh of a block of this size in m around its inclusions, if any; with the edges of ``flats`` (2, 2) in m."""
        from tactsim.mesh.graded.block import graded_block

        block = graded_block(size, inclusions, _sizes(self), flats)
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

    @property
    def least_gap(self) -> float:
        """Least distance in m between inclusions, and from faces."""
        return TOUCHING

    def misfit(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> str | None:
        """Which hollow inclusion its elements cannot follow."""
        hollow = next((inclusion_name(k, one) for k, one in enumerate(inclusions, 1) if one.hollow), None)
        return hollow and f"structured cannot follow the wall of {hollow}"

    def sourced(self, size: Size, inclusions: Sequence[Inclusion]) -> SourcedBlock:
        """The mesh of a block of this size in m.

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


class FileSource(BlockSource):
    """A mesh made by another program, for the block and the inclusions that the case describes."""

    finer: ClassVar[str] = "make smaller elements there in the file"
    kind: Literal["file"]
    path: InputPath
    """Any file of tetrahedra that meshio reads."""
    unit: LengthUnit
    """Unit of its coordinates."""
    regions: dict[str, NonNegative[int]] | None = None
    """Region of each tag: 0 is the tissue, k the inclusion k counted from 1. Tags are whole numbers or names of groups."""
    tag: str | None = None
    """Name of the cell data with the tags; by default the first usual one in the file."""

    @property
    def least_gap(self) -> float:
        """Least distance in m between inclusions, and from faces."""
        return TOUCHING

    def sourced(self, size: Size, inclusions: Sequence[Inclusion]) -> SourcedBlock:
        """The mesh in the file, checked against the block and the number of inclusions.

        Raises
        ------
        InputError
            If the mesh has other regions or another size than the block of the case.
        """
        from tactsim.mesh.fitting.curving import assembled
        from tactsim.mesh.fitting.labelling import Surfaces
        from tactsim.mesh.mesh_store import content_hash
        from tactsim.mesh.reading import read_mesh
        from tactsim.mesh.wholeness import check_whole

        started = time.perf_counter()
        numbered = None if self.regions is None else {_tag(name): region for name, region in self.regions.items()}
        mesh = read_mesh(self.path, numbered, unit=self.unit, tag=self.tag)
        check_unknowns(mesh.nodes.size + mesh.corner_count, f"mesh.path {self.path}")
        count, expected = int(mesh.regions.max()) + 1, len(inclusions) + 1
        if count != expected:
            raise InputError(
                f"{self.path} has {count} regions, the case has {expected}: the tissue and {len(inclusions)} inclusions; "
                "map every tag in mesh.regions"
            )
        extent, wanted = np.stack([mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)]), np.stack([np.zeros(3), size])
        if np.abs(extent - wanted).max() > FITS * max(size):
            low, high = ([format_quantity(float(v), "m") for v in row] for row in extent)
            raise InputError(
                f"{self.path} spans {', '.join(low)} to {', '.join(high)}; the block spans 0 to "
                f"{', '.join(format_quantity(v, 'm') for v in size)}; is mesh.unit right?"
            )
        surfaces = Surfaces(np.asarray(size, float), [inclusion.solids(np.asarray(size, float)) for inclusion in inclusions])
        check_whole(mesh, surfaces, self.path)
        content, seconds = content_hash(mesh), time.perf_counter() - started
        made = assembled(mesh, surfaces, inclusions, key=f"file-{content}", seconds=seconds, straightened=0, fitting=False)
        _check_places(made, surfaces, self.path)
        return SourcedBlock(made, content, f"file {self.path}")


def _check_places(block: BlockMesh, surfaces: Surfaces, path: str) -> None:
    """Refuse a mesh whose regions lie elsewhere than the inclusions of the case, or that fills an empty space.

    Raises
    ------
    InputError
        Naming the inclusion, its volume in the case and the part that the region of the mesh shares with it.
    """
    points = block.mesh.nodes[block.mesh.elements[:, :4]]
    volumes = np.abs(np.linalg.det(points[:, 1:] - points[:, :1])) / 6
    meant = surfaces.labels(points.mean(axis=1))
    for number, name in enumerate(block.region_names[1:], 1):
        labelled, there = block.mesh.regions == number, meant == number
        share = volumes[labelled & there].sum() / volumes[labelled | there].sum()
        if share < LEAST_SHARED:
            held, exact = (f"{1e9 * float(volume):.4g} mm^3" for volume in block.volumes[number])
            raise InputError(
                f"{path}: region {number} ({held}) shares {100 * share:.3g} % of its place with {name} of the case ({exact}); "
                f"needed: {100 * LEAST_SHARED:g} %; are the tags in mesh.regions and the place in inclusions right?"
            )
    for name, facets in block.facets.items():
        if not len(facets):
            raise InputError(f"{path}: no facet of the mesh lies on {name}; an empty space must be left out of the mesh")


def _tag(name: str) -> int | str:
    """A whole number if the name is one."""
    return int(name) if name.lstrip("-").isdigit() else name


class AutomaticSource(BlockSource):
    """Graded cells where they can follow the inclusions; tetrahedra around free forms, and bodies below the edge of a jaw."""

    kind: Literal["automatic"] = "automatic"
    graded: GradedSource = GradedSource()
    """The cells around spheres, ellipsoids and tubes."""
    tetrahedra: TetrahedraSource = TetrahedraSource()
    """The tetrahedra otherwise."""

    def chosen(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> GradedSource | TetrahedraSource:
        """What suits these inclusions in a block of this size in m, and jaws with these ``flats`` (2, 2) in m."""
        return self.graded if self.graded.misfit(size, inclusions, flats) is None else self.tetrahedra


AnySource = TetrahedraSource | LayersSource | GradedSource | StructuredSource | FileSource
"""What gives a mesh."""
AnyBlockSource = Annotated[
    AutomaticSource | TetrahedraSource | LayersSource | GradedSource | StructuredSource | FileSource, Field(discriminator="kind")
]
