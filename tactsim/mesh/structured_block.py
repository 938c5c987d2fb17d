"""Blocks meshed without a mesher: split grids, and a grid of layers around one lump. Both repeat by construction."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.mesh.affordable import PER_TETRAHEDRON, check_along, check_unknowns, unknowns_of_cells
from tactsim.mesh.any_inclusion import check_inclusions
from tactsim.mesh.block import BlockMesh, BlockMeshSettings
from tactsim.mesh.fitting.curving import assembled, fitted
from tactsim.mesh.fitting.labelling import Surfaces
from tactsim.mesh.quadratic import quadratic_mesh
from tactsim.mesh.solid import unit_vectors
from tactsim.mesh.tetrahedra import mesh_key

CORE, ROUNDNESS = 0.5, 0.7
"""Half width of the cube of cells in the lump, over its radius, and how far the cube is blown up towards a ball."""
LEAST_AROUND = 4
"""Cells along a quarter of a circle around the lump, at least; always even, so that a middle plane cuts no cell."""
_KUHN = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])
"""Six tetrahedra of a cell whose corners are numbered by x + 2 y + 4 z; equal diagonals on opposite sides."""
SIDES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
"""Sides of such a cell, each around its edge, outward."""
ON_SIDE = 1e-9
"""Distance from a side of a grid that counts as on it, over the size of the grid."""


def structured_block(
    size: Sequence[float],
    cells: tuple[int, int, int],
    inclusions: Sequence[Inclusion] = (),
) -> BlockMesh:
    """A grid of cells, each split into six tetrahedra that fit their neighbours; regions by centroid, so that they are ragged.

    Parameters
    ----------
    size : (3,) in m
    cells : number of cells along each side

    Raises
    ------
    InputError
        If the inclusions do not suit the block, or the cells are too many.
    """
    started, extent = time.perf_counter(), np.asarray(size, float)
    if len(cells) != 3 or min(cells) < 1:
        raise InputError(f"the numbers of cells are {cells}; allowed: three numbers from 1")
    check_unknowns(unknowns_of_cells(cells), f"mesh.cells {list(cells)}")
    check_inclusions(extent, inclusions, 0.0)
    corners = product([np.linspace(0.0, extent[k], cells[k] + 1) for k in range(3)])
    simplices = grid(cells)[:, _KUHN].reshape(-1, 4)
    surfaces = Surfaces(extent, [inclusion.solids(extent) for inclusion in inclusions])
    labels = surfaces.labels(corners[simplices].mean(axis=1))
    mesh = quadratic_mesh(corners, simplices[labels >= 0], labels[labels >= 0])
    key = f"structured-{mesh_key((*size, *cells), inclusions, BlockMeshSettings())}"
    seconds = time.perf_counter() - started
    return assembled(mesh, surfaces, inclusions, key=key, seconds=seconds, straightened=0, fitting=False)


def morphed_block(size: Sequence[float], inclusion: Inclusion, settings: BlockMeshSettings | None = None) -> BlockMesh:
    """Cells in a lump and in layers around it out to the faces, each split into twelve tetrahedra; curved onto the lump.

    A sphere or an ellipsoid may lie anywhere in the block; the numbers of cells follow from the settings, the largest axis
    and the block only, so that lumps moved or turned have meshes of one topology.

    Raises
    ------
    InputError
        If the inclusion is of another kind or does not suit the block, or the cells are too many.
    ConvergenceError
        If the mesh misses the volumes or the shape asked for.
    """
    started, extent, settings = time.perf_counter(), np.asarray(size, float), settings or BlockMeshSettings()
    check_inclusions(extent, [inclusion], settings.least_gap)
    ball = inclusion.solids(extent)[0].ball_image()
    if ball is None:
        raise InputError(f"a {inclusion.kind} cannot be meshed in layers; allowed: a ball, stretched or not")
    radius, size_at = ball.longest, settings.inclusion_size
    check_along(np.pi / 2 * radius / size_at, f"mesh.inclusion_size {size_at:.3g} m")
    around = max(LEAST_AROUND, 2 * round(np.pi / 4 * radius / size_at))
    cell = np.pi / 2 * radius / around
    within = max(1, round((1 - CORE) * radius / cell))
    beyond = outer_steps(max(cell, float(extent.mean()) / 2 - radius) / 2, cell, settings)
    cells = around**3 + 6 * around**2 * (within + len(beyond))
    check_unknowns(12 * PER_TETRAHEDRON * cells, "mesh.inclusion_size, mesh.size and mesh.growth")
    logical = product([np.linspace(-1, 1, around + 1)] * 3)
    core = grid((around,) * 3)
    shell, quads = skin(core, logical)
    inner = ball.center + blown(logical) @ ball.stretch
    wall = ball.center + directions(logical[shell]) @ ball.stretch
    outer = (logical[shell] + 1) / 2 * extent
    layers = [inner[shell] + share * (wall - inner[shell]) for share in np.arange(1, within + 1) / within]
    layers += [wall + share * (outer - wall) for share in beyond]
    corners, hexahedra, depth = stacked(inner, shell, quads, core, layers)
    simplices, corners = twelfths(hexahedra, corners, _mirrored_order(logical, shell, len(layers)))
    labels = np.repeat((depth < within).astype(np.int64), 12)
    key = f"morphed-{mesh_key(size, [inclusion], settings)}"
    return fitted(corners, simplices, labels, size=extent, inclusions=[inclusion], key=key, started=started, slide=False)


def outer_steps(distance: float, cell: float, settings: BlockMeshSettings) -> Array:
    """Ascending fractions (n,) of the distance in m from lump to faces at which layers end; cells grow to the wanted size.

    Raises
    ------
    InputError
        If the cells are too many.
    """
    steps = [cell]
    while sum(steps) < distance:
        steps.append(min(settings.size, steps[-1] * (1 + settings.growth)))
        check_along(len(steps), f"mesh.size {settings.size:.3g} m at a growth of {settings.growth:.3g}")
    return np.cumsum(steps) / np.sum(steps)


def product(lines: Sequence[Array]) -> Array:
    """Points (n, d) of a grid of d coordinates, the last one running fastest."""
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(lines))


def grid(cells: Sequence[int]) -> Array:
    """Corners (H, 8) of the cells of a grid, numbered by x + 2 y + 4 z in each."""
    index = np.arange(np.prod(np.add(cells, 1))).reshape(np.add(cells, 1))
    parts = [index[i : cells[0] + i, j : cells[1] + j, k : cells[2] + k].ravel() for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    return np.stack(parts, axis=1)


def directions(logical: Array) -> Array:
    """Unit vectors (n, 3) towards points of the cube [-1, 1]^3, evenly spread in angle."""
    return unit_vectors(np.tan(np.pi / 4 * logical))


def blown(logical: Array) -> Array:
    """Points (n, 3) of the cube [-1, 1]^3 in the core of the unit ball."""
    spread = np.tan(np.pi / 4 * logical)
    reach = np.abs(spread).max(axis=1, keepdims=True)
    return CORE * ((1 - ROUNDNESS * reach) * spread + ROUNDNESS * reach**2 * directions(logical))


def skin(core: Array, logical: Array) -> tuple[Array, Array]:
    """Nodes (s,) on the surface of a grid of cells, and its quadrilaterals (q, 4) by their place among these, outward."""
    sides = core[:, SIDES].reshape(-1, 4)
    outer = (np.abs(logical[sides].mean(axis=1)) > 1 - 1e-12).any(axis=1)
    shell = np.unique(sides[outer])
    return shell, np.searchsorted(shell, sides[outer])


def stacked(inner: Array, shell: Array, quads: Array, core: Array, layers: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Corners (n, 3), cells (H, 8) and depth (H,) of the core (-1) and of the layers around it (0, 1, ...)."""
    numbers = [shell, *(len(inner) + k * len(shell) + np.arange(len(shell)) for k in range(len(layers)))]
    cells = [core]
    for below, above in itertools.pairwise(numbers):
        a, b, c, d = quads.T
        cells.append(np.stack([below[a], below[b], below[d], below[c], above[a], above[b], above[d], above[c]], axis=1))
    depth = np.repeat(np.arange(-1, len(layers)), [len(part) for part in cells])
    return np.vstack([inner, *layers]), np.vstack(cells), depth


