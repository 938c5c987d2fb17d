"""How large a mesh may become: estimated before it is built, so that sizes too small are refused before they fill the memory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import Inclusion
from tactsim.mesh.block import BlockMeshSettings

MOST_UNKNOWNS = 3_000_000
"""Unknowns of the largest model: beyond 600 000, where a factor takes 12 GiB, the iteration takes 8 kB each, so
24 GiB (``fem.solver_choice``)."""
MOST_ALONG = 1000
"""Cells along a side, which are counted before the whole mesh is: with three across the others they are 200 000 unknowns."""
PER_TETRAHEDRON = 4.3
"""Unknowns of a tetrahedron: 1.36 nodes of three displacements, 0.18 corners with a pressure (Euler's formula)."""
PER_CUBE = 10.0
"""Tetrahedra in the cube of their edge length: the default grasp has 9000 (0.1 of the cube each; a regular one has 0.118)."""


def check_unknowns(count: float, keys: str) -> None:
    """Refuse a mesh of so many unknowns, about; ``keys`` are what it follows from.

    Raises
    ------
    InputError
        With the estimate and what is allowed.
    """
    if not count <= MOST_UNKNOWNS:
        raise InputError(f"{keys}: about {count:.2g} unknowns; allowed: up to {MOST_UNKNOWNS:.2g}; take fewer or larger elements")


def check_along(count: float, key: str) -> None:
    """Refuse so many cells along one side.

    Raises
    ------
    InputError
        With the number and what is allowed.
    """
    if not count <= MOST_ALONG:
        raise InputError(f"{key}: {count:.4g} cells along a side or more; allowed: up to {MOST_ALONG}; take a larger size")


def unknowns_of_cells(cells: Sequence[int]) -> int:
    """Unknowns of a grid of cells (3,), each split into six tetrahedra."""
    corners, nodes = np.add(cells, 1, dtype=object), np.multiply(cells, 2, dtype=object) + 1
    return int(3 * nodes.prod() + corners.prod())


def estimated_unknowns(size: Array, inclusions: Sequence[Inclusion], settings: BlockMeshSettings, edge_size: float) -> float:
    r"""Unknowns, about, of a block of size (3,) in m with the edge lengths that settings ask for.

    With the edge length :math:`h_0 + g d` at a distance d, a face of area A has :math:`\int A\,dd / h^3 = A / 2 g h_0^2` cubes of
    the edge length on each side, an edge of length L in a right angle :math:`\pi L / 4 g^2 h_0`, never more than the whole block
    at :math:`h_0`. A body counts with the least area of its volume, that of a ball.
    """
    volume, growth = float(size.prod()), settings.growth
    cubes = volume / settings.size**3
    cubes += min(np.pi * float(size[0] + size[1]) / (growth**2 * edge_size), volume / edge_size**3)
    for inclusion in inclusions:
        fine = inclusion.refine(settings.inclusion_size)
        areas = sum((36 * np.pi) ** (1 / 3) * solid.volume() ** (2 / 3) for solid in inclusion.solids(size))
        cubes += min(areas / (growth * fine**2), volume / fine**3)
    return PER_TETRAHEDRON * PER_CUBE * cubes
