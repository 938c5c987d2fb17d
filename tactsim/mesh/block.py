"""The mesh of a block with inclusions: what it holds, and the wishes of who asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from tactsim.array import Array
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive, Time

VOLUME_TOLERANCE = 5e-3
"""Largest relative error of the volume of a region."""
FLATNESS = 1e-9
"""Largest distance of a node from the plane of its face, over the longest side of the block."""
SIZES = "mesh.size, mesh.inclusion_size, mesh.edge_size and mesh.growth"
"""Keys of a case that make more cells or fewer."""
FULL_SIDE = 20e-3
"""Least side in m of a block from which on lengths that nobody gives are the usual ones; in smaller ones they are in proportion
to it, and sizes of elements at the edges of jaws to the least side of their flats."""
LumpFilling = Literal["cells", "fan"]
"""What a lump in graded cells holds: such cells, too, or tetrahedra from its surface to its middle."""
OF_GRADED = {"filling": "cells"}
"""What only graded cells are asked for, where it is usual: it is left out of the keys of meshes, as before there was a choice."""
SMALLEST_GAP = 0.3
"""Least distance between inclusions, and from faces, in element sizes near inclusions."""


def part_of_usual(size: Sequence[float] | Array) -> float:
    """What usual lengths are multiplied by in a block of this size (3,) in m: 1 from `FULL_SIDE` on."""
    return min(1.0, float(min(size)) / FULL_SIDE)


class MesherSettings(FrozenModel):
    """What is asked of a mesh beside the lengths of its edges."""

    edge_size: Positive[Length] | None = None
    """Edge length at the edges of the jaws; null means two thirds of size, less at flats narrower than 20 mm."""
    jaw: tuple[Positive[Length], Positive[Length]] | None = None
    """Columns and rows of the jaws, centred on the block; null means jaws that cover the block."""
    growth: Annotated[float, Field(gt=0, le=2)] = 0.5
    """Growth of the edge length per distance."""
    stop_energy: Annotated[float, Field(ge=4, le=100)] = 10.0
    """Shape energy at which the mesher stops improving (3 is a regular tetrahedron)."""
    time_limit: Positive[Time] = 300.0
    """Time after which the mesher is stopped."""


class BlockMeshSettings(MesherSettings):
    """Element sizes in a block with inclusions; the defaults give the default grasp about 40 000 unknowns."""

    size: Positive[Length] = 3.3e-3
    """Edge length far from inclusions and jaw edges."""
    inclusion_size: Positive[Length] = 2.6e-3
    """Edge length at inclusions; a thin wall gets smaller ones by itself."""
    filling: LumpFilling = "cells"
    """What lumps in graded cells hold."""

    @property
    def least_gap(self) -> float:
        """Least distance in m between inclusions, and from faces."""
        return SMALLEST_GAP * self.inclusion_size


@dataclass(frozen=True)
class Quality:
    """How good the elements of a mesh are.

    Attributes
    ----------
    minimum, mean : mean ratio of the straight tetrahedra (1 if regular)
    curvature : least ratio of the smallest to the greatest Jacobian in a curved tetrahedron (1 if straight)
    straightened : number of edges left short of their curved surface because an element would have been nearly inverted
    """

    minimum: float
    mean: float
    curvature: float
    straightened: int


@dataclass(frozen=True)
class BlockMesh:
    """A block from (0, 0, 0) to its size, meshed with its inclusions.

    Attributes
    ----------
    mesh : curved quadratic tetrahedra; region 0 is the tissue, region k the inclusion k, counted from 1
    region_names : "tissue", then such as "sphere 1"
    facets : outward boundary facets (F, 6) by name: the six faces of the block, and "lumen:k" for a hollow inclusion k
    quality : of the elements
    volumes : (R, 2) volume in m^3 of each region in the mesh, and the exact one
    seconds : time that meshing took
    key : hash of what was asked for
    part : of the element size at inclusions that was asked for, with which the mesh was made: with longer ones it missed a bound
    fewer_layers : of graded cells around the inclusions, than are made where these are not close to each other or to a face
    """

    mesh: QuadraticMesh
    region_names: tuple[str, ...]
    facets: dict[str, Array]
    quality: Quality
    volumes: Array
    seconds: float
    key: str
    part: float = 1.0
    fewer_layers: int = 0

    @property
    def volume_errors(self) -> Array:
        """Relative errors (R,) of the volumes of the regions."""
        return self.volumes[:, 0] / self.volumes[:, 1] - 1

    @property
    def unknowns(self) -> int:
        """Unknowns of the mixed P2/P1 form."""
        return int(self.mesh.nodes.size) + self.mesh.corner_count
