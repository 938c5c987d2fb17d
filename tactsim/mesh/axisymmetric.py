"""Sections of axisymmetric specimens, graded to the edges of the body that touches them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh

Size = Callable[[Array], Array]
"""Wanted element size in m at points (n, 2)."""
SLENDER = 4.0
"""Largest ratio of width to height of a grid cell in the thinnest layer, before refinement."""
MOST_BISECTIONS = 80
MOST_ELEMENTS = 500_000
LARGEST_AREA = 3**0.5 / 4
"""Of a triangle over the square of its longest edge."""
SURELY = 4.0
"""Elements that coarse triangles seem to need over the most, from which on they are too many: what is wanted between the places
looked at is not known."""
QUARTERS = ((0, 3, 5), (1, 4, 3), (2, 5, 4), (3, 4, 5))
"""Triangles of the corners and, from 3 on, of the middles of the edges of one."""
ALIKE = 1e-4
"""Part by which sizes differ at most that are taken for one."""


def section_mesh(
    radius: float, interfaces: Sequence[float], size: Size, *, rings: Sequence[float] = (), keys: str = "element size"
) -> QuadraticMesh:
    """Triangles of a cylinder's section, at most as long as ``size`` says, by bisection of a coarse grid.

    Parameters
    ----------
    radius : outer radius in m
    interfaces : heights in m of the top, of each boundary between layers and of the base; a region lies between each two
    size : wanted element size at points in m
    rings : radii in m of circles on the top that must be nodes: the refined mesh is shifted by less than an element for them
    keys : what messages call that which the wanted size follows from

    Raises
    ------
    InputError
        If the mesh would have too many elements, or the wanted size is not positive somewhere.
    """
    heights = np.unique(np.asarray(interfaces, float))
    step = min(radius, max(np.diff(heights).min() * SLENDER, np.ptp(heights) / 2))
    cells = radius / step * (float(np.ptp(heights)) / step + len(heights))
    if cells > MOST_ELEMENTS:
        raise InputError(
            f"a radius of {radius:.3g} m over a thickness of {np.ptp(heights):.3g} m needs {cells:.2g} elements; "
            f"allowed: up to {MOST_ELEMENTS}; take a thicker or a narrower specimen"
        )
    columns = np.linspace(0.0, radius, max(2, round(radius / step)) + 1)
    levels = [np.linspace(a, b, max(1, round((b - a) / step)) + 1)[:-1] for a, b in itertools.pairwise(heights)]
    from skfem import MeshTri

    mesh = MeshTri.init_tensor(columns, np.append(np.concatenate(levels), heights[-1]))
    for _ in range(MOST_BISECTIONS):
        corners = mesh.p.T[mesh.t.T]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        sizes = np.array([*(size(corners[:, i]) for i in range(3)), size(corners.mean(axis=1))])
        wanted = sizes.min(axis=0)
        if not (wanted > 0).all():
            raise InputError("the wanted element size is not positive everywhere")
        marked = np.flatnonzero(edges.max(axis=1) > wanted)
        if not len(marked):
            break
        if mesh.nelements > MOST_ELEMENTS or _needed(corners, sizes[:3].T, size) > SURELY * MOST_ELEMENTS:
            raise InputError(f"{keys}: more than {MOST_ELEMENTS} elements; allowed: up to that; take larger ones")
        mesh = mesh.refined(marked)
    else:
        raise InputError("the mesh does not reach the wanted element size")
    middle = mesh.p[1, mesh.t].mean(axis=0)
    regions = len(heights) - 1 - np.searchsorted(heights, middle)
    return quadratic_mesh(_with_rings(mesh.p.T, rings), mesh.t.T.astype(np.int64), regions)


def _needed(corners: Array, at_corners: Array, size: Size) -> float:
    """Elements that triangles (n, 3, 2) need if the wanted size, (n, 3) at corners, is linear from there to middles of edges."""
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    wanted = np.column_stack([at_corners, *(size(middles[:, i]) for i in range(3))])
    return float((_areas(corners) / 4 * _inverse_square(wanted[:, QUARTERS]).sum(axis=1)).sum() / LARGEST_AREA)


def _inverse_square(sizes: Array) -> Array:
    """Mean of 1/s^2 over triangles (...) on which s is linear, with these values at the corners (..., 3).

    Twice the second divided difference of -ln s (Hermite-Genocchi formula: de Boor 2005, Surveys in Approximation Theory 1, 46).
    """
    a, b, c = np.moveaxis(np.sort(sizes, axis=-1), -1, 0)
    alike = c - a < ALIKE * c
    apart = np.where(alike, 1.0, c - a)
    return np.where(alike, ((a + b + c) / 3) ** -2.0, 2 * (_slope_of_log(a, b) - _slope_of_log(b, c)) / apart)


def _slope_of_log(a: Array, b: Array) -> Array:
    """(ln b - ln a) / (b - a), of a <= b."""
    apart = np.where(b > a, b - a, 1.0)
    return np.where(b > a, np.log1p(apart / a) / apart, 1 / a)


def _areas(corners: Array) -> Array:
    """Areas (n,) in m^2 of triangles (n, 3, 2)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2


def _with_rings(points: Array, rings: Sequence[float]) -> Array:
    """Points (n, 2) stretched piecewise along r so that the nearest top node of each ring comes to lie on it."""
    top = np.sort(points[points[:, 1] == points[:, 1].max(), 0])
    near = [float(top[np.abs(top - ring).argmin()]) for ring in rings]
    if len({0.0, *near, float(top[-1])}) < len(rings) + 2:
        raise InputError("the mesh is too coarse for the edges of the body; take smaller elements")
    out = points.copy()
    out[:, 0] = np.interp(points[:, 0], [0.0, *near, top[-1]], [0.0, *rings, top[-1]])
    return out


def edge_graded(edges: Array, *, finest: float, growth: float, coarsest: float, reach: float = 0.0) -> Size:
    """Size ``finest`` in m within ``reach`` of the edge points (n, 2), growing by ``growth`` per distance, up to ``coarsest``."""

    def size(points: Array) -> Array:
        distance = np.linalg.norm(points[:, None] - edges[None], axis=2).min(axis=1)
        return np.clip(finest + growth * np.maximum(distance - reach, 0.0), finest, coarsest)

    return size


def finer_at_surface(usual: Size, *, radii: Array, finest: float, growth: float, reach: float) -> Size:
    """The usual size, but ``finest`` in m on the surface z = 0 within ``reach`` in m of radii (n,), growing by ``growth`` per
    distance."""

    def size(points: Array) -> Array:
        along = np.abs(points[:, :1] - radii).min(axis=1) - reach
        away = np.hypot(np.maximum(along, 0.0), np.maximum(-points[:, 1], 0.0))
        fine: Array = np.minimum(usual(points), finest + growth * away)
        return fine

    return size


def graded_to_peak(usual: Size, *, finest: float, growth: float) -> Size:
    """The usual size, but ``finest`` in m where the axis meets the surface z = 0, growing by ``growth`` per distance."""

    def size(points: Array) -> Array:
        fine: Array = np.minimum(usual(points), finest + growth * np.linalg.norm(points, axis=1))
        return fine

    return size
