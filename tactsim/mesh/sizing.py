"""Wanted edge lengths in a block with inclusions, as a field that the mesher follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.interfaces import Inclusion
from tactsim.mesh.block import BlockMeshSettings

EDGE_SHARE = 2 / 3
"""Element size at the edges of the jaws over that far away, where none is given."""
MOST_CELLS = 60
"""Cells of the background grid along the longest side."""
MARGIN = 0.25
"""How far the background grid goes beyond the surfaces, in their extent: the mesher works in a larger box."""


def edge_lengths(points: Array, size: Array, inclusions: Sequence[Inclusion], settings: BlockMeshSettings) -> Array:
    """Wanted edge length (n,) in m at points (n, 3)."""
    wanted = np.full(len(points), settings.size)
    wanted = np.minimum(wanted, at_jaw_edges(settings) + settings.growth * jaw_edge_distance(points, size, settings.jaw))
    for inclusion in inclusions:
        at_surface = inclusion.refine(settings.inclusion_size)
        for solid in inclusion.solids(size):
            distance = np.abs(solid.signed_distance(points))
            wanted = np.minimum(wanted, at_surface + settings.growth * distance)
    return wanted


def at_jaw_edges(settings: BlockMeshSettings) -> float:
    """Wanted edge length in m at the edges of the jaws."""
    return min(settings.edge_size or EDGE_SHARE * settings.size, settings.size)


def jaw_edge_distance(points: Array, size: Array, jaw: tuple[float, float] | None) -> Array:
    """Distance (n,) in m of points (n, 3) from the edges of two jaws centred on the block; None means jaws that cover it."""
    extent = size[:2] if jaw is None else np.minimum(np.array(jaw), size[:2])
    across = np.abs(points[:, :2] - size[:2] / 2) - extent / 2
    outside = np.linalg.norm(np.maximum(across, 0.0), axis=1)
    in_plane = np.where((across <= 0).all(axis=1), -across.max(axis=1), outside)
    height = np.minimum(np.abs(points[:, 2]), np.abs(size[2] - points[:, 2]))
    return np.hypot(in_plane, height)


def background(
    bounds: Array, size: Array, inclusions: Sequence[Inclusion], settings: BlockMeshSettings
) -> tuple[Array, Array, Array]:
    """Points (n, 3), tetrahedra (m, 4) and wanted edge lengths (n,) in m around surfaces with bounds (2, 3)."""
    extent = np.ptp(bounds, axis=0)
    low, high = bounds[0] - MARGIN * extent.max(), bounds[1] + MARGIN * extent.max()
    step = max(settings.inclusion_size, float((high - low).max()) / MOST_CELLS)
    lines = [np.linspace(a, b, max(2, round((b - a) / step) + 1)) for a, b in zip(low, high, strict=True)]
    from skfem import MeshTet

    grid = MeshTet.init_tensor(*lines)
    points = grid.p.T.copy()
    wanted = edge_lengths(points, size, inclusions, settings)
    beyond = np.linalg.norm(np.maximum(np.maximum(-points, points - size), 0.0), axis=1)
    wanted = np.where(beyond > settings.inclusion_size, np.maximum(wanted, settings.size), wanted)
    return points, grid.t.T.astype(np.int32).copy(), wanted
