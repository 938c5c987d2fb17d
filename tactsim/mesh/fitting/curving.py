"""From straight labelled tetrahedra to a block of curved ones that fit its surfaces."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.interfaces import Inclusion
from tactsim.interfaces.solid import FACES
from tactsim.mesh.any_inclusion import inclusion_name
from tactsim.mesh.block import FLATNESS, VOLUME_TOLERANCE, BlockMesh, Quality
from tactsim.mesh.fitting.constrained import Constraints
from tactsim.mesh.fitting.labelling import Interfaces, Surfaces, interfaces
from tactsim.mesh.fitting.layers import Layers
from tactsim.mesh.fitting.smoothing import smoothed
from tactsim.mesh.fitting.wedges import side_patches, without_wedges
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh, row_numbers
from tactsim.mesh.quality import jacobian_ratio, mean_ratio, region_volumes, unstretched_ratio

LEAST_CURVATURE = 0.2
"""Ratio of the smallest to the greatest Jacobian below which an element counts as nearly inverted."""
SMALLEST_SHARE = 0.25
"""Fraction of the displacement onto its surface below which a mid-node returns to the midpoint of its edge."""
LEAST_QUALITY, LEAST_STRETCHED = 0.02, 0.002
"""Mean ratios below which a mesh is refused: in general, and of tetrahedra that are only stretched along the axes.