def _mirrored_order(logical: Array, shell: Array, layers: int) -> Array:
    """Places (n,) of the corners in an order that is the same for a side of a cell and for its mirror images."""
    distances = np.vstack([np.abs(logical), *[np.abs(logical[shell])] * layers]).round(9)
    depth = np.repeat(np.arange(layers + 1), [len(logical), *[len(shell)] * layers])
    return ranks((*distances.T, depth))


def ranks(keys: tuple[Array, ...]) -> Array:
    """Places (n,) of entries in the order of their keys (n,), the last key first."""
    return np.argsort(np.lexsort(keys))


def halved_sides(sides: Array, places: Array) -> Array:
    """Two triangles (H, 6, 2, 3) for each side of cells (H, 6, 4), whose diagonal starts at its first place (n,)."""
    first = places[sides].argmin(axis=2)
    turned = np.take_along_axis(sides, (first[:, :, None] + np.arange(4)) % 4, axis=2)
    return np.stack([turned[:, :, [0, 1, 2]], turned[:, :, [0, 2, 3]]], axis=2)


def twelfths(cells: Array, corners: Array, places: Array) -> tuple[Array, Array]:
    """Twelve tetrahedra for each cell (H, 8), around its centre; the diagonal of a side starts at its first place (n,)."""
    triangles = halved_sides(cells[:, SIDES], places).reshape(len(cells), 12, 3)
    centres = len(corners) + np.arange(len(cells))
    tips: Array = np.broadcast_to(centres[:, None, None], (len(cells), 12, 1))
    simplices = np.concatenate([triangles[:, :, ::-1], tips], axis=2)
    return simplices.reshape(-1, 4), np.vstack([corners, corners[cells].mean(axis=1)])
