"""The cut of deformed quadratic tetrahedra by a plane across an axis, in which no element needs to end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.mesh.quadratic import EDGES, FACETS, MIRROR
from tactsim.results import FieldFrame
from tactsim.results.fields import DISPLACEMENT, REGION

FACES = np.array(FACETS[3])
"""Nodes (4, 6) of the faces of a quadratic tetrahedron, as quadratic triangles seen from outside, in the order of VTK."""
QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""Corners of the straight triangles in a quadratic triangle."""
_EIGHTHS = np.array(
    [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3], [4, 9, 6, 7], [4, 9, 7, 8], [4, 9, 8, 5], [4, 9, 5, 6]]
)
"""Corners of the straight tetrahedra in a quadratic tetrahedron."""
PARTS = 4
"""Straight parts, a power of two, in which a curved edge is drawn."""
BEYOND_NODES = 0.15
"""How far a curved element may reach beyond its nodes, over its size; a parabola through three values overshoots by an eighth."""
SLIVER = 1e-4
"""Triangles thinner than this part of the block are left out: nobody sees the gap."""
OUTER = -1
"""Stands for the region beyond the boundary."""


@dataclass(frozen=True)
class PlaneCut:
    """What a plane shows of a deformed body.

    Attributes
    ----------
    triangles : (T, 3, 2) corners in m, along the two other axes in their order
    values : (T, 3) at the corners
    regions : (T,) of the triangles: 0 is the tissue, k the inclusion k
    segments : (S, 2, 2) ends in m of the pieces of the outline and of the interfaces
    between : (S, 2) regions on both sides of each piece, the lower first; ``OUTER`` beyond the boundary
    """

    triangles: Array
    values: Array
    regions: Array
    segments: Array
    between: Array

    def areas(self) -> Array:
        """Areas (T,) in m^2."""
        return np.abs(np.linalg.det(self.triangles[:, 1:] - self.triangles[:, :1])) / 2


def deformed(frame: FieldFrame) -> Array:
    """Deformed nodes (n, 3) in m."""
    return frame.points + frame.point_data[DISPLACEMENT]


def regions_of(frame: FieldFrame) -> Array:
    """Region (E,) of every element: 0 is the tissue, k the inclusion k."""
    count = len(frame.cells["tetra10"])
    return np.asarray(frame.cell_data.get(REGION, np.zeros(count))).ravel().round().astype(int)


