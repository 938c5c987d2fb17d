"""The mesh of a block in a file that another program made, checked against the case."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.mechanics.models.block_source import BlockSource, Size, SourcedBlock
from tactsim.mesh.affordable import check_unknowns
from tactsim.mesh.block import BlockMesh
from tactsim.mesh.foreign import LengthUnit
from tactsim.outside.input_path import InputPath
from tactsim.units import NonNegative, format_quantity

if TYPE_CHECKING:
    from tactsim.mesh.fitting.labelling import Surfaces

FITS = 1e-6
"""Largest difference between the extent of a mesh from a file and the block, over the block's longest side."""
LEAST_SHARED = 0.5
"""Least part that a region of a mesh from a file shares with the inclusion of the case, of what either fills."""


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

    def sourced(self, size: Size, inclusions: Sequence[Inclusion], flats: Sequence[Array] = ()) -> SourcedBlock:
        """The mesh in the file, checked against the size in m of the block and the number of inclusions; of no ``flats`` (2, 2).

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
