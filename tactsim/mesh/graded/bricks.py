"""Graded cells around several lumps: a box of rounded cells around each, in the bricks of one grid.

Where along an axis each lump ends before the next begins, each has a box of its own there. Across such a row they share their
planes, which lead straight from the middle of one lump to that of the next, so that no cell is sheared by more than the way from
one to the other leans; unless it leans much and they are apart there, too. Lumps in no row have level planes only. Those that
overlap along an axis have boxes between the same planes there, which hold all of them::

    +-----+------+---+------+---+
    |     |      |   |      |   |       two lumps above each other on the left, the third one on the right beside
    +-----+------+---+------+---+       the upper: each fills a brick
    |     | (  ) |   | ( )  |   |
    +-----+------+---+------+---+
    |     | ( )  |   |      |   |
    +-----+------+---+------+---+
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.cells import Cells, Filling, from_boxes, with_lump
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
from tactsim.mesh.graded.lump import Lump
from tactsim.mesh.structured_block import grid, product

LEAN = 0.5
"""Distance across a row over that along it, from lump to lump, above which lumps apart across it too have boxes apart there."""


@dataclass(frozen=True)
class Bricks:
    """Boxes around lumps in one grid.

    Attributes
    ----------
    axis : along which planes may lean; its own are level
    lumps : n
    shared : (3,) cells across every box
    near, far : for each axis the coordinates in m of the planes of the grid, beside the boxes and at the faces: (planes,) if they
        are level, (p, planes) at the p planes along ``axis`` if they lean
    first : (n, 3) planes at which the boxes begin
    away : for each axis the distance (planes,) from the boxes over that of the face
    """

    axis: int
    lumps: tuple[Lump, ...]
    shared: Array
    near: tuple[Array, ...]
    far: tuple[Array, ...]
    first: Array
    away: tuple[Array, ...]


@dataclass(frozen=True)
class _Row:
    """The axis along which lumps stand in a row, its planes (p,) in m, and the sides (n, 2) in m of the box of each lump."""

    axis: int
    planes: Array
    sides: Array


def check_apart(lumps: Sequence[Lump]) -> None:
    """Refuse lumps that cannot have a box each.

    Raises
    ------
    InputError
        If along no axis one of two ends before the other begins, or a third one in between keeps them from boxes of their own.
    """
    if len(np.unique(np.stack([_stretches(lumps, axis) for axis in range(3)], axis=1), axis=0)) < len(lumps):
        raise InputError(
            "graded cells serve lumps that boxes hold apart: along x, y or z one of each two must end before the other begins"
        )


def _stretches(lumps: Sequence[Lump], axis: int) -> Array:
    """Numbers (n,) of the stretches of an axis in which lumps lie, ascending; lumps that overlap there lie in the same."""
    bounds = np.array([lump.bounds[:, axis] for lump in lumps])
    order = np.argsort(bounds[:, 0], kind="stable")
    reach = np.maximum.accumulate(bounds[order, 1])
    numbers = np.empty(len(lumps), np.int64)
    numbers[order] = np.concatenate([[0], np.cumsum(bounds[order[1:], 0] > reach[:-1])])
    return numbers


def _row_axis(lumps: Sequence[Lump]) -> int | None:
    """The axis along which the lumps stand apart most; None if there is none along which all do."""
    best, gap = None, 0.0
    for axis in range(3):
        bounds = np.array(sorted(tuple(lump.bounds[:, axis]) for lump in lumps))
        least = float((bounds[1:, 0] - bounds[:-1, 1]).min())
        best, gap = (axis, least) if least > gap else (best, gap)
    return best


def bricks_of(lumps: Sequence[Lump], extent: Array, settings: BlockMeshSettings, finer: int) -> Bricks:
    """The planes around lumps in a block of ``extent`` (3,) in m; ``finer`` counts how often cells across the boxes were added.

    Raises
    ------
    InputError
        If the lumps are not apart, or the cells are too many.
    """
    check_apart(lumps)
    shared, row = _cells_across(lumps, float(extent[2]), settings, finer), _row_axis(lumps)
    leaning = [] if row is None else [k for k in range(3) if k != row and not _apart_and_steep(lumps, row, k)]
    near, far, first = [np.zeros(0)] * 3, [np.zeros(0)] * 3, np.zeros((len(lumps), 3), np.int64)
    for k in (k for k in range(3) if k not in leaning):
        near[k], far[k], first[:, k] = _level(lumps, k, float(extent[k]), int(shared[k]), settings)
    if row is not None:
        line = _Row(row, near[row], near[row][np.column_stack([first[:, row], first[:, row] + shared[row]])])
        for k in leaning:
            near[k], far[k], first[:, k] = _leading(lumps, k, line, float(extent[k]), across=int(shared[k]), settings=settings)
    away = tuple(_away(near[k][0] if near[k].ndim > 1 else near[k], first[:, k], int(shared[k])) for k in range(3))
    return Bricks(0 if row is None else row, tuple(lumps), shared, tuple(near), tuple(far), first, away)


def _apart_and_steep(lumps: Sequence[Lump], row: int, other: int) -> bool:
    """Whether lumps in a row are apart along another axis, too, and the way from one to the next leans much towards it."""
    places = np.array(sorted((lump.center[row], lump.center[other]) for lump in lumps))
    steps = np.abs(np.diff(places, axis=0))
    return len(set(_stretches(lumps, other))) == len(lumps) and bool((steps[:, 1] > LEAN * steps[:, 0]).any())


def _level(
    lumps: Sequence[Lump], axis: int, length: float, across: int, settings: BlockMeshSettings
) -> tuple[Array, Array, Array]:
    """Ascending places (planes,) in m of level planes, beside the boxes and at the faces, and where each box begins (n,)."""
    numbers = _stretches(lumps, axis)
    inside = [[lump for lump, number in zip(lumps, numbers, strict=True) if number == k] for k in range(numbers.max() + 1)]
    bounds = np.array(
        [[min(lump.bounds[0, axis] for lump in part), max(lump.bounds[1, axis] for lump in part)] for part in inside]
    )
    middles = np.array(
        [part[0].center[axis] if len(part) == 1 else ends.mean() for part, ends in zip(inside, bounds, strict=True)]
    )
    if len(inside) == 1:
        (near, far), begin = planes_across(middles, bounds, length, across, settings, pressed=axis == 2)
        return near[0], far[0], np.full(len(lumps), begin)
    line, firsts = _line_along(bounds, middles, length, across, settings)
    return line, line, np.array(firsts)[numbers]


def _leading(
    lumps: Sequence[Lump], axis: int, row: _Row, length: float, *, across: int, settings: BlockMeshSettings
) -> tuple[Array, Array, Array]:
    """Ascending places (p, planes) in m of planes that lead from lump to lump, near and far, and where each box begins (n,)."""
    order = np.argsort([lump.center[row.axis] for lump in lumps])
    middles, bounds = (np.array([getattr(lumps[k], name)[..., axis] for k in order]) for name in ("center", "bounds"))
    planes, begin = planes_across(middles, bounds, length, across, settings, pressed=axis == 2)
    alongs = np.array([lumps[k].center[row.axis] for k in order])
    knots, owner = knots_between(alongs, middles, row.sides[order], length=float(row.planes[-1]))
    near, far = (_between(knots, [lines[k] for k in owner], row.planes) for lines in planes)
    return near, far, np.full(len(lumps), begin)


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
    bounds: Array, middles: Array, length: float, across: int, settings: BlockMeshSettings
) -> tuple[Array, list[int]]:
    """Ascending places in m along an axis, and the number of that at which each box begins.

    The boxes are those around what lies between ``bounds`` (k, 2) with middles (k,), ascending, all in m.
    """
    places, firsts = np.zeros(1), []
    gaps = np.concatenate([[bounds[0, 0]], (bounds[1:, 0] - bounds[:-1, 1]) / 2, [length - bounds[-1, 1]]])
    for k, ((low, high), middle) in enumerate(zip(bounds, middles, strict=True)):
        begin, end = (
            _box_side(float(gaps[side]), float(high - low) / 2, settings, inner=0 < side < len(bounds)) for side in (k, k + 1)
        )
        start = low - begin
        if k == 0:
            places = spaced(start, settings)
        elif start > places[-1] + 1e-12:
            count = max(1, round((start - places[-1]) / settings.size))
            places = np.append(places, np.linspace(places[-1], start, count + 1)[1:])
        firsts.append(len(places) - 1)
        shares = box_shares(across, 0.0)
        places = np.append(places, np.interp(shares, [-1, 0, 1], [places[-1], middle, high + end])[1:])
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
    """Distance (planes,) from the boxes over that of the face: 0 in and between the boxes, 1 at the faces."""
    begin, end = int(first.min()), int(first.max()) + across
    away = np.zeros(len(line))
    if begin:
        away[:begin] = 1 - line[:begin] / line[begin]
    if end < len(line) - 1:
        away[end:] = (line[end:] - line[end]) / (line[-1] - line[end])
    return away


def brick_cells(bricks: Bricks, filling: Filling) -> Cells:
    """Cells around lumps: the lump k, counted from 0, is region k + 1, the tissue 0."""
    shape = tuple(len(away) for away in bricks.away)
    counts = [planes - 1 for planes in shape]
    place = product([np.arange(count) for count in counts])
    inside = np.zeros(len(place), bool)
    for first in bricks.first:
        inside |= ((place >= first) & (place < first + bricks.shared)).all(axis=1)
    places = product([from_boxes(shape[axis], bricks.first[:, axis], int(bricks.shared[axis])) for axis in range(3)])
    cells = Cells.plain(_grid_corners(bricks), grid(counts)[~inside], places)
    for number, (lump, first) in enumerate(zip(bricks.lumps, bricks.first, strict=True), 1):
        on_box = partial(_on_box, first=first, shape=shape)
        turned = partial(_leaning, lump=lump, bricks=bricks)
        cells = with_lump(cells, lump.ball, bricks.shared.tolist(), on_box, filling, region=number, turned=turned)
    return cells.used()


def _on_box(steps: Array, first: Array, shape: Sequence[int]) -> Array:
    """Numbers (s,) of corners of a grid so many steps (3, s) from the first of a box."""
    return np.ravel_multi_index(tuple(steps + first[:, None]), tuple(shape))


def _grid_corners(bricks: Bricks) -> Array:
    """Corners (n, 3) of the whole grid, as if the boxes held plain cells."""
    shape = [len(away) for away in bricks.away]
    index = product([np.arange(n) for n in shape])
    corners = np.empty(index.shape)
    for axis in range(3):
        others = np.max([bricks.away[k][index[:, k]] for k in range(3) if k != axis], axis=0)
        at = index[:, axis] if bricks.near[axis].ndim == 1 else (index[:, bricks.axis], index[:, axis])
        near, far = bricks.near[axis][at], bricks.far[axis][at]
        corners[:, axis] = near + others * (far - near)
    return corners


def _leaning(points: Array, lump: Lump, bricks: Bricks) -> Array:
    """Points (n, 3) in the unit ball turned as the box leans, each as far from the middle as before."""
    slopes, level = np.zeros((2, 3)), bricks.near[bricks.axis]
    at = int(np.argmin(np.abs(level - lump.center[bricks.axis])))
    for k in (k for k in range(3) if bricks.near[k].ndim > 1):
        middle = bricks.first[0, k] + bricks.shared[k] // 2
        slopes[:, k] = np.diff(bricks.near[k][[at - 1, at, at + 1], middle]) / np.diff(level[[at - 1, at, at + 1]])
    along = points[:, bricks.axis]
    leaning = points + along[:, None] * np.where((along > 0)[:, None], slopes[1], slopes[0])
    length = np.linalg.norm(leaning, axis=1, keepdims=True)
    return np.asarray(leaning * np.linalg.norm(points, axis=1, keepdims=True) / np.maximum(length, 1e-300))
