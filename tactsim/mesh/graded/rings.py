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
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.mesh.affordable import check_along
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.graded.lines import LEAST_ALONG, PAIRED, edge_thickness, mirrored_line, planes_across
from tactsim.mesh.graded.sections import Hollow, Sections, leading_axis, sections_of
from tactsim.mesh.structured_block import blown, directions, product

CORE_PLACE, WALL_PLACE = 0.4, 0.8
"""Distances from the middle of the box, of which the sides are one away, at which core and wall count when cells are split."""


@dataclass(frozen=True)
class Bundle:
    """Tubes and the lines around them in n planes.

    Attributes
    ----------
    sections : of the tubes
    across : cells across each box along the second and the third axis
    first : (k, 2) lines at which the boxes begin
    grid : (n, w, t, 2) places of the crossings of lines in m
    wall : (k,) rings of cells in each wall
    """

    sections: Sections
    across: tuple[int, int]
    first: Array
    grid: Array
    wall: tuple[int, ...]


@dataclass(frozen=True)
class Plane:
    """Cells of a plane across tubes, the same in all planes.

    Attributes
    ----------
    points : (n, m, 3) in m, by the axes of the sections
    cells : (q, 4) around each cell, from the second axis to the third
    owner : (q,) tube of a cell of a core or a wall, -1 in tissue
    core : (q,) whether a cell belongs to a core
    logical : (m, 2) places by which cells are split, from the middle of the nearest box
    """

    points: Array
    cells: Array
    owner: Array
    core: Array
    logical: Array


