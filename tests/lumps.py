"""Inclusions, surfaces and measurements that the tests of block meshes share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from tactsim.analytic.sphere_points import sphere_points
from tactsim.array import Array
from tactsim.interfaces.solid import Solid
from tactsim.mesh.block import VOLUME_TOLERANCE, BlockMesh
from tactsim.mesh.inclusions.ellipsoid import Ellipsoid
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.mesh.solid import outward

SIZE = (40e-3, 40e-3, 20e-3)
ARTERY = Tube.example()
LUMP = Sphere.example()
TURNED = Ellipsoid(center=(28e-3, 26e-3, 11e-3), semi_axes=(6e-3, 4e-3, 5e-3), rotation=(0.3, 0.2, 0.5))
CURVED = Tube(
    centre_line=((0.0, 8e-3, 10e-3), (15e-3, 15e-3, 9e-3), (28e-3, 26e-3, 11e-3), (40e-3, 30e-3, 10e-3)),
    inner_radius=2e-3,
    wall=0.6e-3,
)


def irregular(count: int = 300) -> tuple[Array, Array]:
    """Vertices in mm and outward triangles of a bumpy closed surface of about 4.5 mm radius."""
    unit = sphere_points(count)
    faces = outward(unit, ConvexHull(unit).simplices, np.zeros(3))
    radius = 4.5 * (1 + 0.15 * np.sin(3 * unit[:, 0]) * np.cos(4 * unit[:, 1]) + 0.1 * np.sin(4 * unit[:, 2] + 1))
    return unit * radius[:, None], faces


def assert_sound(block: BlockMesh) -> None:
    """Volumes within their tolerance, no sliver and no element inside out."""
    assert np.abs(block.volume_errors).max() <= VOLUME_TOLERANCE
    assert block.quality.minimum > 0.02
    assert block.quality.curvature > 0


def write_cells(path: Path, points: Array, **cells: Array) -> Path:
    """A file of cells by meshio's names of their types."""
    import meshio

    meshio.write(path, meshio.Mesh(points, list(cells.items())))
    return path


def enclosed_volume(vertices: Array, triangles: Array) -> float:
    """Volume inside a closed surface by the divergence theorem."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


def points_about(solid: Solid, count: int, margin: float = 0.2) -> tuple[Array, float]:
    """Random points (count, 3) in the box of a solid in the block, a margin of its sides wider, and the volume of that box."""
    lowest, highest = np.clip(solid.bounds(), 0.0, SIZE)
    wider = margin * (highest - lowest)
    lowest, highest = np.maximum(lowest - wider, 0.0), np.minimum(highest + wider, SIZE)
    return np.random.default_rng(1).uniform(lowest, highest, (count, 3)), float(np.prod(highest - lowest))


def sides(mesh: QuadraticMesh) -> tuple[Array, Array]:
    """Triangles (F, 6) of a mesh by node number, ascending, each once, and how many tetrahedra have them."""
    local = ((1, 2, 3, 5, 9, 8), (0, 2, 3, 6, 9, 7), (0, 1, 3, 4, 8, 7), (0, 1, 2, 4, 5, 6))
    every = np.sort(np.concatenate([mesh.elements[:, list(side)] for side in local]), axis=1)
    return np.unique(every, axis=0, return_counts=True)


def interface_nodes(mesh: QuadraticMesh, first: int, second: int) -> Array:
    """Numbers of the nodes that elements of two regions share."""
    nodes = [np.unique(mesh.elements[mesh.regions == region]) for region in (first, second)]
    return np.intersect1d(*nodes)


def same_mirrored(mesh: QuadraticMesh, axis: int) -> bool:
    """Whether the nodes and the centres of the elements of a mesh of a block of `SIZE` are their own mirror image."""
    for points in (mesh.nodes, mesh.nodes[mesh.elements].mean(axis=1)):
        image = points.copy()
        image[:, axis] = SIZE[axis] - image[:, axis]
        places = [np.round(p * 1e9).astype(np.int64) for p in (points, image)]
        if not np.array_equal(*(place[np.lexsort(place.T)] for place in places)):
            return False
    return True


def wedges(corners: Array, simplices: Array, size: Array) -> int:
    """How many edges on the four upper and the four lower edges of a block belong to one tetrahedron only."""
    on_jaw, beside = (
        np.array([np.abs(corners[:, axis] - place) < 1e-12 for axis in axes for place in (0.0, size[axis])])
        for axes in ((2,), (0, 1))
    )
    pairs = np.sort(simplices[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]].reshape(-1, 2), axis=1)
    along = on_jaw[:, pairs].all(axis=2).any(axis=0) & beside[:, pairs].all(axis=2).any(axis=0)
    return int((np.unique(pairs[along], axis=0, return_counts=True)[1] == 1).sum())
