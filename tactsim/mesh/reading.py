"""Meshes of tetrahedra made by other programs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError, UnknownName
from tactsim.mesh.foreign import METRES, ForeignMesh, LengthUnit, read_foreign
from tactsim.mesh.quadratic import EDGES, MIRROR, QuadraticMesh, quadratic_mesh
from tactsim.mesh.quality import jacobian_ratio

TAGS = ("gmsh:physical", "medit:ref", "region", "cell_tags", "gmsh:geometrical")
"""Names under which programs keep the region of a cell, the likeliest first."""
LOWER = frozenset({"vertex", "line", "line3", "triangle", "triangle6"})
"""Cells of boundaries that a file of tetrahedra may hold beside them."""
COINCIDENT = 1e-9
"""Distance of two nodes, over the extent of the mesh, at which they stand in one place."""


def read_mesh(
    path: str | Path,
    region_map: Mapping[int | str, int] | None = None,
    *,
    unit: LengthUnit,
    tag: str | None = None,
) -> QuadraticMesh:
    """A mesh of quadratic tetrahedra from any file that meshio reads; linear ones get straight mid-nodes.

    Parameters
    ----------
    region_map : region number of every tag, a whole number or the name of a group; None puts all into region 0
    unit : of the coordinates in the file
    tag : name of the cell data that holds the tags; by default the first known one that the file has

    Raises
    ------
    StorageError
        If the file cannot be read or is damaged.
    InputError
        If it holds other cells than tetrahedra, a tag is missing or unknown, a coordinate or index cannot be used, or an element
        is flat or inverted and not merely numbered the other way round.
    """
    if unit not in METRES:
        raise UnknownName("unit", str(unit), METRES)
    name, foreign = str(path), read_foreign(path)
    kind, cells = _tetrahedra(foreign, name)
    regions = _regions(foreign, region_map, tag, name, kind)
    points = foreign.points * METRES[unit]
    if points.shape[1] != 3:
        raise InputError(f"{name}: the mesh has {points.shape[1]} coordinates; allowed: 3")
    used = np.unique(cells)
    close = scipy.spatial.cKDTree(points[used]).query_pairs(
        COINCIDENT * float(np.ptp(points[used], axis=0).max()), output_type="ndarray"
    )
    if len(close):
        raise InputError(f"{name}: {len(close)} pairs of nodes coincide, so that its parts may not hang together; merge them")
    mesh = quadratic_mesh(points, cells, regions) if kind == "tetra" else _quadratic(points, cells, regions, name)
    _check_sides(mesh, name)
    return mesh


def _tetrahedra(foreign: ForeignMesh, name: str) -> tuple[str, Array]:
    """The one kind of tetrahedra in a file, and their nodes."""
    kinds = {kind for kind, cells in foreign.cells if len(cells)} - LOWER
    if not kinds:
        raise InputError(f"{name}: holds no tetrahedra")
    if len(kinds) > 1 or not kinds <= {"tetra", "tetra10"}:
        raise InputError(f"{name}: holds {', '.join(sorted(kinds))}; allowed: either tetra or tetra10, nothing else")
    kind = kinds.pop()
    return kind, np.vstack([cells for other, cells in foreign.cells if other == kind])


def _regions(foreign: ForeignMesh, region_map: Mapping[int | str, int] | None, tag: str | None, name: str, kind: str) -> Array:
    """Region number of every tetrahedron."""
    parts = [k for k, (other, _) in enumerate(foreign.cells) if other == kind]
    if region_map is None:
        return np.zeros(sum(len(foreign.cells[k][1]) for k in parts), np.int64)
    chosen = tag or next((known for known in TAGS if known in foreign.tags), None)
    if chosen is None or chosen not in foreign.tags:
        has = ", ".join(sorted(foreign.tags)) or "none"
        raise InputError(f"{name}: the cells carry no {chosen or 'region tag'}; whole-number cell data in the file: {has}")
    tags = np.concatenate([foreign.tags[chosen][k] for k in parts])
    numbers = {}
    for key, region in region_map.items():
        if isinstance(key, str) and key not in foreign.tag_names:
            raise UnknownName(f"group in {name}", key, foreign.tag_names)
        numbers[foreign.tag_names[key] if isinstance(key, str) else int(key)] = int(region)
    present = set(map(int, np.unique(tags)))
    if present != set(numbers):
        missing, idle = sorted(present - set(numbers)), sorted(set(numbers) - present)
        raise InputError(f"{name}: tags without a region: {missing}; regions for tags that no tetrahedron has: {idle}")
    if sorted(set(numbers.values())) != list(range(len(set(numbers.values())))):
        raise InputError(f"{name}: the regions are {sorted(set(numbers.values()))}; allowed: 0, 1, 2, ... without gaps")
    return np.array([numbers[int(value)] for value in tags])


def _quadratic(points: Array, cells: Array, regions: Array, name: str) -> QuadraticMesh:
    """Ten-node tetrahedra, corners numbered first, orientation put right."""
    corners, middles = np.unique(cells[:, :4]), np.unique(cells[:, 4:])
    if np.intersect1d(corners, middles).size:
        raise InputError(f"{name}: a node is the corner of one tetrahedron and the middle of an edge of another")
    number = np.zeros(len(points), np.int64)
    number[np.concatenate([corners, middles])] = np.arange(len(corners) + len(middles))
    elements, nodes = number[cells], points[np.concatenate([corners, middles])]
    sides = nodes[elements[:, 1:4]] - nodes[elements[:, :1]]
    mirrored = np.linalg.det(sides) < 0
    elements[mirrored] = elements[mirrored][:, MIRROR[3]]
    bad = np.flatnonzero(jacobian_ratio(nodes, elements) <= 0)
    if len(bad):
        raise InputError(f"{name}: {len(bad)} tetrahedra are flat or turned inside out by their mid-nodes, the first is {bad[0]}")
    edges = np.concatenate([np.sort(elements[:, list(edge)], axis=1) for edge in EDGES[3]])
    with_middle = np.column_stack([edges, elements[:, 4:].T.ravel()])
    if len(np.unique(edges, axis=0)) != len(np.unique(with_middle, axis=0)):
        raise InputError(f"{name}: neighbouring tetrahedra have different nodes in the middle of a common edge")
    return QuadraticMesh(nodes, elements, regions)


def _check_sides(mesh: QuadraticMesh, name: str) -> None:
    """Refuse tetrahedra that overlap in a common side."""
    sides = np.sort(np.concatenate([np.delete(mesh.elements[:, :4], k, axis=1) for k in range(4)]), axis=1)
    _, counts = np.unique(sides, axis=0, return_counts=True)
    if counts.max() > 2:
        raise InputError(f"{name}: {int((counts > 2).sum())} triangles belong to more than two tetrahedra")