def bundle_of(tubes: Sequence[Hollow], size: Array, settings: BlockMeshSettings, finer: int) -> tuple[Bundle, Array]:
    """The lines around tubes in a block of size (3,) in m, and the numbers (k,) of the tubes in their order.

    ``finer`` counts how often cells across the boxes were added.

    Raises
    ------
    InputError
        If the tubes do not lead along one axis side by side, or the cells are too many.
    """
    axis = leading_axis(tubes, size)
    ends = [tube.ends(axis, size) for tube in tubes]
    sections, order = sections_of(tubes, axis, planes_along(float(size[axis]), ends, settings), size)
    arc = np.pi / 2 * float(sections.radii.max()) / settings.inclusion_size
    check_along(arc, f"mesh.inclusion_size {settings.inclusion_size:.3g} m")
    across = PAIRED * (-(-max(LEAST_ALONG, round(arc)) // PAIRED) + finer)
    extent = size[list(sections.axes)]
    planes = []
    for k in (1, 2):
        middles, sides = sections.centers[..., k].ravel(), sections.bounds[:, :, k - 1].reshape(-1, 2)
        planes.append(planes_across(middles, sides, float(extent[k]), across, settings, pressed=sections.axes[k] == 2))
    grid = _bent(planes, across)
    wall = tuple(max(1, round((outer - inner) / settings.inclusion_size)) for outer, inner in sections.radii)
    first = np.array([[begin for _, begin in planes]])
    return Bundle(sections, (across, across), first, grid, wall), order


def _bent(planes: Sequence[tuple[tuple[list[Array], list[Array]], int]], across: int) -> Array:
    """Crossings (n, w, t, 2) in m of lines around one box in each plane, that move to their far places away from the box."""
    near, far = zip(*((np.array(beside), np.array(at_faces)) for (beside, at_faces), _ in planes), strict=True)
    away = [_away(lines, begin, across) for lines, (_, begin) in zip(near, planes, strict=True)]
    along = near[0][:, :, None] + away[1][:, None, :] * (far[0] - near[0])[:, :, None]
    beside = near[1][:, None, :] + away[0][:, :, None] * (far[1] - near[1])[:, None, :]
    return np.stack([along, beside], axis=-1)


def _away(lines: Array, first: int, across: int) -> Array:
    """Way (n, lines) from the box, as a part of that to the face: 0 in the box, 1 at the faces that it does not touch."""
    begin, end = lines[:, [first]], lines[:, [first + across]]
    length = lines[:, [-1]]
    below = (begin - lines) / np.where(begin > 0, begin, np.inf)
    above = (lines - end) / np.where(length > end, length - end, np.inf)
    return np.maximum(0.0, np.maximum(below, above))


def planes_along(length: float, ends: Sequence[tuple[float, float]], settings: BlockMeshSettings) -> Array:
    """Ascending places in m from face to face: graded from the faces and from the ends of tubes on the way."""
    knots = np.unique([0.0, length, *(end for pair in ends for end in pair)])
    if len(knots) == 2:
        return mirrored_line(length, settings)
    sizes = [edge_thickness(settings), *[settings.inclusion_size] * (len(knots) - 2), edge_thickness(settings)]
    places = [knots[:1]]
    for k, (low, high) in enumerate(itertools.pairwise(knots)):
        places.append(low + _between(float(high - low), (sizes[k], sizes[k + 1]), settings)[1:])
        places[-1][-1] = high
    return np.concatenate(places)


def _between(length: float, thickness: tuple[float, float], settings: BlockMeshSettings) -> Array:
    """Ascending places from 0 to ``length`` in m: cells of given thickness at both ends, growing towards each other."""
    sides: tuple[list[float], list[float]] = ([], [])
    following = list(thickness)
    while sum(sides[0]) + sum(sides[1]) + min(following) / 2 < length:
        k = int(following[1] < following[0])
        sides[k].append(following[k])
        following[k] = min(max(settings.size, following[k]), following[k] * (1 + settings.growth))
        check_along(len(sides[0]) + len(sides[1]), "mesh.size, mesh.edge_size and mesh.growth")
    steps = np.array([*sides[0], *sides[1][::-1]])
    return np.concatenate([[0.0], np.cumsum(steps)]) * length / steps.sum()


def plane_of(bundle: Bundle) -> Plane:
    """The cells of all planes."""
    n, w, t, _ = bundle.grid.shape
    number = np.arange(w * t).reshape(w, t)
    places = bundle.sections.places
    flat = np.broadcast_to(places[:, None, None, None], (n, w, t, 1))
    points = [np.concatenate([flat, bundle.grid], axis=-1).reshape(n, w * t, 3)]
    plain = np.ones((w - 1, t - 1), bool)
    for i, j in bundle.first:
        plain[i : i + bundle.across[0], j : j + bundle.across[1]] = False
    cells = [_quads(number)[plain.ravel()]]
    owner, core = [np.full(len(cells[0]), -1)], [np.zeros(len(cells[0]), bool)]
    logical, count = [_grid_places(bundle)], w * t
    for k, (i, j) in enumerate(bundle.first):
        loop = _around(number[i : i + bundle.across[0] + 1, j : j + bundle.across[1] + 1])
        disc, quads, depth = _disc(bundle.across, loop, count, bundle.wall[k])
        points.append(_placed_disc(disc, bundle, k))
        count += len(disc)
        cells.append(quads)
        wall = (depth >= 1) & (depth <= bundle.wall[k])
        owner.append(np.where((depth < 1) | wall, k, -1))
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


def _disc(across: tuple[int, int], loop: Array, count: int, wall: int) -> tuple[Array, Array, Array]:
    """Points (m, 3) of a box: in the unit disc of the bore, and how many rings beyond it; its cells (q, 4), and the depth (q,).

    Cells are numbered from ``count`` on and end at the numbers ``loop`` (p,) of the sides of the box. The depth is -1 in the
    core, 0 in the ring around it, 1 to ``wall`` in the wall and ``wall + 1`` beyond.
    """
    square = product([np.linspace(-1, 1, cells + 1) for cells in across])
    logical = np.column_stack([square, np.zeros(len(square))])
    number = np.arange(len(square)).reshape(across[0] + 1, across[1] + 1)
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
    for plane in sections.ends[k]:
        if 0 < plane < len(sections.places) - 1:
            tangent = sections.tangents[plane, k]
            offset[plane] -= (offset[plane] @ tangent)[:, None] * tangent
    return np.asarray(sections.centers[:, k, None] + offset)


def _grid_places(bundle: Bundle) -> Array:
    """Places (w t, 2) of the crossings of lines from the middle of the nearest box, whose sides are one away."""
    lines = []
    for axis, count in enumerate(bundle.grid.shape[1:3]):
        index, half = np.arange(count)[:, None], bundle.across[axis] / 2
        steps = np.abs(index - bundle.first[:, axis] - half)
        lines.append(np.where(steps > half, 1 + steps - half, steps / half).min(axis=1))
    return product(lines)


def _disc_places(disc: Array, wall: int) -> Array:
    """Places (m, 2) of the points of a disc (m, 3), within those of the sides of the box."""
    share = np.where(np.linalg.norm(disc[:, :2], axis=1) > 1 - 1e-9, disc[:, 2] + 1, 0) / (wall + 1)
    return (CORE_PLACE + (WALL_PLACE - CORE_PLACE) * share)[:, None] * np.abs(disc[:, :2])


def swept_cells(bundle: Bundle) -> tuple[Array, Array, Array, Array]:
    """Corners (n, 3) in m by the axes of the block, cells (H, 8), their regions (H,) and the places (n, 3) of the corners.

    The wall of the tube k of the bundle is the region k + 1, the space in it - 2 - k, the tissue 0.
    """
    plane = plane_of(bundle)
    planes, count, _ = plane.points.shape
    corners = np.empty((planes * count, 3))
    corners[:, list(bundle.sections.axes)] = plane.points.reshape(-1, 3)
    turned = (bundle.sections.axes[1] - bundle.sections.axes[0]) % 3 == 1
    a, b, c, d = plane.cells.T if turned else plane.cells[:, ::-1].T
    side = np.stack([a, b, d, c], axis=1)
    step = np.arange(planes - 1)[:, None, None] * count
    cells = (step + np.hstack([side, side + count])[None]).reshape(-1, 8)
    index, regions = np.arange(planes - 1)[:, None], np.zeros((planes - 1, len(plane.cells)), np.int64)
    for k, (begin, end) in enumerate(bundle.sections.ends):
        within = (index >= begin) & (index < end) & (plane.owner == k)
        regions = np.where(within, np.where(plane.core, -2 - k, k + 1), regions)
    middle = np.abs(np.arange(planes) - (planes - 1) / 2)
    places = np.column_stack([np.repeat(middle, count), np.tile(plane.logical, (planes, 1))])
    used, compact = np.unique(cells, return_inverse=True)
    return corners[used], compact.reshape(-1, 8), regions.ravel(), places[used]
