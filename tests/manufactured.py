r"""Manufactured solutions: a smooth deformation and pressure, and the body force and tractions that make them an equilibrium.

.. math:: b = -\mathrm{Div}\, P(F, p), \qquad t = P N

F is the complex-step derivative of the deformation (exact to round-off), Div P the sixth-order central difference of the
exact P: neither uses the solver's weak form (Roache 2002, doi:10.1115/1.1436090).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from solids import facets_where, held, on_plane, solve_near

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import Measure, TaylorHood
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.interfaces import Material
from tactsim.mesh.quadratic import QuadraticMesh

FIELD_ORDER = {2: 8, 3: 5}
"""Degree of the quadrature of loads and errors, well above that of the solver."""


@dataclass(frozen=True)
class Manufactured:
    """An exact solution: ``placement`` x(X) and ``pressure`` p(X) for X of shape (d, n); no pressure means K (J - 1)."""

    measure: Measure
    material: Material
    placement: Callable[[Array], Array]
    given_pressure: Callable[[Array], Array] | None = None

    def deformation_gradient(self, X: Array) -> Array:
        """F (3, 3, n); axisymmetric coordinates are (r, z), the hoop comes last."""
        dim, step = len(X), 1e-30
        F = np.zeros((3, 3, X.shape[1]))
        for j in range(dim):
            F[:dim, j] = self.placement(X + 1j * step * np.eye(dim)[:, j, None]).imag / step
        if dim == 2:
            F[2, 2] = self.placement(X)[0] / X[0] if self.measure == "axisymmetric" else 1.0
        return F

    def pressure(self, X: Array) -> Array:
        """Mean stress in Pa, tension positive, shape (n,)."""
        if self.given_pressure is not None:
            return self.given_pressure(X)
        assert self.material.bulk_modulus is not None
        return self.material.bulk_modulus * self.material.volume_change(self.deformation_gradient(X))

    def stress(self, X: Array) -> Array:
        """First Piola-Kirchhoff stress in Pa, shape (3, 3, n)."""
        return self.material.first_piola_kirchhoff(self.deformation_gradient(X), self.pressure(X))

    def body_force(self, X: Array) -> Array:
        """-Div P in N/m^3, shape (d, n)."""
        dim, step = len(X), 0.0083
        force = np.zeros_like(X)
        for j in range(dim):
            for multiple, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
                shift = multiple * step * np.eye(dim)[:, j, None]
                force -= weight / step * (self.stress(X + shift) - self.stress(X - shift))[:dim, j]
        if self.measure == "axisymmetric":
            P = self.stress(X)
            force[0] -= (P[0, 0] - P[2, 2]) / X[0]
            force[1] -= P[1, 0] / X[0]
        return force


def nodal_forces(exact: Manufactured, body: Body, loaded: Array) -> Array:
    """External nodal forces (size,) in N of the body force and of the tractions on the facets ``loaded``."""
    space, dim = body.space, body.space.dim
    points = space.volume_points(FIELD_ORDER[dim])
    X = np.einsum("qa,ead->deq", points.values, space.nodes[space.elements])
    force = exact.body_force(X.reshape(dim, -1)).reshape(X.shape)
    entries = np.einsum("eq,qa,deq->ead", points.weights, points.values, force)
    unknowns = space.element_unknowns()[:, : entries[0].size]
    surface = space.surface_points(loaded, FIELD_ORDER[dim])
    P = exact.stress(surface.interpolate(space.nodes))[:dim, :dim]
    traction = np.einsum("ijn,jn->in", P, surface.normals)
    return np.bincount(unknowns.ravel(), entries.ravel(), space.size) + SurfaceAssembly(surface, body.pattern, dim).force(
        traction
    )


def measured_errors(
    exact: Manufactured, mesh: QuadraticMesh, is_held: Callable[[Array], Array], *, posed: Manufactured
) -> tuple[float, float, float]:
    """L2 error of u, H1 error of u and L2 error of p against ``exact``, of the solution under the loads of ``posed``.

    Displacements are prescribed on the boundary nodes that ``is_held`` selects, tractions elsewhere; an axis stays on itself.
    """
    space, dim = TaylorHood(mesh.nodes, mesh.elements, exact.measure), mesh.dim
    body = Body(space, [exact.material], mesh.regions)
    on_axis = on_plane(0, 0.0) if exact.measure == "axisymmetric" else lambda nodes: np.zeros(len(nodes), bool)
    loaded = facets_where(mesh, lambda nodes: ~(is_held(nodes) | on_axis(nodes)), every=False)
    fixed = np.unique(np.concatenate([*(held(mesh, axis, is_held) for axis in range(dim)), held(mesh, 0, on_axis)]))
    displacement = exact.placement(mesh.nodes.T).T - mesh.nodes
    solved = solve_near(body, fixed, displacement, nodal_force=nodal_forces(posed, body, loaded), noise=0.0)
    fine = Body(space, [exact.material], mesh.regions)
    fine.points = space.volume_points(FIELD_ORDER[dim])
    weights, values = fine.points.weights, fine.points.values
    X = np.einsum("qa,ead->deq", values, mesh.nodes[mesh.elements]).reshape(dim, -1)
    u = np.einsum("qa,ead->deq", values, space.split(solved.unknowns)[0][mesh.elements]).reshape(dim, -1)
    gradient = fine.kinematics(solved.unknowns).F.reshape(3, 3, -1) - exact.deformation_gradient(X)
    pressure = fine.pressure(solved.unknowns).ravel() - exact.pressure(X)
    squares = ((u - exact.placement(X) + X) ** 2).sum(axis=0), (gradient**2).sum(axis=(0, 1)), pressure**2
    u_L2, u_H1, p_L2 = (float(np.sqrt(weights.ravel() @ square)) for square in squares)
    return u_L2, u_H1, p_L2
