r"""Graded cells around tubes: rings of cells in planes across the block, swept along it.

In every plane a grid of lines is bent around a box about each tube. Box and tube hold, from the middle outwards, a core of cells
with rounded sides, one ring of cells to the bore, the rings of the wall, and one ring of tissue out to the sides of the box::

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
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.mesh.graded.side_by_side import Bundle
from tactsim.mesh.structured_block import blown, directions, grid, product, skin, stacked

CORE_PLACE, WALL_PLACE = 0.4, 0.8
"""Distances from the middle of the box, of which the sides are one away, at which core and wall count when cells are split."""
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
    """

    points: Array
    cells: Array
    owner: Array
    core: Array
    logical: Array


def _plane_of(bundle: Bundle) -> Plane:
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
    logical, count = [product([_from_boxes(bundle, axis) for axis in range(2)])], w * t
    for k, (i, j) in zip(bundle.bodies, bundle.first, strict=True):
        if k < 0:
            continue
        loop = _around(number[i : i + bundle.across + 1, j : j + bundle.across + 1])
        disc, quads, depth = _disc(bundle.across, loop, count, bundle.wall[k])
        points.append(_placed_disc(disc, bundle, k))
        count += len(disc)
        cells.append(quads)
        owner.append(np.where(depth <= bundle.wall[k], k, PLAIN))
        core.append(depth < 1)
        logical.append(_disc_places(disc, bundle.wall[k]))
    return Plane(
        np.concatenate(points, axis=1), np.vstack(cells), np.concatenate(owner), np.concatenate(core), np.vstack(logical)
    )


def _quads(number: Array) -> Array:
    """Cells (q, 4) of a grid of numbers (w, t), around each."""
    return np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)


def _around(number: Array) -> Array:
    """Entries (p,) on the sides of an array, in the order in which they go around it."""
    return np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])


def _disc(across: int, loop: Array, count: int, wall: int) -> tuple[Array, Array, Array]:
    """Points (m, 3) of a box: in the unit disc of the bore, and how many rings beyond it; its cells (q, 4), and the depth (q,).

    Cells are numbered from ``count`` on and end at the numbers ``loop`` (p,) of the sides of the box. The depth is -1 in the
    core, 0 in the ring around it, 1 to ``wall`` in the wall and ``wall + 1`` beyond.
    """
    square = product([np.linspace(-1, 1, across + 1)] * 2)
    logical = np.column_stack([square, np.zeros(len(square))])
    number = np.arange(len(square)).reshape(across + 1, across + 1)
    edge = _around(number)
    inner = np.column_stack([blown(logical)[:, :2], np.zeros(len(square))])
    unit = directions(logical[edge])[:, :2]
    rings = [np.column_stack([unit, np.full(len(unit), ring)]) for ring in range(wall + 1)]
    circles = [count + edge, *(count + len(square) + ring * len(edge) + np.arange(len(edge)) for ring in range(wall + 1)), loop]
    cells = [count + _quads(number)]
    for below, above in itertools.pairwise(circles):
        cells.append(np.stack([below, above, np.roll(above, -1), np.roll(below, -1)], axis=1))
    depth = np.repeat(np.arange(-1, wall + 2), [len(part) for part in cells])
    return np.vstack([inner, *rings]), np.vstack(cells), depth


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


def _from_boxes(bundle: Bundle, axis: int) -> Array:
    """Places (lines,) of lines from the middle of the nearest box, whose sides are one away."""
    steps = np.abs(np.arange(bundle.grid.shape[1 + axis])[:, None] - bundle.first[:, axis] - bundle.across / 2)
    return _from_box(steps, bundle.across / 2).min(axis=1)


def _from_box(steps: Array, half: float) -> Array:
    """Places of lines so many steps from the middle of a box, whose sides are ``half`` steps, and one, away."""
    return np.where(steps > half, 1 + steps - half, steps / half)


def _disc_places(disc: Array, wall: int) -> Array:
    """Places (m, 2) of the points of a disc (m, 3), within those of the sides of the box."""
    share = np.where(np.linalg.norm(disc[:, :2], axis=1) > 1 - 1e-9, disc[:, 2] + 1, 0) / (wall + 1)
    return (CORE_PLACE + (WALL_PLACE - CORE_PLACE) * share)[:, None] * np.abs(disc[:, :2])


def swept_cells(bundle: Bundle) -> tuple[Array, Array, Array, Array]:
    """Corners (n, 3) in m, cells (H, 8), their regions (H,), and the places (n, 3) of the corners by which cells are split.

    The wall of the tube k of the bundle is the region k + 1, the space in it -2 - k, the tissue 0, the ball ``BALL_REGION``.
    """
    plane, axes = _plane_of(bundle), bundle.sections.axes
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
    if bundle.ball is not None:
        kept = ~((index >= bundle.planes[0]) & (index < bundle.planes[1]) & (plane.owner == BALL)).ravel()
        return _with_ball(bundle, corners, cells[kept], regions.ravel()[kept], places)
    return _used(corners, cells, regions.ravel(), places)


def _along(bundle: Bundle, count: int) -> Array:
    """Places (n, count) of points of the planes along the tubes: from the middle, and beside the ball from that of its box."""
    n, w, t, _ = bundle.grid.shape
    places = np.tile(np.abs(np.arange(n) - (n - 1) / 2)[:, None], count)
    if bundle.ball is not None:
        steps = np.abs(np.arange(w)[:, None] - bundle.first[:, 0] - bundle.across / 2)
        beside = np.repeat(bundle.bodies[steps.argmin(axis=1)] < 0, t)
        middle, half = np.mean(bundle.planes), bundle.across / 2
        places[:, np.flatnonzero(beside)] = _from_box(np.abs(np.arange(n) - middle), half)[:, None]
    return places


def _with_ball(bundle: Bundle, corners: Array, cells: Array, regions: Array, places: Array) -> tuple[Array, Array, Array, Array]:
    """The same with the cells of the box of the ball added."""
    assert bundle.ball is not None
    ball, axes, across = bundle.ball.ball, list(bundle.sections.axes), bundle.across
    n, _, t, _ = bundle.grid.shape
    count = len(corners) // n
    cube = product([np.linspace(-1, 1, across + 1)] * 3)
    core = grid([across] * 3)
    shell, quads = skin(core, cube)
    steps = np.stack(np.unravel_index(shell, [across + 1] * 3))[axes]  # along the axes of the sections
    first = bundle.first[np.flatnonzero(bundle.bodies < 0)[0]]
    on_box = (bundle.planes[0] + steps[0]) * count + (first[0] + steps[1]) * t + first[1] + steps[2]
    inner, wall = ball.center + blown(cube) @ ball.stretch, ball.center + directions(cube[shell]) @ ball.stretch
    added, rounded, depth = stacked(inner, shell, quads, core, [wall, corners[on_box]])
    fresh = len(inner) + len(shell)
    numbers = np.concatenate([len(corners) + np.arange(fresh), on_box])
    within = np.abs(np.vstack([CORE_PLACE * blown(cube), WALL_PLACE * directions(cube[shell])]))[:, axes]
    return _used(
        np.vstack([corners, added[:fresh]]),
        np.vstack([cells, numbers[rounded]]),
        np.concatenate([regions, np.where(depth < 1, BALL_REGION, 0)]),
        np.vstack([places, within]),
    )


def _used(corners: Array, cells: Array, regions: Array, places: Array) -> tuple[Array, Array, Array, Array]:
    """The same with corners of cells only."""
    used, compact = np.unique(cells, return_inverse=True)
    return corners[used], compact.reshape(-1, 8), regions, places[used]
