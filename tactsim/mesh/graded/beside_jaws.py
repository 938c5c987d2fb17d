"""Tissue beside jaws that are smaller than the block: cells that grow away from the edges of their flats.

Under the edge of a stiff flat the pressure has its peak, as at the free faces of a block that the jaws cover. Therefore the part
of the block between the flats of all jaws is meshed as a block of its own, with thin cells at its sides, and from there its cells
go on straight to the faces of the whole block::

    face      edge of a flat         edge of a flat      face
      +------+---+--+--+---+----+----+---+--+--+---+------+
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.cells import Cells
from tactsim.mesh.graded.lines import NEAREST, edge_thickness, mirrored_line, spaced
from tactsim.mesh.structured_block import ON_SIDE, SIDES

THINNER = 0.75
"""Thickness of the cells at the edges of flats, and at all faces with them, over that at the faces of a block that the jaws
cover. Pressure grows faster towards the edge of a flat than towards a free face: as many cells read taxels there 0.4 % low, and
1.4 % with the usual thickness."""


@dataclass(frozen=True)
class Footprint:
    """The part of a block between the flats of all jaws, and the planes of cells beside it.

    Attributes
    ----------
    block : (3,) sides of the block in m
    low, high : (3,) its corners in m
    beside : for x and y, planes in m below ``low`` and above ``high``, outward, those of its own sides left out
    thin : for x, y and z, ascending places in m at which cells are thin: edges of flats, and faces that a jaw presses
    settings : of the cells in it and beside it
    """

    block: Array
    low: Array
    high: Array
    beside: tuple[tuple[Array, Array], tuple[Array, Array]]
    thin: tuple[Array, Array, Array]
    settings: BlockMeshSettings

    @property
    def size(self) -> Array:
        """Its sides (3,) in m."""
        return self.high - self.low

    @property
    def more(self) -> Array:
        """Numbers of cells (3,) beside it."""
        return np.array([*(len(below) + len(above) for below, above in self.beside), 0])

    def from_face_to_face(self, axis: int) -> Footprint:
        """The same with all of the block along an axis."""
        along = np.arange(3) == axis
        beside = tuple((np.zeros(0), np.zeros(0)) if k == axis else sides for k, sides in enumerate(self.beside))
        low, high = np.where(along, 0.0, self.low), np.where(along, self.block, self.high)
        return replace(self, low=low, high=high, beside=(beside[0], beside[1]))


def footprint_of(flats: Sequence[Array], extent: Array, settings: BlockMeshSettings) -> Footprint:
    """What lies between flats (2, 2), each given by its low and its high corner in m, of a block of size (3,) in m.

    An edge of a flat that is less than half a thin cell from a face of the block, or from another edge, is taken to be there.
    Without flats it is the whole block.

    Raises
    ------
    InputError
        If less than two thin cells lie between the flats along x or y.
    """
    least, low, high = NEAREST * edge_thickness(settings), np.zeros(3), extent.astype(float)
    between = [[_edges(ends, least) for ends in _ends(flats, axis, float(extent[axis]))] for axis in (0, 1)]
    if any(edges[0] for pair in between for edges in pair):
        settings = settings.model_copy(update={"edge_size": THINNER * edge_thickness(settings)})
    beside, thin = [], []
    for axis, ((below, above), length) in enumerate(zip(between, extent[:2], strict=True)):
        if below[0] + above[0] > 0 and length - below[0] - above[0] < 4 * least:
            raise InputError(f"graded cells serve jaws that face each other; along {'xy'[axis]} the flats of these do not")
        low[axis], high[axis] = below[0], length - above[0]
        beside.append((_outward(below, settings), length - _outward(above, settings)))
        thin.append(np.concatenate([below[::-1], length - np.array(above)]))
    return Footprint(extent, low, high, (beside[0], beside[1]), (thin[0], thin[1], np.array([0.0, extent[2]])), settings)


def _ends(flats: Sequence[Array], axis: int, length: float) -> tuple[Array, Array]:
    """Distances (k,) in m at which flats begin from the first face across an axis, and end from the second."""
    ends = np.array([flat[:, axis] for flat in flats]).reshape(-1, 2)
    return ends[:, 0], length - ends[:, 1]


def _edges(ends: Array, least: float) -> list[float]:
    """Descending distances in m from a face of the edges that end there; the last one is 0 if a jaw presses on the face."""
    kept: list[float] = []
    for end in np.sort(ends)[::-1]:
        place = float(end) if end >= least else 0.0
        if not kept or kept[-1] - place >= least:
            kept.append(place)
    return kept or [0.0]


def _outward(edges: list[float], settings: BlockMeshSettings) -> Array:
    """Descending distances in m from a face of planes beyond the first of the edges (k,), to the face."""
    planes = [np.zeros(0)]
    for edge, following in itertools.pairwise(edges):
        planes.append(following + mirrored_line(edge - following, settings)[-2::-1])
    planes.append(edges[-1] - spaced(edges[-1], settings)[1:])
    return np.concatenate(planes)


def widened(cells: Cells, footprint: Footprint) -> Cells:
    """Cells of the footprint by their coordinates from its low corner, with those beside it that go on straight to the faces."""
    cells, near = replace(cells, corners=cells.corners + footprint.low), ON_SIDE * float(footprint.block.max())
    for axis, sides in enumerate(footprint.beside):
        for plane, places in zip((footprint.low[axis], footprint.high[axis]), sides, strict=True):
            cells = _continued(cells, axis, np.abs(cells.corners[:, axis] - plane) < near, places)
    return cells


def _continued(cells: Cells, axis: int, on: Array, planes: Array) -> Cells:
    """The same with rows of cells up to ``planes`` in m across an axis, from the sides whose corners are all ``on`` (n,)."""
    if not len(planes):
        return cells
    sides = cells.cells[:, SIDES]
    chosen = on[sides].all(axis=2)
    face, quads = np.unique(sides[chosen], return_inverse=True)
    a, b, c, d = quads.reshape(-1, 4).T
    rows = [face, *(len(cells.corners) + k * len(face) + np.arange(len(face)) for k in range(len(planes)))]
    added = [
        np.stack([below[a], below[b], below[d], below[c], above[a], above[b], above[d], above[c]], axis=1)
        for below, above in itertools.pairwise(rows)
    ]
    corners = np.tile(cells.corners[face], (len(planes), 1))
    corners[:, axis] = np.repeat(planes, len(face))
    regions = cells.regions[np.nonzero(chosen)[0]]
    return Cells(
        np.vstack([cells.corners, corners]),
        np.vstack([cells.cells, *added]),
        np.concatenate([cells.regions, np.tile(regions, len(planes))]),
        np.vstack([cells.places, *(k * cells.places[face] for k in range(2, len(planes) + 2))]),
        cells.layers.with_others(len(corners)),
    )