Why the second: cells that are thin in two directions at the edge of a flat and as long as elsewhere along it are meant to be so,
and cut out of bricks they keep the largest angle that interpolation asks of them (Apel 1999, as in `graded.block`)."""
SMALLER = "take smaller elements"
"""What to do about a volume that is missed."""
LEAST_UNSTRETCHED = 0.3
"""Mean ratio above which a tetrahedron is well shaped apart from such a stretch; one of six of a brick has 0.76."""


def fitted(
    corners: Array,
    simplices: Array,
    labels: Array,
    *,
    size: Array,
    inclusions: Sequence[Inclusion],
    key: str,
    started: float,
    part: float = 1.0,
    slide: bool = True,
    smooth: bool = True,
    layers: Layers | None = None,
) -> BlockMesh:
    """The block mesh made of labelled tetrahedra, nodes moved onto the surfaces.

    Parameters
    ----------
    corners, simplices, labels : (n, 3) in m, (E, 4), (E,) as in ``labelling``
    started : what ``time.perf_counter`` gave when meshing began
    part : of the element size at inclusions that was asked for
    slide : whether nodes may move along curved surfaces for better shapes
    smooth : whether nodes may move for better shapes at all, and edges of the block that roll onto a jaw get two elements
    layers : around the inclusions, in which edges bulge with them

    Raises
    ------
    ConvergenceError
        If a region misses its volume, a face is not flat or an element is inverted.
    """
    surfaces = Surfaces(size, [inclusion.solids(size) for inclusion in inclusions])
    walls = interfaces(corners, simplices, labels, surfaces)
    used = np.unique(simplices[labels >= 0])
    layers = (Layers.none(len(corners)) if layers is None else layers).kept(used)
    corners, simplices, labels, walls = _kept(used, corners, simplices, labels, walls)
    corners, simplices, labels = _split_between(corners, simplices, labels, walls)
    if smooth:
        corners, simplices, labels, walls = without_wedges(corners, simplices, labels, walls)
    constraints = walls.constraints(len(corners), surfaces)
    layers = layers.with_others(len(corners) - len(layers.beneath))
    corners = constraints.restored(corners)
    if slide:
        constraints = constraints.holding_edges(corners, walls.triangles, walls.patch)
    else:
        constraints = replace(constraints, held=np.asarray(constraints.on[:, len(FACES) :].any(axis=1)))
    if smooth:
        corners = smoothed(corners, simplices, constraints.directions, constraints.restored)
    _check_shapes(corners, simplices)
    mesh, straightened = curved(quadratic_mesh(corners, simplices, labels), walls, constraints, layers)
    seconds = time.perf_counter() - started
    return assembled(mesh, surfaces, inclusions, key=key, seconds=seconds, straightened=straightened, part=part)


def _check_shapes(corners: Array, simplices: Array) -> None:
    """Refuse tetrahedra (E, 4) that are flat, other than by a stretch along the axes."""
    ratios = mean_ratio(corners, simplices)
    flat = np.flatnonzero(ratios < LEAST_QUALITY)
    stretched = flat[unstretched_ratio(corners, simplices[flat]) > LEAST_UNSTRETCHED]
    allowed = np.full(len(ratios), LEAST_QUALITY)
    allowed[stretched] = LEAST_STRETCHED
    worst = int(np.argmin(ratios / allowed))
    if ratios[worst] < allowed[worst]:
        raise ConvergenceError(f"the worst tetrahedron has a mean ratio of {ratios[worst]:.2g}; allowed: {allowed[worst]}")


def assembled(
    mesh: QuadraticMesh,
    surfaces: Surfaces,
    inclusions: Sequence[Inclusion],
    *,
    key: str,
    seconds: float,
    straightened: int,
    part: float = 1.0,
    fitting: bool = True,
) -> BlockMesh:
    """The block mesh of a mesh, measured; and checked if it is ``fitting``, that is made to follow the surfaces.

    Raises
    ------
    ConvergenceError
        If a facet of the boundary lies on no face of the block or, if it is ``fitting``, a region misses its volume, a face
        is not flat or an element is inverted.
    """
    ratios = mean_ratio(mesh.nodes, mesh.elements[:, :4])
    curvature = float(jacobian_ratio(mesh.nodes, mesh.elements).min())
    block = BlockMesh(
        mesh=mesh,
        region_names=("tissue", *(inclusion_name(number, inclusion) for number, inclusion in enumerate(inclusions, 1))),
        facets=named_facets(mesh, surfaces),
        quality=Quality(float(ratios.min()), float(ratios.mean()), curvature, straightened),
        volumes=np.stack([region_volumes(mesh, len(inclusions) + 1), exact_volumes(surfaces)], axis=1),
        seconds=seconds,
        key=key,
        part=part,
    )
    if fitting:
        check(block, surfaces.size)
    return block


def exact_volumes(surfaces: Surfaces) -> Array:
    """Volumes (R,) in m^3 of the tissue and of every inclusion without its empty space."""
    contents = [[solid.volume() for solid in group] for group in surfaces.solids]
    regions = [outer - sum(hollow) for outer, *hollow in contents]
    return np.array([surfaces.size.prod() - sum(outer for outer, *_ in contents), *regions])


def check(block: BlockMesh, size: Array) -> None:
    """Refuse a mesh of a block of size (3,) in m whose regions miss their volumes, whose faces are not flat, or of which an
    element is inverted.

    Raises
    ------
    ConvergenceError
        Naming the region or the face and by how much it misses.
    """
    for name, error in zip(block.region_names, block.volume_errors, strict=True):
        if not abs(error) <= VOLUME_TOLERANCE:
            raise ConvergenceError(
                f"the mesh of {name} misses its volume by {100 * error:.2g} %; allowed: {100 * VOLUME_TOLERANCE:g} %; {SMALLER}"
            )
    for name, axis, end in FACES:
        facets = block.facets[name]
        off = float(np.abs(block.mesh.nodes[facets, axis] - end * size[axis]).max()) if len(facets) else np.inf
        if not off <= FLATNESS * size.max():
            raise ConvergenceError(
                f"the {name} face of the mesh is {off:.2g} m off its plane; allowed: {FLATNESS * size.max():.2g} m"
            )
    if not block.quality.curvature > 0:
        raise ConvergenceError("the mesh has an inverted element; take smaller elements at inclusions")


def curved(mesh: QuadraticMesh, walls: Interfaces, constraints: Constraints, layers: Layers) -> tuple[QuadraticMesh, int]:
    """The mesh with the mid-nodes of interfaces on them, and the number of those that stay off them to keep elements valid.

    In layers around an interface the mid-nodes of edges move with it, the less the farther they are from it.
    """
    edges, middles = mesh.edges()
    sides = np.concatenate([np.sort(walls.triangles[:, list(pair)], axis=1) for pair in ((0, 1), (1, 2), (0, 2))])
    patch = np.tile(walls.patch, 3)
    _, first, number = np.unique(row_numbers(sides), return_index=True, return_inverse=True)
    on = np.zeros((len(first), constraints.on.shape[1]), bool)
    on[number, patch] = True
    bent = on[:, len(FACES) :].any(axis=1)
    curving, keys = sides[first[bent]], edges @ [mesh.corner_count, 1]
    fitted_middles = middles[np.searchsorted(keys, curving @ [mesh.corner_count, 1])]
    fitting = Constraints(constraints.patches, on[bent], constraints.size).restored(mesh.nodes[fitted_middles])
    beside, pairs, moves = layers.bulges(mesh.nodes, edges, constraints)
    _, owner = np.unique(row_numbers(np.vstack([curving, pairs])), return_inverse=True)
    nodes, moved = mesh.nodes.copy(), np.concatenate([fitted_middles, middles[beside]])
    ends = np.vstack([fitting, mesh.nodes[middles[beside]] + moves])
    starts, nodes[moved] = mesh.nodes[moved], ends
    share = np.ones(owner.max(initial=-1) + 1)
    while True:
        poor = jacobian_ratio(nodes, mesh.elements) < LEAST_CURVATURE
        touched = np.zeros(len(share), bool)
        touched[owner[np.isin(moved, mesh.elements[poor, 4:])]] = True
        touched &= share > 0
        if not touched.any():
            return mesh.moved(nodes), int((share < 1).sum())
        share[touched] = np.where(share[touched] > SMALLEST_SHARE, share[touched] / 2, 0.0)
        part = share[owner][:, None]
        nodes[moved] = np.where(part < 1, starts + part * (ends - starts), ends)


def named_facets(mesh: QuadraticMesh, surfaces: Surfaces) -> dict[str, Array]:
    """Outward boundary facets (F, 6) by name: the faces of the block, and "lumen:k" for the wall of the empty space in k.

    Raises
    ------
    ConvergenceError
        If a facet of the boundary lies on no face of the block.
    """
    facets, _ = mesh.boundary_facets()
    numbers = np.full(len(facets), -1)
    for face, (_, axis, end) in enumerate(FACES):
        off = np.abs(mesh.nodes[facets, axis] - surfaces.size[axis] * end).max(axis=1)
        numbers[off <= FLATNESS * surfaces.size.max()] = face
    names, hollow = [name for name, _, _ in FACES], []
    for number, (_, *spaces) in enumerate(surfaces.solids, 1):
        names += [f"lumen:{number}"] * len(spaces)
        hollow += spaces
    rest = np.flatnonzero(numbers < 0)
    if len(rest) and hollow:
        centres = mesh.nodes[facets[rest, 3:]].mean(axis=1)
        distances = np.abs([solid.signed_distance(centres) for solid in hollow])
        numbers[rest] = len(FACES) + distances.argmin(axis=0)
    elif len(rest):
        raise ConvergenceError(f"{len(rest)} boundary facets of the mesh lie on no face of the block")
    return {name: facets[numbers == number] for number, name in enumerate(names)}


def _kept(
    used: Array, corners: Array, simplices: Array, labels: Array, walls: Interfaces
) -> tuple[Array, Array, Array, Interfaces]:
    """Everything without the tetrahedra outside and in empty spaces, the corners that are ``used`` renumbered."""
    triangles = np.searchsorted(used, walls.triangles)
    return corners[used], np.searchsorted(used, simplices[labels >= 0]), labels[labels >= 0], Interfaces(triangles, walls.patch)


def _split_between(corners: Array, simplices: Array, labels: Array, walls: Interfaces) -> tuple[Array, Array, Array]:
    """Four tetrahedra in place of each that has two sides on one curved patch, where its Jacobian would vanish."""
    patches = side_patches(simplices, walls)
    curved_side = np.sort(np.where(patches >= len(FACES), patches, -1), axis=1)
    between = ((np.diff(curved_side, axis=1) == 0) & (curved_side[:, 1:] >= 0)).any(axis=1)
    parents = simplices[between]
    centres = len(corners) + np.arange(len(parents))
    children = [np.where(np.arange(4) == k, centres[:, None], parents) for k in range(4)]
    return (
        np.vstack([corners, corners[parents].mean(axis=1)]),
        np.vstack([simplices[~between], *children]),
        np.concatenate([labels[~between], np.tile(labels[between], 4)]),
    )
