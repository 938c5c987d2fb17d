"""Graded cells around several lumps in a row: a box of rounded cells around each, sheared from lump to lump.

Along the row every lump has a box of its own. Across it all share their lines, which lead straight from the middle of one lump
to that of the next, so that no cell is sheared by more than the way from one to the other leans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.solid import BallImage
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.cells import Cells, Layering, from_boxes, with_lump
from tactsim.mesh.graded.lines import (
    LEAST_BETWEEN,
    NEAR,
    REACH,
    ROOM,
    box_shares,
    cells_along,
    edge_thickness,
    knots_between,
    planes_across,
    spaced,
)
from tactsim.mesh.structured_block import grid, product


@dataclass(frozen=True)
class Lump:
    """A ball and its bounds (2, 3) in m."""

    ball: BallImage
    bounds: Array

    @property
    def half(self) -> Array:
        """Half widths (3,) in m."""
        return np.asarray(np.diff(self.bounds, axis=0)[0] / 2)

    @property
    def center(self) -> Array:
        """Its middle (3,) in m."""
        return self.ball.center


@dataclass(frozen=True)
class Row:
    """Lumps in the order in which they stand along an axis, in a block of size ``extent`` (3,) in m.

    Attributes
    ----------
    axis : along the row
    lumps : n
    shared : (3,) cells across every box
    near, far : for each axis the coordinates in m of the planes of the grid, beside the boxes and at the faces: (planes,) along
        the row, (p, planes) across it at the p planes along it
    first : (n, 3) planes at which the boxes begin
    away : for each axis the way (planes,) from the boxes as a part of that to the face
    """

    axis: int
    lumps: tuple[Lump, ...]
    shared: Array
    near: tuple[Array, ...]
    far: tuple[Array, ...]
    first: Array
    away: tuple[Array, ...]


def in_a_row(lumps: Sequence[Lump]) -> tuple[int, tuple[Lump, ...]]:
    """The axis along which the lumps stand apart most, and the lumps in their order along it.

    Raises
    ------
    InputError
        If along no axis each lump ends before the next begins.
    """
    best, gap = 0, -np.inf
    for axis in range(3):
        bounds = np.array(sorted(tuple(lump.bounds[:, axis]) for lump in lumps))
        least = float((bounds[1:, 0] - bounds[:-1, 1]).min())
        best, gap = (axis, least) if least > gap else (best, gap)
    if gap <= 0:
        raise InputError("graded cells serve lumps in a row: along x, y or z each must end before the next begins")
    return best, tuple(sorted(lumps, key=lambda lump: float(lump.center[best])))


def row_of(lumps: Sequence[Lump], extent: Array, settings: BlockMeshSettings, finer: int) -> Row:
    """The lines around lumps; ``finer`` counts how often cells across the boxes were added.

    Raises
    ------
    InputError
        If the lumps do not stand in a row, or the cells are too many.
    """
    axis, ordered = in_a_row(lumps)
    shared = _cells_across(ordered, float(extent[2]), settings, finer)
    line, firsts = _line_along(ordered, axis, float(extent[axis]), int(shared[axis]), settings)
    near, far, first = [line] * 3, [line] * 3, np.tile(np.asarray(firsts)[:, None], (1, 3))
    for other in (k for k in range(3) if k != axis):
        middles, sides = (np.array([getattr(lump, name)[..., other] for lump in ordered]) for name in ("center", "bounds"))
        planes, begin = planes_across(middles, sides, float(extent[other]), int(shared[other]), settings, pressed=other == 2)
        begins = np.array(firsts)
        sides = np.stack([line[begins], line[begins + shared[axis]]], axis=1)
        alongs, others = (np.array([lump.center[k] for lump in ordered]) for k in (axis, other))
        knots, owner = knots_between(alongs, others, sides, length=float(line[-1]))
        near[other], far[other] = (_between(knots, [lines[k] for k in owner], line) for lines in planes)
        first[:, other] = begin
    away = tuple(_away(near[k][0] if k != axis else line, first[:, k], int(shared[k])) for k in range(3))
    return Row(axis, ordered, shared, tuple(near), tuple(far), first, away)


def _cells_across(lumps: Sequence[Lump], height: float, settings: BlockMeshSettings, finer: int) -> Array:
    """Cells (3,) across every box."""
    cells = np.zeros(3, np.int64)
    for lump in lumps:
        arc = np.pi / 2 * lump.ball.longest / settings.inclusion_size
        check_along(arc, f"mesh.inclusion_size {settings.inclusion_size:.3g} m")
        along = cells_along(lump.bounds, height, round(arc), finer)
        cells = np.maximum(cells, [along, along, max(LEAST_BETWEEN, round(arc)) + finer])
    return cells


def _line_along(
    lumps: Sequence[Lump], axis: int, length: float, across: int, settings: BlockMeshSettings
) -> tuple[Array, list[int]]:
    """Ascending places in m along the row, and the number of that at which each box begins."""
    places, firsts = np.zeros(1), []
    for k, lump in enumerate(lumps):
        low, high = (float(v) for v in lump.bounds[:, axis])
        before = low if k == 0 else (low - float(lumps[k - 1].bounds[1, axis])) / 2
        after = length - high if k == len(lumps) - 1 else (float(lumps[k + 1].bounds[0, axis]) - high) / 2
        begin, end = (
            _box_side(gap, float(lump.half[axis]), settings, inner=inner)
            for gap, inner in ((before, k > 0), (after, k < len(lumps) - 1))
        )
        start = low - begin
        if k == 0:
            places = spaced(start, settings)
        elif start > places[-1] + 1e-12:
            count = max(1, round((start - places[-1]) / settings.size))
            places = np.append(places, np.linspace(places[-1], start, count + 1)[1:])
        firsts.append(len(places) - 1)
        shares = box_shares(across, 0.0)
        places = np.append(places, np.interp(shares, [-1, 0, 1], [places[-1], float(lump.center[axis]), high + end])[1:])
    return np.append(places, (length - spaced(length - places[-1], settings))[-2::-1]), firsts


def _box_side(gap: float, half: float, settings: BlockMeshSettings, *, inner: bool) -> float:
    """Distance in m of the side of a box from its lump, ``gap`` in m away from a face or from where the next box may begin."""
    if inner and (1 - ROOM) * 2 * gap < NEAR * edge_thickness(settings):
        return gap
    return min(ROOM * gap, (REACH - 1) * half)


def _between(knots: Sequence[float], values: Sequence[Array], line: Array) -> Array:
    """Places (p, planes) in m at those (p,) along the row, straight from knot to knot."""
    table = np.array(values)
    return np.stack([np.interp(line, knots, column) for column in table.T], axis=1)


def _away(line: Array, first: Array, across: int) -> Array:
    """Way (planes,) from the boxes, as a part of that to the face: 0 in and between the boxes, 1 at the faces."""
    begin, end = int(first.min()), int(first.max()) + across
    away = np.zeros(len(line))
    if begin:
        away[:begin] = 1 - line[:begin] / line[begin]
    if end < len(line) - 1:
        away[end:] = (line[end:] - line[end]) / (line[-1] - line[end])
    return away


def row_cells(row: Row, layering: Layering) -> Cells:
    """Cells around a row: the lump k in it is region k + 1, the tissue 0."""
    shape = tuple(len(away) for away in row.away)
    counts = [planes - 1 for planes in shape]
    place = product([np.arange(count) for count in counts])
    inside = np.zeros(len(place), bool)
    for first in row.first:
        inside |= ((place >= first) & (place < first + row.shared)).all(axis=1)
    places = product([from_boxes(shape[axis], row.first[:, axis], int(row.shared[axis])) for axis in range(3)])
    cells = Cells.plain(_grid_corners(row), grid(counts)[~inside], places)
    for number, (lump, first) in enumerate(zip(row.lumps, row.first, strict=True), 1):
        on_box = partial(_on_box, first=first, shape=shape)
        turned = partial(_leaning, lump=lump, row=row)
        cells = with_lump(cells, lump.ball, row.shared.tolist(), on_box, layering, region=number, turned=turned)
    return cells.used()


def _on_box(steps: Array, first: Array, shape: Sequence[int]) -> Array:
    """Numbers (s,) of corners of a grid so many steps (3, s) from the first of a box."""
    return np.ravel_multi_index(tuple(steps + first[:, None]), tuple(shape))


def _grid_corners(row: Row) -> Array:
    """Corners (n, 3) of the whole grid, as if the boxes held plain cells."""
    shape = [len(away) for away in row.away]
    index = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    corners = np.empty(index.shape)
    for axis in range(3):
        others = np.max([row.away[k][index[:, k]] for k in range(3) if k != axis], axis=0)
        if axis == row.axis:
            corners[:, axis] = row.near[axis][index[:, axis]]
        else:
            near, far = (lines[axis][index[:, row.axis], index[:, axis]] for lines in (row.near, row.far))
            corners[:, axis] = near + others * (far - near)
    return corners


def _leaning(points: Array, lump: Lump, row: Row) -> Array:
    """Points (n, 3) in the unit ball turned as the box leans, each as far from the middle as before."""
    slopes = np.zeros((2, 3))
    at = int(np.argmin(np.abs(row.near[row.axis] - lump.center[row.axis])))
    for k in (k for k in range(3) if k != row.axis):
        middle = row.first[0, k] + row.shared[k] // 2
        lines = row.near[k][[at - 1, at, at + 1], middle]
        slopes[:, k] = np.diff(lines) / np.diff(row.near[row.axis][[at - 1, at, at + 1]])
    along = points[:, row.axis]
    leaning = points + along[:, None] * np.where((along > 0)[:, None], slopes[1], slopes[0])
    length = np.linalg.norm(leaning, axis=1, keepdims=True)
    return np.asarray(leaning * np.linalg.norm(points, axis=1, keepdims=True) / np.maximum(length, 1e-300))
