"""Sections of axisymmetric specimens, graded to the edges of the body that touches them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np
from skfem import MeshTri

from tactsim.errors import InputError
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

Array = np.ndarray
Size = Callable[[Array], Array]
"""Wanted element size in m at points (n, 2)."""


def section_mesh(radius: float, interfaces: Sequence[float], size: Size, *, lines: Sequence[float] = ()) -> QuadraticMesh:
    """Triangles of a cylinder's section, at most as long as ``size`` says, by bisection of a coarse grid.

    Parameters
    ----------
    radius : outer radius in m
    interfaces : heights in m, from the top of the specimen down to its base; a region lies between each two
    size : wanted element size at points in m
    lines : radii in m where element edges must lie
    """
    columns = _filled([0.0, *sorted(line for line in lines if 0 < line < radius), radius])
    levels = _filled(sorted(interfaces), step=np.diff(columns).max())
    mesh = MeshTri.init_tensor(columns, levels)
    for _ in range(60):
        corners = mesh.p.T[mesh.t.T]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        wanted = np.min([size(corners[:, i]) for i in range(3)] + [size(corners.mean(axis=1))], axis=0)
        marked = np.flatnonzero(edges.max(axis=1) > wanted)
        if not len(marked):
            break
        mesh = mesh.refined(marked)
    else:
        raise InputError("the mesh does not reach the wanted element size; is the size positive everywhere?")
    middle = mesh.p[:, mesh.t].mean(axis=1)
    top_down = np.sort(np.asarray(interfaces))[::-1]
    regions = np.clip(np.searchsorted(-top_down, -middle[1]) - 1, 0, len(top_down) - 2)
    return quadratic_mesh(mesh.p.T.copy(), mesh.t.T.astype(np.int64), regions)


def edge_graded(edges: Array, *, finest: float, growth: float, coarsest: float, reach: float = 0.0) -> Size:
    """Size ``finest`` within ``reach`` of the edge points (n, 2), growing by ``growth`` per distance, up to ``coarsest``."""

    def size(points: Array) -> Array:
        distance = np.linalg.norm(points[:, None] - edges[None], axis=2).min(axis=1)
        return np.clip(finest + growth * np.maximum(distance - reach, 0.0), finest, coarsest)

    return size


def _filled(points: Sequence[float], step: float | None = None) -> Array:
    """Add points between the given ones so that neighbouring intervals differ by at most a factor of two or so."""
    given = np.unique(np.asarray(points, float))
    gaps = np.diff(given)
    target = step if step is not None else max(gaps.min() * 4, gaps.max() / 4)
    pieces = [np.linspace(a, b, max(1, round((b - a) / target)) + 1)[:-1] for a, b in itertools.pairwise(given)]
    return np.append(np.concatenate(pieces), given[-1])
