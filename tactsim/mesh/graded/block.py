"""Blocks of few elements: a grid of cells that grow away from the faces, boxes of rounded cells around lumps, rings around tubes.

Tissue that sticks to a jaw is strained without bound where its free face begins, so that thin cells at the faces are worth more
than many cells (Apel 1999, Anisotropic Finite Elements: Local Estimates and Applications, for grading towards edges).
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InputError
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import BallImage
from tactsim.mesh.affordable import check_unknowns, unknowns_of_cells
from tactsim.mesh.any_inclusion import check_inclusions, checked_solids, inclusion_name
from tactsim.mesh.block import SIZES, BlockMesh, BlockMeshSettings
from tactsim.mesh.fitting.curving import SMALLER, fitted
from tactsim.mesh.graded.beside_jaws import Footprint, footprint_of, widened
from tactsim.mesh.graded.bricks import brick_cells, bricks_of, check_apart
from tactsim.mesh.graded.cells import LEAST_LAYERS, Cells, Filling, from_boxes, with_lump
from tactsim.mesh.graded.lines import Line, lines_around, mirrored_line
from tactsim.mesh.graded.lump import Lump
from tactsim.mesh.graded.rings import BALL_REGION, swept_cells
from tactsim.mesh.graded.sections import Hollow, as_hollow, leading_axis
from tactsim.mesh.graded.side_by_side import Bundle, bundle_of
from tactsim.mesh.structured_block import SIDES, grid, halved_sides, product, ranks
from tactsim.mesh.tetrahedra import mesh_key
from tactsim.units import format_quantity

ATTEMPTS = 3
"""Numbers of cells across that are tried, each larger than the last and with ever fewer layers, until the shapes suit."""
LONG = 5.0
"""Length over width from which on short cells along a lump are flat across it: larger ones suit it better."""


def graded_block(
    size: Sequence[float],
    inclusions: Sequence[Inclusion] = (),
    settings: BlockMeshSettings | None = None,
    flats: Sequence[Array] = (),
) -> BlockMesh:
    """A block of ``size`` (3,) in m, each cell split into six tetrahedra; curved onto the inclusions.

    A sphere or an ellipsoid may lie anywhere in the block, several where boxes along its axes hold them apart; tubes lead along
    one axis side by side, one lump among them at most. Cells are wanted ``edge_size`` thick at the faces (by default a third of
    ``size``), each next one longer by ``growth`` up to ``size``; on an inclusion they are at most about ``inclusion_size`` long,
    shorter where longer ones would be badly curved. Where the ``flats`` of jaws, each by its low and its high corner (2, 2) in m,
    end within the block, cells are thin on both sides of their edges; inclusions must lie between all of them.

    Raises
    ------
    InputError
        If an inclusion is of another kind, they are not apart or side by side or do not suit the block, or the cells
        are too many.
    ConvergenceError
        If the mesh misses the volumes or the shape asked for.
    """
    started, extent, settings = time.perf_counter(), np.asarray(size, float), settings or BlockMeshSettings()
    check_inclusions(extent, inclusions, 0.0)
    footprint = footprint_of(flats, extent, settings)
    shape = (*size, *np.concatenate(footprint.thin[:2]).tolist()) if footprint.more.any() else size
    key = f"graded-{mesh_key(shape, inclusions, settings)}"
    finished = partial(fitted, size=extent, inclusions=inclusions, key=key, started=started, slide=False, smooth=False)
    if not inclusions:
        cells = widened(_plain(footprint), footprint)
        return finished(cells.corners, _sixths(cells.cells, _order(cells.places)), np.zeros(6 * len(cells.cells), np.int64))
    reason: ConvergenceError | None = None
    for finer, fewer in itertools.product(range(ATTEMPTS), range(LEAST_LAYERS)):
        cells = _cells(inclusions, footprint, finer, Filling(settings, fewer))
        simplices = _sixths(cells.cells, _order(cells.places))
        whole = (np.diff(np.sort(simplices, axis=1), axis=1) > 0).all(axis=1)  # a cell of a fan makes two
        try:
            mesh = finished(cells.corners, simplices[whole], np.repeat(cells.regions, 6)[whole], layers=cells.layers)
            return replace(mesh, fewer_layers=fewer)
        except ConvergenceError as error:
            reason = error
    names = " and ".join(inclusion_name(number, inclusion) for number, inclusion in enumerate(inclusions, 1))
    verb = "suit" if len(inclusions) == 1 else "suit all of"
    why = str(reason).removesuffix(f"; {SMALLER}")
    raise ConvergenceError(f"no graded cells {verb} {names}: {why}; take {_other_sizes(inclusions, extent)}mesh.kind: tetrahedra")


def _other_sizes(inclusions: Sequence[Inclusion], extent: Array) -> str:
    """Sizes of cells in words by which bent tubes and long lumps in a block of ``extent`` (3,) in m may suit; else empty."""
    advice = []
    for number, inclusion in enumerate(inclusions, 1):
        solids, name = inclusion.solids(extent), inclusion_name(number, inclusion)
        if (tube := as_hollow(solids)) is not None and np.isfinite(tube.tightest):
            advice.append(f"a smaller mesh.size for the bends of {name}")
        elif tube is None and (widths := np.ptp(solids[0].bounds(), axis=0)).max() > LONG * widths.min():
            advice.append(f"a larger mesh.inclusion_size for the thin {name}")
    return "".join(f"{words}, " for words in advice) + ("or " if advice else "")


def graded_misfit(
    size: Sequence[float], inclusions: Sequence[Inclusion], flats: Sequence[Array], settings: BlockMeshSettings
) -> str | None:
    """Why inclusions between these ``flats`` (2, 2) in m cannot have graded cells; None if they may."""
    try:
        between = _between(inclusions, footprint_of(flats, np.asarray(size, float), settings))
        if between.tubes:
            _bundle(between, 0)
        elif len(between.lumps) > 1:
            check_apart(between.lumps)
    except InputError as error:
        return str(error)
    return None


@dataclass(frozen=True)
class _Between:
    """The part of a block that is meshed around its inclusions, and these by coordinates from its low corner."""

    footprint: Footprint
    lumps: list[Lump]
    tubes: list[Hollow]

    @property
    def ball(self) -> Lump | None:
        """The first lump."""
        return self.lumps[0] if self.lumps else None


def _between(inclusions: Sequence[Inclusion], footprint: Footprint) -> _Between:
    """The inclusions in the footprint of the jaws, which goes from face to face along tubes.

    Raises
    ------
    InputError
        If inclusions are neither lumps nor tubes, or reach beyond an edge of a jaw.
    """
    lumps, tubes = _sorted(inclusions, footprint.block)
    if tubes:
        footprint = footprint.from_face_to_face(axis := leading_axis(tubes, footprint.block))
    lumps, tubes = [lump.moved(-footprint.low) for lump in lumps], [tube.moved(-footprint.low) for tube in tubes]
    held = all((lump.bounds[0] >= 0).all() and (lump.bounds[1] <= footprint.size).all() for lump in lumps)
    if not held or not all(tube.leads(axis, footprint.size) for tube in tubes):
        ends = zip("xy", footprint.low, footprint.high, strict=False)
        flats = ", ".join(f"{name} {format_quantity(low, 'm')} to {format_quantity(high, 'm')}" for name, low, high in ends)
        raise InputError(
            f"graded cells serve inclusions that lie between the flats of both jaws ({flats}), or lead from there along an axis"
        )
    return _Between(footprint, lumps, tubes)


def _bundle(between: _Between, finer: int) -> tuple[Bundle, Array]:
    """What `bundle_of` gives for tubes between flats."""
    footprint = between.footprint
    return bundle_of(between.tubes, between.ball, footprint.size, footprint.settings, finer, thin=footprint.thin)


def _sorted(inclusions: Sequence[Inclusion], extent: Array) -> tuple[list[Lump], list[Hollow]]:
    """The lumps and the tubes that inclusions are.

    Raises
    ------
    InputError
        If one is neither, or there are both.
    """
    lumps, tubes = [], []
    for inclusion in inclusions:
        solids = checked_solids(inclusion, extent)
        ball, tube = solids[0].ball_image(), as_hollow(solids)
        if ball is not None:
            lumps.append(Lump(ball, solids[0].bounds()))
        elif tube is not None:
            tubes.append(tube)
        else:
            raise InputError(f"a {inclusion.kind} cannot be meshed in graded cells; allowed: a ball, stretched or not, or a tube")
    if tubes and len(lumps) > 1:
        raise InputError("graded cells serve one lump beside tubes, or several lumps without")
    return lumps, tubes


def _cells(inclusions: Sequence[Inclusion], footprint: Footprint, finer: int, filling: Filling) -> Cells:
    """Cells around the inclusions, their regions numbered as these."""
    between = _between(inclusions, footprint)
    footprint = between.footprint
    if between.tubes:
        bundle, order = _bundle(between, finer)
        _check_size(footprint, [count - 1 for count in bundle.grid.shape[:3]], bundle.sections.axes)
        cells = swept_cells(bundle, filling)
        cells = replace(cells, regions=_numbered(cells.regions, order, inclusions, footprint.block))
    else:
        cells = _cells_of_lumps(between, finer, filling)
    return widened(cells, footprint)


def _plain(footprint: Footprint) -> Cells:
    """Cells between the flats without inclusions."""
    lines = [mirrored_line(float(length), footprint.settings) for length in footprint.size]
    counts = [len(line) - 1 for line in lines]
    _check_size(footprint, counts)
    corners = product(lines)
    return Cells.plain(corners, grid(counts), np.abs(corners - footprint.size / 2))


def _numbered(regions: Array, order: Array, inclusions: Sequence[Inclusion], extent: Array) -> Array:
    """Regions (H,) as `swept_cells` gives them by the numbers of the inclusions; ``order`` holds those of the tubes."""
    tubes = [k for k, inclusion in enumerate(inclusions, 1) if as_hollow(inclusion.solids(extent)) is not None]
    labels = np.zeros_like(regions)
    labels[regions == BALL_REGION] = next((k for k in range(1, len(inclusions) + 1) if k not in tubes), 0)
    for place, tube in enumerate(order, 1):
        labels[regions == place], labels[regions == -1 - place] = tubes[tube], -1 - tubes[tube]
    return labels


def _cells_of_lumps(between: _Between, finer: int, filling: Filling) -> Cells:
    """Cells around one lump, or around several."""
    lumps, size, settings = between.lumps, between.footprint.size, between.footprint.settings
    if len(lumps) == 1:
        around = lines_around(lumps[0].ball, lumps[0].bounds, size, settings, finer)
        _check_size(between.footprint, [len(line.near) - 1 for line in around])
        return _around(lumps[0].ball, around, filling)
    bricks = bricks_of(lumps, size, settings, finer)
    _check_size(between.footprint, [len(away) - 1 for away in bricks.away])
    return brick_cells(bricks, filling)


def _check_size(footprint: Footprint, cells: Sequence[int], axes: Sequence[int] = (0, 1, 2)) -> None:
    """Refuse a grid of too many cells (3,) along ``axes`` of the footprint, with those beside it."""
    more = footprint.more[list(axes)]
    check_unknowns(unknowns_of_cells((more + cells).tolist()), SIZES)


def _around(ball: BallImage, lines: Sequence[Line], filling: Filling) -> Cells:
    """Cells of a block with a lump, which is region 1."""
    first, shape = np.array([[line.first] for line in lines]), tuple(len(line.near) for line in lines)
    across = [line.across for line in lines]
    places = product([from_boxes(len(line.near), line.first, line.across) for line in lines])
    outside = Cells.plain(*_around_box(lines), places)
    return with_lump(
        outside, ball, across, lambda steps: np.ravel_multi_index(tuple(steps + first), shape), filling, region=1
    ).used()


def _around_box(lines: Sequence[Line]) -> tuple[Array, Array]:
    """Corners (n, 3) of a grid of lines that move to their far places away from the box, and its cells (H, 8) outside the box."""
    corners, moved, away = (
        product(values) for values in zip(*((ln.near, ln.far - ln.near, ln.away) for ln in lines), strict=True)
    )
    for axis in range(3):
        others = np.delete(away, axis, axis=1)
        corners[:, axis] += moved[:, axis] * others.max(axis=1)
    counts = [len(line.near) - 1 for line in lines]
    place = product([np.arange(count) for count in counts])
    first = np.array([line.first for line in lines])
    inside = ((place >= first) & (place < first + [line.across for line in lines])).all(axis=1)
    return corners, grid(counts)[~inside]


def _order(places: Array) -> Array:
    """Order (n,) of corners by which cells are split, the same for a cell and for its mirror images about a middle.

    What is farther from the middle comes first, so that a curved side sees the tip of its tetrahedron; on a lump, what is nearest
    to a corner of the cube around it. ``places`` (n, 3) are distances from the middle.
    """
    distances = (places / places.max()).round(9)
    return ranks((*distances.T, distances.max(axis=1), -np.linalg.norm(distances, axis=1).round(9)))


def _sixths(cells: Array, order: Array) -> Array:
    """Six tetrahedra for each cell (H, 8): from its first corner to the two triangles of each side beyond, cut alike."""
    sides = cells[:, SIDES]
    triangles = halved_sides(sides, order)
    apex = np.take_along_axis(cells, order[cells].argmin(axis=1)[:, None], axis=1)
    beyond = (sides != apex[:, :, None]).all(axis=2)
    chosen = triangles[beyond][:, :, ::-1]  # (3 H, 2, 3), by cell
    tips = np.broadcast_to(np.repeat(apex, 3, axis=0)[:, :, None], (*chosen.shape[:2], 1))
    return np.concatenate([chosen, tips], axis=2).reshape(-1, 4)
