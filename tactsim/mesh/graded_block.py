"""Blocks of few elements: a grid of cells that grow away from the faces, and around one lump a box of rounded cells.

Tissue that sticks to a jaw is strained without bound where its free face begins, so that thin cells at the faces are worth more
than many cells (Apel 1999, Anisotropic Finite Elements: Local Estimates and Applications, for grading towards edges).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from tactsim.errors import ConvergenceError, InputError
from tactsim.mesh.any_inclusion import check_inclusions
from tactsim.mesh.block import BlockMesh, BlockMeshSettings
from tactsim.mesh.curving import fitted
from tactsim.mesh.inclusions.ellipsoid import EllipsoidSolid
from tactsim.mesh.solid import Inclusion
from tactsim.mesh.structured_block import SIDES, blown, directions, grid, product, ranks, skin, stacked
from tactsim.mesh.tetrahedra import mesh_key

Array = np.ndarray
EDGE_SHARE = 1 / 3
"""Thickness of the cells at the faces over that far away, where none is given."""
ROOM = 0.4
"""How far the box of rounded cells reaches from the lump to the face, as a part of that way."""
NEAR = 1.1
"""Gaps below which the box reaches to a face that a jaw presses, over the thickness of cells at the faces."""
REACH = 2.0
"""Half width of the box over that of the lump, at most."""
LEAST_BETWEEN = 3
"""Cells across the box from jaw to jaw, at least; two miss the volume of a ball by 0.6 %."""
LEAST_ALONG, LEAST_ALONG_NEAR = 4, 5
"""Cells across the box along the jaws, at least, and where it reaches to a jaw. With three no corner lies above the pole of a
ball, and the pressure over a hard one 3 mm from a jaw is 8 to 18 % too low; with four at a jaw, it is wrong by 4 to 6 %."""
THIN = 1 / 3
"""Height over the block's below which three cells along the jaws suffice for a lump that is not near: it is felt little."""
NEAREST = 0.5
"""Part of a cell that must be left before it is added to those from a face to the box."""
ATTEMPTS = 3
"""Numbers of cells across that are tried, each one more than the last, until the shapes suit."""


@dataclass(frozen=True)
class _Line:
    """Ascending coordinates in m from face to face, and the first of those of the ``across`` rounded cells of the box."""

    places: Array
    first: int
    across: int


def graded_block(
    size: Sequence[float], inclusion: Inclusion | None = None, settings: BlockMeshSettings | None = None
) -> BlockMesh:
    """A block of ``size`` (3,) in m, each cell split into six tetrahedra; curved onto the lump, if there is one.

    A sphere or an ellipsoid may lie anywhere in the block. Cells are wanted ``edge_size`` thick at the faces (by default a third
    of ``size``), each next one longer by ``growth`` up to ``size``; on the lump they are at most about ``inclusion_size`` long,
    shorter where it comes so near to a face that longer ones would be badly curved.

    Raises
    ------
    InputError
        If the inclusion is of another kind or does not suit the block.
    ConvergenceError
        If the mesh misses the volumes or the shape asked for.
    """
    started, extent, settings = time.perf_counter(), np.asarray(size, float), settings or BlockMeshSettings()
    held = [] if inclusion is None else [inclusion]
    check_inclusions(extent, held, 0.0)
    key = f"graded-{mesh_key(size, held, settings)}"
    finished = partial(fitted, size=extent, inclusions=held, key=key, started=started, slide=False, smooth=False)
    if inclusion is None:
        lines = [_Line(_mirrored_line(float(length), settings), 0, 0) for length in extent]
        corners, cells = _tensor(lines)
        simplices = _sixths(cells, _mirrored_places(corners, extent / 2, np.eye(3)))
        return finished(corners, simplices, np.zeros(len(simplices), np.int64))
    solid = inclusion.solids(extent)[0]
    if not isinstance(solid, EllipsoidSolid):
        raise InputError(f"a {inclusion.kind} cannot be meshed in graded cells; allowed: sphere, ellipsoid")
    for finer in range(ATTEMPTS):
        corners, cells, labels = _around(solid, _lines(solid, extent, settings, finer))
        simplices = _sixths(cells, _mirrored_places(corners, solid.center, solid.stretch))
        try:
            return finished(corners, simplices, np.repeat(labels, 6))
        except ConvergenceError:
            if finer == ATTEMPTS - 1:
                raise
    raise AssertionError("every attempt returns or raises")


def _around(solid: EllipsoidSolid, lines: Sequence[_Line]) -> tuple[Array, Array, Array]:
    """Corners (n, 3), cells (H, 8) and regions (H,) of a block with a lump."""
    corners, outside = _tensor(lines)
    logical = product([np.linspace(-1, 1, line.across + 1) for line in lines])
    core = grid([line.across for line in lines])
    shell, quads = skin(core, logical)
    inner = solid.center + blown(logical) @ solid.stretch
    wall = solid.center + directions(logical[shell]) @ solid.stretch
    steps = np.stack(np.unravel_index(shell, [line.across + 1 for line in lines])) + np.array([[line.first] for line in lines])
    on_box = np.ravel_multi_index(tuple(steps), tuple(len(line.places) for line in lines))
    added, rounded, depth = stacked(inner, shell, quads, core, [wall, corners[on_box]])
    numbers = np.concatenate([len(corners) + np.arange(len(inner) + len(shell)), on_box])
    points = np.vstack([corners, added[: len(inner) + len(shell)]])
    cells = np.vstack([outside, numbers[rounded]])
    used, compact = np.unique(cells, return_inverse=True)
    labels = np.concatenate([np.zeros(len(outside), np.int64), (depth < 1).astype(np.int64)])
    return points[used], compact.reshape(cells.shape), labels


