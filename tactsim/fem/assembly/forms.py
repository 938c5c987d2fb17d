r"""The weak form in a few lines of numpy: what the compiled loops of ``kernels`` compute, to be read and to be checked against.

For all test displacements v and pressures q (Simo, Taylor & Pister 1985, doi:10.1016/0045-7825(85)90033-7, in the
displacement-pressure form), with :math:`P(F, p)` and the volume change :math:`g(F)` of the material:

.. math::
    \int P(F, p + \kappa c) : \nabla v\, dV = f(v), \qquad \int q\, (1 - \kappa / K)\, c\, dV = 0,
    \qquad c = g(F) - p / K

with the resistance :math:`\kappa` of `Body` to a change of volume that the pressure does not ask for. The deformation gradient
is linear in the unknowns, :math:`F = 1 + B u`; on an axisymmetric body its hoop component is :math:`1 + u_R / R` and
:math:`dV = 2 \pi R\, dR\, dZ`. Linearised at fixed p and at fixed F:

.. math::
    K_{uu} = \int B^T \left( \frac{\partial P}{\partial F}
    + \kappa \frac{\partial g}{\partial F} \frac{\partial g}{\partial F} \right) B\, dV, \quad
    K_{up} = \int (1 - \kappa / K)\, B^T \frac{\partial g}{\partial F} N\, dV, \quad
    K_{pp} = -\int \frac{1 - \kappa / K}{K} N^T N\, dV
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.symmetric import FULL


def residual(body: Body, unknowns: Array) -> Array:
    """Internal forces in N, then the volume constraints in m^3, shape (size,)."""
    B, F = strain_operator(body), deformation_gradient(body, unknowns)
    weights, N = body.points.weights, body.points.pressure_values
    excess, p = _resisting(body, F, unknowns)
    stress = _at_points(body, (3, 3), lambda material, mine: material.first_piola_kirchhoff(F[:, :, mine], p[mine]))
    if body.relaxation is not None:
        stress = _relaxed(body, stress, _at_points(body, (3, 3), _pressure_stress(F, p))) + _history_term(body, F)
    forces = np.einsum("eq,iJeq,iJeqak->eak", weights, stress, B, optimize=True)
    volumes = np.einsum("e,eq,eq,qv->ev", _share(body), weights, excess, N)
    entries = np.hstack([forces.reshape(len(forces), -1), volumes])
    return np.bincount(body.space.element_unknowns().ravel(), entries.ravel(), body.space.size)


def tangent(body: Body, unknowns: Array) -> csr_matrix:
    """Derivative of the residual, (size, size): N/m, N/Pa and m^3/Pa by block."""
    B, F = strain_operator(body), deformation_gradient(body, unknowns)
    weights, N = body.points.weights, body.points.pressure_values
    _, p = _resisting(body, F, unknowns)
    moduli = _at_points(body, (3, 3, 3, 3), lambda material, mine: material.tangent(F[:, :, mine], p[mine]))
    if body.relaxation is not None:
        without = lambda material, mine: material.tangent(F[:, :, mine], 0 * p[mine])  # noqa: E731
        moduli = _relaxed(body, moduli, moduli - _at_points(body, (3, 3, 3, 3), without)) + _history_tangent(body)
    slope = _at_points(body, (3, 3), lambda material, mine: material.volume_change_gradient(F[:, :, mine]))
    moduli = moduli + body.volume_resistance[:, None] * np.einsum("iJeq,kLeq->iJkLeq", slope, slope)
    B = B.reshape(*B.shape[:4], -1)
    K_uu = np.einsum("eq,iJeqm,iJkLeq,kLeqn->emn", weights, B, moduli, B, optimize=True)
    K_up = np.einsum("e,eq,iJeqm,iJeq,qv->emv", _share(body), weights, B, slope, N, optimize=True)
    K_pp = -np.einsum("eq,e,qv,qx->evx", weights, _share(body) * body.compliance, N, N, optimize=True)
    blocks = np.block([[K_uu, K_up], [K_up.transpose(0, 2, 1), K_pp]])
    unknown = body.space.element_unknowns()
    rows = np.repeat(unknown[:, :, None], unknown.shape[1], axis=2)
    return csr_matrix((blocks.ravel(), (rows.ravel(), rows.transpose(0, 2, 1).ravel())), shape=(body.space.size,) * 2)


def strain_operator(body: Body) -> Array:
    """B = dF/du at the volume points in 1/m, shape (3, 3, E, Q, A, d)."""
    dim, gradients, hoop = body.space.dim, body.points.gradients, body.points.hoop
    B = np.zeros((3, 3, *hoop.shape, dim))
    for k in range(dim):
        B[k, :dim, ..., k] = np.moveaxis(gradients, -1, 0)
    if dim == 2:
        B[2, 2, ..., 0] = hoop
    return B


def deformation_gradient(body: Body, unknowns: Array) -> Array:
    """F = 1 + B u at the volume points, shape (3, 3, E, Q)."""
    u, _ = body.space.split(unknowns)
    change = np.einsum("iJeqak,eak->iJeq", strain_operator(body), u[body.space.elements])
    return np.eye(3)[:, :, None, None] + change


def _resisting(body: Body, F: Array, unknowns: Array) -> tuple[Array, Array]:
    """The volume change that the pressure does not ask for, and the pressure in Pa with the resistance to it, both (E, Q)."""
    p = body.pressure(unknowns)
    change = _at_points(body, (), lambda material, mine: material.volume_change(F[:, :, mine]))
    excess = change - p * body.compliance[:, None]
    return excess, p + body.volume_resistance[:, None] * excess


def _share(body: Body) -> Array:
    """Part (E,) of the volume constraint that is left to the pressure."""
    return 1 - body.volume_resistance * body.compliance


def _relaxed(body: Body, whole: Array, pressure_part: Array) -> Array:
    """The isochoric part scaled as the step of time asks, the pressure's part as it is."""
    return (whole - pressure_part) * body.relaxation.scale[:, None] + pressure_part  # type: ignore[union-attr]


def _pressure_stress(F: Array, p: Array) -> Callable[..., Array]:
    return lambda material, mine: p[mine] * material.volume_change_gradient(F[:, :, mine])


def _history_tensor(body: Body) -> Array:
    """The stress of the history as a full symmetric tensor (3, 3, E, Q)."""
    return body.relaxation.stress[FULL]  # type: ignore[union-attr]


def _history_term(body: Body, F: Array) -> Array:
    """First Piola-Kirchhoff stress of the history: F H, or H where the material is linear."""
    H = _history_tensor(body)
    return np.where(body.linear[:, None], H, np.einsum("iKeq,KJeq->iJeq", F, H))


def _history_tangent(body: Body) -> Array:
    """Its derivative delta_ik H_JL, zero where the material is linear."""
    moduli = np.einsum("ik,JLeq->iJkLeq", np.eye(3), _history_tensor(body))
    return np.where(body.linear[:, None], 0.0, moduli)


def _at_points(body: Body, shape: tuple[int, ...], law: Callable[..., Array]) -> Array:
    """A law of (material, its elements) evaluated at every volume point, shape (*shape, E, Q)."""
    values = np.empty((*shape, *body.points.weights.shape))
    for index, material in enumerate(body.materials):
        mine = body.regions == index
        values[..., mine, :] = law(material, mine)
    return values
