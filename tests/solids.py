"""Meshes, boundary conditions and measured errors that the tests of the solver share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from skfem import MeshTet, MeshTri

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.dead_load import DeadLoad
from tactsim.fem.assembly.space import Measure, TaylorHood
from tactsim.fem.equilibrium.balance import Equilibrium
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.interfaces import Material
from tactsim.mesh.quadratic import QuadraticMesh, quadratic_mesh


def box(
    lengths: Sequence[float], counts: Sequence[int], *, jitter: float = 0.0, seed: int = 0, refinements: int = 0
) -> QuadraticMesh:
    """Triangles or tetrahedra of a box from the origin.

    ``jitter`` moves nodes by that part of a cell, along the faces; ``refinements`` then halve every element.
    """
    lines = [np.linspace(0.0, length, count + 1) for length, count in zip(lengths, counts, strict=True)]
    mesh = MeshTri.init_tensor(*lines) if len(lines) == 2 else MeshTet.init_tensor(*lines)
    corners, upper = mesh.p.T.copy(), np.asarray(lengths, float)
    shift = np.random.default_rng(seed).uniform(-jitter, jitter, corners.shape) * upper / np.asarray(counts)
    shift[np.isclose(corners, 0.0) | np.isclose(corners, upper)] = 0.0
    mesh = type(mesh)((corners + shift).T.copy(), mesh.t).refined(refinements)
    return quadratic_mesh(mesh.p.T.copy(), mesh.t.T.astype(np.int64))


def body_of(mesh: QuadraticMesh, measure: Measure, *materials: Material, volume_stiffness: float | Array = 0.0) -> Body:
    """A body in the Taylor-Hood space of a mesh, one material per region."""
    return Body(TaylorHood(mesh.nodes, mesh.elements, measure), materials, mesh.regions, volume_stiffness=volume_stiffness)


def facets_where(mesh: QuadraticMesh, inside: Callable[[Array], Array], *, every: bool = True) -> Array:
    """Boundary facets of which every node (n, d), or at least one, satisfies a condition."""
    facets, _ = mesh.boundary_facets()
    satisfied = inside(mesh.nodes)[facets]
    return facets[satisfied.all(axis=1) if every else satisfied.any(axis=1)]


def on_plane(axis: int, value: float) -> Callable[[Array], Array]:
    """The condition of lying where a coordinate has a value."""
    return lambda nodes: np.isclose(nodes[:, axis], value, rtol=0, atol=1e-9 * max(1.0, np.abs(nodes).max()))


def held(mesh: QuadraticMesh, axis: int, inside: Callable[[Array], Array]) -> Array:
    """Numbers of the displacement unknowns along an axis at the nodes that satisfy a condition."""
    return mesh.dim * np.flatnonzero(inside(mesh.nodes)) + axis


def solve_near(
    body: Body, fixed: Array, displacement: Array, *, nodal_force: Array | None = None, noise: float = 0.01
) -> Equilibrium:
    """Equilibrium with the unknowns ``fixed`` at the values of a displacement field (n, d), the branch next to that field.

    Newton starts without pressure, from the field with ``noise`` times the size of the body added to every free unknown.
    """
    disturbance = np.random.default_rng(2).uniform(-noise, noise, displacement.size) * np.ptp(body.space.nodes)
    disturbance[fixed] = 0.0
    guess = np.zeros(body.space.size)
    guess[: displacement.size] = displacement.ravel() + disturbance
    problem = Problem(body, fixed, options=NewtonOptions(polished=0.0))  # a last step that leaves round-off
    solved = problem.solve(guess, loads=[] if nodal_force is None else [DeadLoad(nodal_force)])
    problem.solver.close()
    return solved


def first_piola_kirchhoff(body: Body, solved: Equilibrium) -> Array:
    """Nominal stress at the volume points in Pa, shape (3, 3, E, Q)."""
    F, pressure = solved.kinematics.F, body.pressure(solved.unknowns)
    stress = np.empty_like(F)
    for region, material in enumerate(body.materials):
        mine = body.regions == region
        stress[:, :, mine] = material.first_piola_kirchhoff(F[:, :, mine], pressure[mine])
    return stress


def cauchy_stress(body: Body, solved: Equilibrium) -> Array:
    """P F^T / J at the volume points in Pa, shape (3, 3, E, Q)."""
    return np.einsum("iJeq,kJeq->ikeq", first_piola_kirchhoff(body, solved), solved.kinematics.F) / solved.kinematics.J


def assert_close(actual: Array | float, expected: Array | float, tolerance: float, *, scale: float | None = None) -> None:
    """Fail where values differ by more than ``tolerance`` times ``scale``, by default the largest expected size."""
    size = float(np.abs(expected).max()) if scale is None else scale
    error = float(np.abs(np.asarray(actual) - np.asarray(expected)).max()) / size
    assert error <= tolerance, f"relative error {error:.3e} above {tolerance:.1e}"


def fitted_order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log(error) over log(size) by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