def _lines(solid: EllipsoidSolid, extent: Array, settings: BlockMeshSettings, finer: int) -> list[_Line]:
    """For each axis: places graded from a face to the box, even through the box to its middle, and on to the other face."""
    lines = []
    wanted = round(np.pi / 2 * float(solid.semi_axes.max()) / settings.inclusion_size)
    along = _least_along(solid.bounds()[:, 2], float(extent[2]), settings)
    for axis, ((low, high), center, length) in enumerate(zip(solid.bounds().T, solid.center, extent, strict=True)):
        half = (high - low) / 2
        below, above = (_left(gap, settings, pressed=axis == 2) for gap in (low, length - high))
        begin = max(center - REACH * half, below)
        end = min(center + REACH * half, length - above)
        across = max(LEAST_BETWEEN if axis == 2 else along, wanted) + finer
        before = _spaced(begin, settings)
        after = length - _spaced(length - end, settings)[::-1]
        within = np.interp(np.linspace(-1, 1, across + 1), [-1, 0, 1], [begin, center, end])
        lines.append(_Line(np.concatenate([before[:-1], within, after[1:]]), len(before) - 1, across))
    return lines


def _left(gap: float, settings: BlockMeshSettings, *, pressed: bool) -> float:
    """Way in m that the box leaves to a face ``gap`` away from the lump; none to a face that a jaw presses and that is near.

    Thin cells along the edges of a pressed face turn inside out when the free faces roll onto the jaw.
    """
    return 0.0 if pressed and _near(gap, settings) else (1 - ROOM) * gap


def _near(gap: float, settings: BlockMeshSettings) -> bool:
    """Whether the box reaches over a gap in m to a face that a jaw presses."""
    return gap < NEAR * _edge(settings)


def _least_along(heights: Array, height: float, settings: BlockMeshSettings) -> int:
    """Least number of cells across the box along the jaws around a lump between two heights in m."""
    low, high = heights
    if _near(min(low, height - high), settings):
        return LEAST_ALONG_NEAR
    return LEAST_BETWEEN if high - low < THIN * height else LEAST_ALONG


def _edge(settings: BlockMeshSettings) -> float:
    """Thickness of cells at the faces in m."""
    return min(settings.edge_size or EDGE_SHARE * settings.size, settings.size)


def _spaced(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from a face at 0 to ``length``: the first cell ``edge_size`` thick, the others stretched to fit; or
    one cell, if most of a second one would not find room."""
    if length <= 0:
        return np.zeros(1)
    thickness = [_edge(settings)]
    while sum(thickness) + NEAREST * (further := min(thickness[-1] * (1 + settings.growth), settings.size)) <= length:
        thickness.append(further)
    steps = np.array(thickness)
    if len(steps) == 1:
        return np.array([0.0, length])
    steps[1:] *= (length - steps[0]) / steps[1:].sum()
    return np.append(np.concatenate([[0.0], np.cumsum(steps[:-1])]), length)


def _mirrored_line(length: float, settings: BlockMeshSettings) -> Array:
    """Ascending places in m from face to face, those of one half the mirror image of the others."""
    half = _spaced(length / 2, settings)
    return np.concatenate([half, length - half[-2::-1]])


def _tensor(lines: Sequence[_Line]) -> tuple[Array, Array]:
    """Corners (n, 3) of a grid, and its cells (H, 8) outside the box."""
    counts = [len(line.places) - 1 for line in lines]
    place = product([np.arange(count) for count in counts])
    first = np.array([line.first for line in lines])
    inside = ((place >= first) & (place < first + [line.across for line in lines])).all(axis=1)
    return product([line.places for line in lines]), grid(counts)[~inside]


def _mirrored_places(corners: Array, center: Array, stretch: Array) -> Array:
    """Places (n,) of corners in an order that is the same for a cell and for its mirror images about the centre.

    What is farther from the lump comes first, in lengths in which it is a ball, so that a curved side sees the tip of its
    tetrahedron; on the ball, what is nearest to a corner of the cube around it.
    """
    distances = np.abs(np.linalg.solve(stretch, (corners - center).T).T)
    distances = (distances / distances.max()).round(9)
    return ranks((*distances.T, distances.max(axis=1), -np.linalg.norm(distances, axis=1).round(9)))


def _sixths(cells: Array, places: Array) -> Array:
    """Six tetrahedra for each cell (H, 8): from its first corner to the two triangles of each side beyond, cut alike."""
    sides = cells[:, SIDES]
    start = places[sides].argmin(axis=2)
    turned = np.take_along_axis(sides, (start[:, :, None] + np.arange(4)) % 4, axis=2)
    triangles = np.stack([turned[:, :, [0, 1, 2]], turned[:, :, [0, 2, 3]]], axis=2)
    apex = np.take_along_axis(cells, places[cells].argmin(axis=1)[:, None], axis=1)
    beyond = (sides != apex[:, :, None]).all(axis=2)
    chosen = triangles[beyond][:, :, ::-1]  # (3 H, 2, 3), by cell
    tips = np.broadcast_to(np.repeat(apex, 3, axis=0)[:, :, None], (*chosen.shape[:2], 1))
    return np.concatenate([chosen, tips], axis=2).reshape(-1, 4)
