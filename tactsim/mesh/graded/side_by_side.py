"""Lines of grids in planes across tubes that stand side by side, at most one ball among them: bent around a box about each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.lines import (
    LEAST_ALONG,
    NEAR,
    PAIRED,
    REACH,
    ROOM,
    beside_boxes,
    box_shares,
    edge_thickness,
    knots_between,
    outer_places,
    planes_across,
)
from tactsim.mesh.graded.lump import Lump
from tactsim.mesh.graded.planes_along import planes_along
from tactsim.mesh.graded.sections import Hollow, Sections, leading_axis, sections_of


@dataclass(frozen=True)
class Bundle:
    """Tubes, a ball among them, and the lines around them in n planes; k bodies in all.

    Attributes
    ----------
    sections : of the tubes, in the order in which they stand along the second of their axes
    ball : None if there is none
    bodies : (k,) numbers of the tubes among those of the sections, -1 for the ball
    across : cells across each box
    first : (k, 2) lines along the second and the third axis at which the boxes begin
    planes : first and last plane of the box of the ball
    grid : (n, w, t, 2) places in m of the crossings of lines
    wall : rings of cells in the wall of each tube
    """

    sections: Sections
    ball: Lump | None
    bodies: Array
    across: int
    first: Array
    planes: tuple[int, int]
    grid: Array
    wall: tuple[int, ...]


@dataclass(frozen=True)
class _Bodies:
    """Tubes and a ball in n planes: middles (n, k, 2) and bounds (n, k, 2, 2) in m."""

    centers: Array
    bounds: Array


def bundle_of(
    tubes: Sequence[Hollow], ball: Lump | None, size: Array, settings: BlockMeshSettings, finer: int, *, thin: Sequence[Array]
) -> tuple[Bundle, Array]:
    """The lines around tubes and a ball in a block of size (3,) in m, and the numbers of the tubes in their order.

    ``finer`` counts how often cells across the boxes were added; cells along the tubes are thin at the places ``thin`` in m,
    given for x, y and z.

    Raises
    ------
    InputError
        If the tubes do not lead along one axis, the bodies do not stand side by side, or the cells are too many.
    """
    axis = leading_axis(tubes, size)
    longest = max([*(tube.outer for tube in tubes), *([] if ball is None else [ball.ball.longest])])
    arc = np.pi / 2 * longest / settings.inclusion_size
    check_along(arc, f"mesh.inclusion_size {settings.inclusion_size:.3g} m")
    across = PAIRED * (-(-max(LEAST_ALONG, round(arc)) // PAIRED) + finer)
    places, planes = planes_along(tubes, ball, size, settings, axis=axis, across=across, thin=thin[axis])
    unordered = sections_of(tubes, axis, places, size)
    sections, bodies, numbers = _in_order(unordered, ball, planes)
    seen = _bodies(sections, ball, bodies, planes, size)
    extent = size[list(sections.axes)]
    first, sides, outer = _lines_beside(seen, across, float(extent[1]), settings, pressed=sections.axes[1] == 2)
    flat_centers, flat_bounds = seen.centers[..., 1].ravel(), seen.bounds[:, :, 1].reshape(-1, 2)
    pressed = sections.axes[2] == 2
    (near, far), begin = planes_across(flat_centers, flat_bounds, float(extent[2]), across, settings, pressed=pressed)
    shape = (*seen.centers.shape[:2], -1)
    grid = _bent(
        seen,
        (sides, outer),
        (np.array(near).reshape(shape), np.array(far).reshape(shape)),
        first=first,
        begin=begin,
        across=across,
    )
    wall = tuple(max(1, round(float(outer - inner) / settings.inclusion_size)) for outer, inner in sections.radii)
    firsts = np.column_stack([first, np.full(len(first), begin)])
    return Bundle(sections, ball, bodies, across, firsts, planes, grid, wall), numbers


def _in_order(unordered: Sections, ball: Lump | None, planes: tuple[int, int]) -> tuple[Sections, Array, Array]:
    """Sections along the axis where the bodies are farthest apart, the bodies in their order, and the numbers of the tubes.

    Raises
    ------
    InputError
        If along neither axis each body ends before the next begins.
    """
    best, kept = 0.0, None
    beside = np.arange(planes[0], planes[1] + 1)
    for sections in (unordered, unordered.turned()):
        low, high = np.moveaxis(sections.bounds[:, :, 0], -1, 0)
        seen = slice(None) if ball is None else beside
        spans = np.stack([low[seen], high[seen]])
        if ball is not None:
            its = np.broadcast_to(ball.bounds[:, sections.axes[1], None, None], (2, len(beside), 1))
            spans = np.concatenate([spans, its], axis=2)
        standing = np.argsort(spans.mean(axis=(0, 1)), kind="stable")
        order = standing[standing < len(sections.radii)]
        gap = min(_least_gap(*spans[:, :, standing]), _least_gap(low[:, order], high[:, order]))
        if gap > best:
            tubes = standing < len(sections.radii)
            best, kept = gap, (sections.taken(order), np.where(tubes, np.cumsum(tubes) - 1, -1), order)
    if kept is None:
        raise InputError("graded cells serve tubes and a lump side by side: along an axis each must end before the next begins")
    return kept


def _least_gap(low: Array, high: Array) -> float:
    """Least distance in m between neighbours with lowest and highest coordinates (n, k) in m, infinite if there are none."""
    return float((low[:, 1:] - high[:, :-1]).min(initial=np.inf))


def _bodies(sections: Sections, ball: Lump | None, bodies: Array, planes: tuple[int, int], size: Array) -> _Bodies:
    """Middles and bounds of all bodies; the ball goes along between its neighbours where it is not."""
    n = len(sections.places)
    centers, bounds = np.empty((n, len(bodies), 2)), np.empty((n, len(bodies), 2, 2))
    tubes = bodies >= 0
    centers[:, tubes], bounds[:, tubes] = sections.centers[:, bodies[tubes], 1:], sections.bounds[:, bodies[tubes]]
    if ball is not None:
        k, across = int(np.flatnonzero(~tubes)[0]), list(sections.axes[1:])
        room = np.stack(
            [
                bounds[:, k - 1, 0, 1] if k else np.zeros(n),
                bounds[:, k + 1, 0, 0] if k < len(bodies) - 1 else np.full(n, size[across[0]]),
            ]
        )
        held = np.clip(np.arange(n), *planes)
        fixed = np.array([ball.center[across[0]], *ball.bounds[:, across[0]]])
        shares = (fixed[:, None] - room[0, held]) / (room[1, held] - room[0, held])
        moved = room[0] + shares * (room[1] - room[0])
        centers[:, k, 0], bounds[:, k, 0] = moved[0], moved[1:].T
        centers[:, k, 1], bounds[:, k, 1] = ball.center[across[1]], ball.bounds[:, across[1]]
    return _Bodies(centers, bounds)


def _lines_beside(
    seen: _Bodies, across: int, length: float, settings: BlockMeshSettings, *, pressed: bool
) -> tuple[Array, Array, Array]:
    """The lines (k,) at which boxes begin, and ascending places (n, lines) in m beside the boxes and at the faces."""
    middle, bounds = seen.centers[..., 0], seen.bounds[:, :, 0]
    sides, touching = _box_sides(bounds, length, settings, pressed=pressed)
    left = np.stack([sides[:, 0, 0], length - sides[:, -1, 1]], axis=1)
    half = np.diff(bounds, axis=2)[..., 0][:, [0, -1]] / 2
    far, ends = beside_boxes(left, np.stack([middle[:, 0], length - middle[:, -1]], axis=1), half, settings)
    between = [
        0 if touching[k] else max(1, round(float((sides[:, k + 1, 0] - sides[:, k, 1]).mean()) / settings.size))
        for k in range(middle.shape[1] - 1)
    ]
    first = ends[0] + np.concatenate([[0], np.cumsum(np.array(between, np.int64) + across)])
    lines = []
    for spans in (left, far):
        moved = sides.copy()
        moved[:, 0, 0], moved[:, -1, 1] = spans[:, 0], length - spans[:, 1]
        lines.append(
            np.array(
                [
                    _line(sides_of, middle_of, settings, ends=ends, between=between, length=length, across=across)
                    for sides_of, middle_of in zip(moved, middle, strict=True)
                ]
            )
        )
    return first, lines[0], lines[1]


def _box_sides(bounds: Array, length: float, settings: BlockMeshSettings, *, pressed: bool) -> tuple[Array, Array]:
    """Sides (n, k, 2) in m of boxes about bodies with bounds (n, k, 2), and whether each meets the next (k - 1,)."""
    half, edge = np.diff(bounds, axis=2)[..., 0] / 2, edge_thickness(settings)
    gaps = np.concatenate([bounds[:, :1, 0], (bounds[:, 1:, 0] - bounds[:, :-1, 1]) / 2, length - bounds[:, -1:, 1]], axis=1)
    at_faces: Array = np.all(gaps[:, [0, -1]] < NEAR * edge, axis=0) & pressed
    inner: Array = np.any(2 * (1 - ROOM) * gaps[:, 1:-1] < NEAR * edge, axis=0)
    closed = np.array([at_faces[0], *inner, at_faces[1]])
    before, after = (
        np.where(shut, gap, np.minimum(ROOM * gap, (REACH - 1) * half))
        for shut, gap in ((closed[:-1], gaps[:, :-1]), (closed[1:], gaps[:, 1:]))
    )
    return np.stack([bounds[..., 0] - before, bounds[..., 1] + after], axis=2), inner


def _line(
    sides: Array,
    middle: Array,
    settings: BlockMeshSettings,
    *,
    ends: Sequence[int],
    between: Sequence[int],
    length: float,
    across: int,
) -> Array:
    """Ascending places in m from face to face through boxes with sides (k, 2) and middles (k,).

    There are so many cells at both ``ends``, ``between`` neighbours, and ``across`` each box.
    """
    before, after = ends
    places = [outer_places(float(sides[0, 0]), before, settings)[:-1]]
    for k, (low, high) in enumerate(sides):
        places.append(np.interp(box_shares(across, 0.0), [-1, 0, 1], [low, middle[k], high])[:-1])
        if k < len(between) and between[k]:
            places.append(np.linspace(high, sides[k + 1, 0], between[k] + 1)[:-1])
    return np.concatenate([*places, (length - outer_places(length - float(sides[-1, 1]), after, settings))[::-1]])


def _bent(
    seen: _Bodies, beside: tuple[Array, Array], third: tuple[Array, Array], *, first: Array, begin: int, across: int
) -> Array:
    """Crossings (n, w, t, 2) in m of lines that move to their far places away from the boxes.

    The lines along the second axis lie at ``beside``, near and far, each (n, w); those along the third axis at ``third`` at each
    body, each (n, k, t), and lead straight from body to body.
    """
    near, far = beside
    through = [np.empty((*near.shape, third[0].shape[2])) for _ in third]
    for i, line in enumerate(near):
        sides = np.stack([line[first], line[first + across]], axis=1)
        knots, owner = knots_between(seen.centers[i, :, 0], seen.centers[i, :, 1], sides, length=float(line[-1]))
        for lines, places in zip(through, third, strict=True):
            lines[i] = np.stack([np.interp(line, knots, column) for column in places[i][owner].T], axis=1)
    away = _away(near, int(first[0]), int(first[-1]) + across)
    away_third = _away(through[0].reshape(-1, third[0].shape[2]), begin, begin + across).reshape(through[0].shape)
    along = near[:, :, None] + away_third * (far - near)[:, :, None]
    return np.stack([along, through[0] + away[:, :, None] * (through[1] - through[0])], axis=-1)


def _away(lines: Array, first: int, last: int) -> Array:
    """Distance (n, lines) from the boxes over that of the face: 0 from line to line, 1 at faces that they do not touch."""
    begin, end, length = lines[:, [first]], lines[:, [last]], lines[:, [-1]]
    below = (begin - lines) / np.where(begin > 0, begin, np.inf)
    above = (lines - end) / np.where(length > end, length - end, np.inf)
    return np.maximum(0.0, np.maximum(below, above))
