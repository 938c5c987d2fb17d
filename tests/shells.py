"""Thick shells under internal pressure: solving and measuring what the tube and the sphere share."""

from __future__ import annotations

import numpy as np
from solids import body_of

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.pressure import FollowerPressure
from tactsim.fem.assembly.space import Measure
from tactsim.fem.equilibrium.balance import Equilibrium
from tactsim.fem.equilibrium.newton import Problem
from tactsim.interfaces import Material
from tactsim.mesh.quadratic import QuadraticMesh


def inflated(
    mesh: QuadraticMesh, measure: Measure, material: Material, pressure: float, *, bore: Array, fixed: Array
) -> tuple[Body, Equilibrium]:
    """Equilibrium under a follower pressure on the facets ``bore``, raised in steps of a quarter of the shear modulus."""
    body = body_of(mesh, measure, material)
    load = FollowerPressure(body.space, bore, body.pattern, 0.0)
    problem, unknowns = Problem(body, fixed), np.zeros(body.space.size)
    steps = int(np.ceil(pressure / (0.25 * material.shear_modulus)))
    for step in range(1, steps + 1):
        load.pressure = pressure * step / steps
        solved = problem.solve(unknowns, loads=[load])
        unknowns = solved.unknowns
    problem.solver.close()
    return body, solved


def radial_displacement(body: Body, solved: Equilibrium, radius: float, *, axes: int) -> Array:
    """Change of distance from the centre, over the first ``axes`` coordinates, of every node at a reference radius."""
    nodes, (u, _) = body.space.nodes[:, :axes], body.space.split(solved.unknowns)
    here = np.isclose(np.linalg.norm(nodes, axis=1), radius)
    return np.linalg.norm((nodes + u[:, :axes])[here], axis=1) - radius


def radial_stress(body: Body, stress: Array, unknowns: Array, *, axes: int) -> tuple[Array, Array]:
    """Reference radius and Cauchy stress along the current radius at every volume point, each (E, Q)."""
    values, elements = body.points.values, body.space.elements
    X = np.einsum("qa,eai->ieq", values, body.space.nodes[elements])[:axes]
    x = X + np.einsum("qa,eai->ieq", values, body.space.split(unknowns)[0][elements])[:axes]
    n = x / np.linalg.norm(x, axis=0)
    return np.linalg.norm(X, axis=0), np.einsum("ieq,ijeq,jeq->eq", n, stress[:axes, :axes], n)
