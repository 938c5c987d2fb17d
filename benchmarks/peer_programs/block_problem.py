"""One block with a stiffer ball, glued between two plates and squeezed: the problem that every program gets as plain arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.structured_block import structured_block

Array = np.ndarray

SIZE = (40e-3, 40e-3, 20e-3)
RADIUS = 5e-3
STEPS, STEP = 4, 0.5e-3
TOLERANCE = 1e-8
C10, C01, C11 = 1000.0, 685.0, 500.0
"""Tissue in Pa."""
BULK = 100 * 2 * (C10 + C01)
"""Bulk modulus of the tissue in Pa: a hundred times its shear modulus."""
BALL_YOUNG, BALL_POISSON = 18e3, 0.49
SQUARES = 3
"""The top is read on so many squares along each side."""


def block_problem(cells: tuple[int, int, int]) -> dict[str, Array]:
    """Mesh, sets of nodes and materials in SI units, as arrays by name; what a program needs and no more."""
    ball = Sphere(center=tuple(length / 2 for length in SIZE), radius=RADIUS)
    block = structured_block(SIZE, cells, [ball])
    nodes = block.mesh.nodes
    facets = block.facets["upper"]
    return {
        "nodes": nodes,
        "elements": block.mesh.elements,
        "regions": block.mesh.regions,
        "corner_count": np.array(block.mesh.corner_count),
        "bottom": np.flatnonzero(nodes[:, 2] == 0.0),
        "top": np.flatnonzero(nodes[:, 2] == SIZE[2]),
        "top_facets": facets,
        "mooney": np.array([C10, C01, C11]),
        "bulk": np.array([BULK, BALL_YOUNG / (3 * (1 - 2 * BALL_POISSON))]),
        "ball_shear": np.array(BALL_YOUNG / (2 * (1 + BALL_POISSON))),
        "levels": -STEP * np.arange(1, STEPS + 1),
        "tolerance": np.array(TOLERANCE),
    }


def write(path: Path, cells: tuple[int, int, int]) -> dict[str, Array]:
    """The problem, also in an ``.npz`` file."""
    problem = block_problem(cells)
    np.savez(path, **problem)
    return problem


def read(path: Path) -> dict[str, Array]:
    """What an ``.npz`` file holds."""
    with np.load(path) as stored:
        return dict(stored)


def readings(problem: dict[str, Array], forces: Array) -> Array:
    """Force on the top in N, then the mean nominal pressures (9,) in Pa on its squares, compression positive.

    ``forces`` (n, 3) in N are the nodal reactions at the nodes ``top``. They are the virtual work of the traction with the P2
    functions, r_a = integral of t N_a, so the traction in the span of these functions follows from the mass matrix of the top
    and is integrated over each square, whose sides are sides of elements. Nothing but the reactions differs between programs.
    """
    place = np.full(len(problem["nodes"]), -1)
    place[problem["top"]] = np.arange(len(problem["top"]))
    space = TaylorHood(problem["nodes"], problem["elements"], "solid")
    points = space.surface_points(problem["top_facets"])
    numbers, values = place[points.nodes], points.values
    rows, columns = np.repeat(numbers, 6, axis=1), np.tile(numbers, 6)
    entries = (points.weights[:, None, None] * values[:, :, None] * values[:, None, :]).reshape(len(values), -1)
    mass = coo_matrix((entries.ravel(), (rows.ravel(), columns.ravel())), shape=(len(forces),) * 2).tocsc()
    traction = spsolve(mass, -forces[:, 2])
    where = (points.interpolate(problem["nodes"])[:2].T / np.array(SIZE[:2]) * SQUARES).astype(int)
    square = where[:, 0] * SQUARES + where[:, 1]
    total = np.bincount(square, points.weights * np.einsum("na,na->n", values, traction[numbers]), SQUARES**2)
    return np.concatenate([[-forces[:, 2].sum()], total / np.bincount(square, points.weights, SQUARES**2)])