def plane_cut(frame: FieldFrame, axis: int, level: float, values: Array) -> PlaneCut:
    """The cut where the deformed coordinate ``axis`` is ``level`` in m, with values interpolated on it.

    ``values`` are nodal (n,), or (E, 4) at the corners of each element, linear in it: these may jump between elements.
    """
    nodes, others = deformed(frame), [k for k in range(3) if k != axis]
    nodal_values = np.column_stack([nodes[:, axis] - level, nodes[:, others]])
    elements, (faces, between) = frame.cells["tetra10"], interfaces(frame)
    crossed = _crossed(nodal_values, elements)
    cut_values = values[elements[crossed]] if values.ndim == 1 else _quadratic_values(values[crossed])
    regions = np.broadcast_to(regions_of(frame)[crossed, None], cut_values.shape)
    cut_nodes = np.concatenate([nodal_values[elements[crossed]], np.stack([cut_values, regions], axis=2)], axis=2)
    cut = _cut_tetrahedra(_divided(cut_nodes))
    near = _crossed(nodal_values, faces)
    pieces, number = _cut_triangles(_divided(nodal_values[faces[near]]))
    longest = np.linalg.norm(cut[:, :, 1:3] - np.roll(cut[:, :, 1:3], 1, axis=1), axis=2).max(axis=1, initial=0.0)
    whole = np.abs(np.linalg.det(cut[:, 1:, 1:3] - cut[:, :1, 1:3])) > SLIVER * np.ptp(nodes) * longest
    triangles, shown, inside = cut[whole, :, 1:3], cut[whole, :, 3], cut[whole, 0, 4].round().astype(int)
    return PlaneCut(triangles, shown, inside, pieces[:, :, 1:3], between[near[number // PARTS**2]])


def _crossed(nodal_values: Array, elements: Array) -> Array:
    """Numbers of the elements that the plane may pass: between its nodes a curved one may reach a little farther than these."""
    side = nodal_values[elements, 0]
    beyond = BEYOND_NODES * np.ptp(side, axis=1)
    return np.flatnonzero((side.min(axis=1) < beyond) & (side.max(axis=1) >= -beyond))


def _quadratic_values(corners: Array) -> Array:
    """Values (E, 10) at the nodes of elements in which they are linear, from those at the corners (E, 4)."""
    return np.hstack([corners, np.stack([(corners[:, i] + corners[:, j]) / 2 for i, j in EDGES[3]], axis=1)])


def _divided(nodal_values: Array) -> Array:
    """What quadratic simplices carry at their nodes (E, 6 or 10, c), at the corners (S, d + 1, c) of small straight ones."""
    flat = nodal_values.shape[1] == 6
    corners = _TRIANGLES if flat else _TETRAHEDRA
    shapes = _quadratic(corners, EDGES[2 if flat else 3])
    parts = shapes.reshape(-1, shapes.shape[-1]) @ nodal_values
    return parts.reshape(-1, corners.shape[1], nodal_values.shape[2])


def _quadratic(corners: Array, edges: Sequence[tuple[int, int]]) -> Array:
    """Quadratic shape functions, corners first, at barycentric coordinates (..., d + 1)."""
    middles = [4 * corners[..., i] * corners[..., j] for i, j in edges]
    return np.concatenate([corners * (2 * corners - 1), np.stack(middles, axis=-1)], axis=-1)


def _parts(edges: Sequence[tuple[int, int]], children: Array) -> Array:
    """Barycentric coordinates (P, d + 1, d + 1) of the corners of the parts of a simplex, halved as often as PARTS needs."""
    corners = np.eye(children.shape[1])[None]
    for _ in range(int(np.log2(PARTS))):
        middles = np.stack([(corners[:, i] + corners[:, j]) / 2 for i, j in edges], axis=1)
        corners = np.concatenate([corners, middles], axis=1)[:, children].reshape(-1, *corners.shape[1:])
    return corners


def interfaces(frame: FieldFrame) -> tuple[Array, Array]:
    """Faces (F, 6) on the boundary or between regions, and the regions (F, 2) on both sides, the lower first.

    They are seen from outside the region with the higher number.
    """
    faces = frame.cells["tetra10"][:, FACES].reshape(-1, 6)
    owners = np.repeat(regions_of(frame), len(FACES))
    order = np.lexsort(np.sort(faces[:, :3], axis=1).T)
    ranked = np.sort(faces[order, :3], axis=1)
    same = np.append((ranked[1:] == ranked[:-1]).all(axis=1), False)
    second = np.append(False, same[:-1])
    others = np.full(len(order), OUTER)
    others[:-1][same[:-1]] = owners[order[1:]][same[:-1]]
    mine = owners[order]
    kept = ~second & (mine != others)
    both = np.sort(np.column_stack([mine, others])[kept], axis=1)
    between, inward = faces[order[kept]], mine[kept] < others[kept]
    between[inward] = between[inward][:, MIRROR[2]]
    return between, both


def _cut_tetrahedra(simplices: Array) -> Array:
    """Triangles (T, 3, c) in which tetrahedra (n, 4, c) are cut where their first coordinate is 0: one or two of each."""
    above, ordered = _by_side(simplices)
    crossings = _corners_cut_off(above, ordered)
    a, b, c, d = np.moveaxis(ordered[above == 2], 1, 0)
    corners = [_crossing(*ends) for ends in ((a, c), (a, d), (b, d), (b, c))]
    crossings += [np.stack([corners[k] for k in chosen], axis=1) for chosen in ((0, 1, 2), (0, 2, 3))]
    return np.concatenate(crossings)


def _cut_triangles(simplices: Array) -> tuple[Array, Array]:
    """Segments (S, 2, c) in which triangles (n, 3, c) are cut where their first coordinate is 0, and the triangle of each."""
    above, ordered = _by_side(simplices)
    return np.concatenate(_corners_cut_off(above, ordered)), np.concatenate([np.flatnonzero(above == count) for count in (2, 1)])


def _by_side(simplices: Array) -> tuple[Array, Array]:
    """Number (n,) of corners on the upper side, on which 0 lies, and the corners with these last."""
    above = simplices[:, :, 0] >= 0
    order = np.argsort(above, axis=1, kind="stable")
    return above.sum(axis=1), np.take_along_axis(simplices, order[:, :, None], axis=1)


def _corners_cut_off(above: Array, ordered: Array) -> list[Array]:
    """Crossings (m, k, c) of the k edges of a corner that lies alone on its side: on the lower side, then on the upper one."""
    last, cut = ordered.shape[1] - 1, []
    for count, alone in ((last, 0), (1, last)):
        chosen = ordered[above == count]
        cut.append(np.stack([_crossing(chosen[:, alone], chosen[:, k]) for k in range(last + 1) if k != alone], axis=1))
    return cut


def _crossing(first: Array, second: Array) -> Array:
    """Nodal values (n, c) where edges cross the plane."""
    share = first[:, :1] / (first[:, :1] - second[:, :1])
    return (1 - share) * first + share * second


_TRIANGLES, _TETRAHEDRA = _parts(EDGES[2], QUARTERS), _parts(EDGES[3], _EIGHTHS)
