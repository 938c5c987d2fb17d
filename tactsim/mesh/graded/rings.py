r"""Graded cells around tubes: rings of cells in planes across the block, swept along it.

In every plane a grid of lines is bent around a box about each tube. Box and tube hold, from the middle outwards, a core of cells
with rounded sides, one ring of cells to the bore, the rings of the wall, and layers of tissue out to the sides of the box (one is
drawn)::

    +-----+---+---+---+---+-----+      lines across the planes lead along the tube; where it ends inside the block, the core
    |     | \  \  |  /  / |     |      goes on as tissue to the face. In the tube the core is empty space. A tube that leans
    +-----+  .-------.   +------+      or bends takes its box along; its section is an ellipse.
    |     +-(  core   )--+      |
    +-----+  `-------'   +------+
    |     | /  /  |  \  \ |     |
    +-----+---+---+---+---+-----+
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.mesh.fitting.layers import Layers
from tactsim.mesh.graded.cells import CORE_PLACE, WALL_PLACE, Cells, Filling, from_box, from_boxes, layer_places, with_lump
from tactsim.mesh.graded.side_by_side import Bundle
from tactsim.mesh.structured_block import blown, directions, product

PLAIN, BOX, BALL = -1, -2, -3
"""Owners of cells of a plane: none, the rings of a tube in their place, and the ball in the planes that it meets."""
BALL_REGION = 1_000_000
"""Region of the ball, above those of all tubes."""
TILT_BESIDE = 0.5
"""Part of its tilt that the flat end of a tube gives to the planes before and after it."""


@dataclass(frozen=True)
class Plane:
    """Cells of a plane across tubes, the same in all planes.

    Attributes
    ----------
    points : (n, m, 3) in m, by the axes of the sections
    cells : (q, 4) around each cell, from the second axis to the third
    owner : (q,) tube of a cell of a core or a wall, `PLAIN` in tissue, `BALL` where the ball may be
    core : (q,) whether a cell belongs to a core
    logical : (m, 2) places by which cells are split, from the middle of the nearest box
    layers : around the tubes
    """

    points: Array
    cells: Array
    owner: Array
    core: Array
    logical: Array
    layers: Layers


def _plane_of(bundle: Bundle, filling: Filling) -> Plane:
    """The cells of all planes."""
    n, w, t, _ = bundle.grid.shape
    number = np.arange(w * t).reshape(w, t)
    flat = np.broadcast_to(bundle.sections.places[:, None, None, None], (n, w, t, 1))
    points = [np.concatenate([flat, bundle.grid], axis=-1).reshape(n, w * t, 3)]
    body = np.full((w - 1, t - 1), PLAIN)
    for k, (i, j) in zip(bundle.bodies, bundle.first, strict=True):
        body[i : i + bundle.across, j : j + bundle.across] = BOX if k >= 0 else BALL
    cells, owner = [_quads(number)[body.ravel() != BOX]], [body.ravel()[body.ravel() != BOX]]
    core = [np.zeros(len(cells[0]), bool)]
    logical = [product([from_boxes(lines, bundle.first[:, k], bundle.across) for k, lines in enumerate((w, t))])]
    layers = Layers.none(w * t)
    for k, (i, j) in zip(bundle.bodies, bundle.first, strict=True):
        if k < 0:
            continue
        loop = _around(number[i : i + bundle.across + 1, j : j + bundle.across + 1])
        disc = _disc(bundle.across, bundle.wall[k])
        placed, count = _placed_disc(disc, bundle, k), len(layers.beneath)
        wall, box = placed[:, -len(loop) :], points[0][:, loop]
        ends = filling.ends(wall, box)
        points += [placed, *(wall + end * (box - wall) for end in ends)]
        layers = layers.with_body(len(disc) - len(loop), loop, ends)
        quads, depth = _disc_cells(bundle.across, loop, count, bundle.wall[k] + len(ends))
        cells.append(quads)
        owner.append(np.where(depth <= bundle.wall[k], k, PLAIN))
        core.append(depth < 1)
        logical += [_disc_places(disc, bundle.wall[k]), *layer_places(disc[-len(loop) :, :2], ends)[1:]]
    return Plane(
        np.concatenate(points, axis=1),
        np.vstack(cells),
        np.concatenate(owner),
        np.concatenate(core),
        np.vstack(logical),
        layers,
    )


def _quads(number: Array) -> Array:
    """Cells (q, 4) of a grid of numbers (w, t), around each."""
    return np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)


def _around(number: Array) -> Array:
    """Entries (p,) on the sides of an array, in the order in which they go around it."""
    return np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])


def _disc(across: int, wall: int) -> Array:
    """Points (m, 3) of a tube in a box: in the unit disc of the bore, and how many rings beyond it, last those on its outside."""
    square = product([np.linspace(-1, 1, across + 1)] * 2)
    logical = np.column_stack([square, np.zeros(len(square))])
    edge = _around(np.arange(len(square)).reshape(across + 1, across + 1))
    inner = np.column_stack([blown(logical)[:, :2], np.zeros(len(square))])
    unit = directions(logical[edge])[:, :2]
    return np.vstack([inner, *(np.column_stack([unit, np.full(len(unit), ring)]) for ring in range(wall + 1))])


def _disc_cells(across: int, loop: Array, count: int, rings: int) -> tuple[Array, Array]:
    """Cells (q, 4) of a box, numbered from ``count`` on, that end at the numbers ``loop`` (p,) of its sides; and the depth (q,).

    The depth is -1 in the core, 0 in the ring around it, then 1 to ``rings`` in those of the wall and of tissue, and one more in
    the last out to the sides.
    """
    number = count + np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    outward = count + number.size + np.arange((rings + 1) * len(loop)).reshape(rings + 1, -1)
    circles = [_around(number), *outward, loop]
    cells = [_quads(number)]
    for below, above in itertools.pairwise(circles):
        cells.append(np.stack([below, above, np.roll(above, -1), np.roll(below, -1)], axis=1))
    return np.vstack(cells), np.repeat(np.arange(-1, rings + 2), [len(part) for part in cells])


def _placed_disc(disc: Array, bundle: Bundle, k: int) -> Array:
    """Points (n, m, 3) in m of the disc (m, 3) of tube ``k`` in every plane, in its flat ends where it ends in the block."""
    sections, (outer, inner) = bundle.sections, bundle.sections.radii[k]
    radius = inner + disc[:, 2] / bundle.wall[k] * (outer - inner)
    offset = np.zeros((len(sections.places), len(disc), 3))
    offset[..., 1:] = radius[:, None] * np.einsum("nij,mj->nmi", sections.stretches[:, k], disc[:, :2])
    last = len(sections.places) - 1
    for end in sections.ends[k]:
        for plane in (end - 1, end, end + 1) if 0 < end < last else ():
            if 0 < plane < last:
                tangent = sections.tangents[plane, k]
                offset[plane] -= (TILT_BESIDE if plane != end else 1.0) * (offset[plane] @ tangent)[:, None] * tangent
    return np.asarray(sections.centers[:, k, None] + offset)


def _disc_places(disc: Array, wall: int) -> Array:
    """Places (m, 2) of the points of a disc (m, 3), within those of the sides of the box."""
    share = np.where(np.linalg.norm(disc[:, :2], axis=1) > 1 - 1e-9, disc[:, 2] + 1, 0) / (wall + 1)
    return (CORE_PLACE + (WALL_PLACE - CORE_PLACE) * share)[:, None] * np.abs(disc[:, :2])


def swept_cells(bundle: Bundle, filling: Filling) -> Cells:
    """Cells around tubes, split by their places along the tubes and across.

    The wall of the tube k of the bundle is the region k + 1, the space in it -2 - k, the tissue 0, the ball ``BALL_REGION``.
    """
    plane, axes = _plane_of(bundle, filling), bundle.sections.axes
    planes, count, _ = plane.points.shape
    corners = np.empty((planes * count, 3))
    corners[:, list(axes)] = plane.points.reshape(-1, 3)
    even = (axes[1] - axes[0]) % 3 == 1
    a, b, c, d = plane.cells.T if even else plane.cells[:, ::-1].T
    side = np.stack([a, b, d, c], axis=1)
    step = np.arange(planes - 1)[:, None, None] * count
    cells = (step + np.hstack([side, side + count])[None]).reshape(-1, 8)
    index, regions = np.arange(planes - 1)[:, None], np.zeros((planes - 1, len(plane.cells)), np.int64)
    for k, (begin, end) in enumerate(bundle.sections.ends):
        within = (index >= begin) & (index < end) & (plane.owner == k)
        regions = np.where(within, np.where(plane.core, -2 - k, k + 1), regions)
    places = np.column_stack([_along(bundle, count).ravel(), np.tile(plane.logical, (planes, 1))])
    kept = ~((index >= bundle.planes[0]) & (index < bundle.planes[1]) & (plane.owner == BALL)).ravel()
    swept = Cells(corners, cells[kept], regions.ravel()[kept], places, plane.layers.repeated(planes))
    return (_with_ball(swept, bundle, count, filling) if bundle.ball is not None else swept).used()


def _along(bundle: Bundle, count: int) -> Array:
    """Places (n, count) of points of the planes along the tubes: from the middle, and beside the ball from that of its box."""
    n, w, t, _ = bundle.grid.shape
    places = np.tile(np.abs(np.arange(n) - (n - 1) / 2)[:, None], count)
    if bundle.ball is not None:
        steps = np.abs(np.arange(w)[:, None] - bundle.first[:, 0] - bundle.across / 2)
        beside = np.repeat(bundle.bodies[steps.argmin(axis=1)] < 0, t)
        middle, half = np.mean(bundle.planes), bundle.across / 2
        places[:, np.flatnonzero(beside)] = from_box(np.abs(np.arange(n) - middle), half)[:, None]
    return places


def _with_ball(cells: Cells, bundle: Bundle, count: int, filling: Filling) -> Cells:
    """The same with the cells of the box of the ball, in planes of ``count`` corners each."""
    assert bundle.ball is not None
    axes, first = list(bundle.sections.axes), bundle.first[np.flatnonzero(bundle.bodies < 0)[0]]

    def on_box(steps: Array) -> Array:
        plane, second, third = steps[axes]
        return (bundle.planes[0] + plane) * count + (first[0] + second) * bundle.grid.shape[2] + first[1] + third

    before = len(cells.corners)
    added = with_lump(cells, bundle.ball.ball, [bundle.across] * 3, on_box, filling, region=BALL_REGION)
    return replace(added, places=np.vstack([cells.places, added.places[before:, axes]]))
