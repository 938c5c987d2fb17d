"""Displacement and stress at a point of the undeformed body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.fem.assembly.history_variables import elastic_stress
from tactsim.fem.assembly.space import quadratic_values
from tactsim.fem.assembly.symmetric import FULL
from tactsim.units import format_quantity

INSIDE = 1e-6
"""How far beyond an element, in parts of it, a point may lie and still count as in it: round-off, and a curved side's sagitta."""
MOST_ITERATIONS = 20
"""Newton's iterations for the place in a curved element."""


def cauchy_stress(body: Body, unknowns: Array, kinematics: Kinematics, isochoric: Array | None = None) -> Array:
    """Cauchy stress (3, 3, E, Q) in Pa at the volume points; on an axisymmetric body the components are r, z and hoop.

    ``isochoric`` (6, E, Q) is the relaxed second Piola-Kirchhoff stress in Pa; by default that of the energy. Either holds the
    resistance of `Body` to the change of volume that its pressure does not ask for: without it the forces of this stress would
    not be those that are in balance. The stress of linear elasticity is per reference area, as that theory has it.
    """
    stress = elastic_stress(body, kinematics, unknowns) if isochoric is None else isochoric
    S, F = stress[FULL], kinematics.F
    linear = body.linear[None, None, :, None]
    spatial = np.where(linear, S, np.einsum("iJeq,JKeq,kKeq->ikeq", F, S, F) / kinematics.J)
    return spatial + np.eye(3)[:, :, None, None] * body.pressure(unknowns)


def von_mises(stress: Array) -> Array:
    """Von Mises's equivalent of a stress (3, 3, ...), the root of 3/2 of its deviator's square, of the trailing shape."""
    mean = np.einsum("ii...->...", stress) / 3
    square = np.einsum("ij...,ij...->...", stress, stress) - 3 * mean**2
    return np.sqrt(np.maximum(1.5 * square, 0.0))


@dataclass(frozen=True)
class BodyPoint:
    """A point of the undeformed body: the elements that hold it, and where it lies in each.

    ``elements`` (k,) numbers, ``local`` (k, d) coordinates of the reference simplex.
    """

    body: Body
    elements: Array
    local: Array

    @classmethod
    def at(cls, body: Body, place: Array) -> BodyPoint:
        """The point at ``place`` (d,) in m.

        Raises
        ------
        InputError
            If it lies outside the body.
        """
        return cls(body, *containing(body.space.nodes, body.space.elements, place))

    def displacement(self, unknowns: Array) -> Array:
        """Displacement (d,) in m."""
        u, _ = self.body.space.split(unknowns)
        values, _ = quadratic_values(self.local[:1].T)
        return np.asarray(values[0] @ u[self.body.space.elements[self.elements[0]]])

    def mean(self, field: Array) -> Array:
        """Values (..., E, Q) at the volume points as they extrapolate to the point, linearly in each element: their mean."""
        return np.asarray(np.einsum("...kq,kq->...", field[..., self.elements, :], self._weights) / len(self.elements))

    @cached_property
    def _weights(self) -> Array:
        """Weights (k, Q) of the volume points in the linear function that fits them best, at the point."""
        values = self.body.points.pressure_values
        there = np.column_stack([1 - self.local.sum(axis=1), self.local])
        return np.asarray(there @ np.linalg.pinv(values))


def containing(nodes: Array, elements: Array, place: Array) -> tuple[Array, Array]:
    """The elements (k,) that hold a place (d,) in m and its coordinates (k, d) in their reference simplex.

    Raises
    ------
    InputError
        If none does.
    """
    corners = nodes[elements]
    low, high = corners.min(axis=1), corners.max(axis=1)
    slack = 1e-3 * (high - low).max(axis=1, keepdims=True)
    near = np.flatnonzero(((place >= low - slack) & (place <= high + slack)).all(axis=1))
    local = _local(corners[near], place)
    within = np.minimum(local.min(axis=1), 1 - local.sum(axis=1)) >= -INSIDE if len(near) else np.zeros(0, bool)
    if not within.any():
        given = ", ".join(format_quantity(value, "m") for value in place)
        raise InputError(f"the point at {given} lies outside the body; take one in it, in undeformed coordinates")
    return near[within], local[within]


def _local(corners: Array, place: Array) -> Array:
    """Coordinates (k, d) in the reference simplex of a place (d,) in elements (k, A, d), by Newton's method."""
    dim = corners.shape[2]
    local = np.full((len(corners), dim), 1.0 / (dim + 1))
    for _ in range(MOST_ITERATIONS):
        values, gradients = quadratic_values(local.T)
        apart = place - np.einsum("ka,kai->ki", values, corners)
        step = np.linalg.solve(np.einsum("kai,kaj->kij", corners, gradients), apart[..., None])[..., 0] if len(corners) else apart
        local = local + step
        if not len(step) or np.abs(step).max() < 1e-13:
            break
    return local
