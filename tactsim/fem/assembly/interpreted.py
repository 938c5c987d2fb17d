"""The weak form for materials without a compiled form: their own stress and tangent, called at the points of their elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.assembly.space import TaylorHood, VolumePoints
from tactsim.fem.assembly.symmetric import FULL
from tactsim.interfaces import Material

CHUNK = 512
"""Elements computed at once, so that the tangent of their points takes a few tens of megabytes."""


@dataclass(frozen=True)
class PointState:
    """Deformation and pressure at the points of some elements, and the coefficients of a time step if the material relaxes.

    ``F`` (3, 3, E, Q), ``pressure`` (E, Q) in Pa, ``resistance`` (E,) kappa of `Body` in Pa, ``scale`` (E,) of the isochoric
    stress, ``history_stress`` (6, E, Q) in Pa.
    """

    F: Array
    pressure: Array
    resistance: Array
    scale: Array | None = None
    history_stress: Array | None = None

    def chosen(self, part: slice) -> PointState:
        """That of a part of the elements."""
        always = (self.F[:, :, part], self.pressure[part], self.resistance[part])
        if self.scale is None or self.history_stress is None:
            return PointState(*always)
        return PointState(*always, self.scale[part], self.history_stress[:, part])


class InterpretedPart:
    """The elements (E,) of one material, and their terms of the weak form of `Body`."""

    def __init__(self, material: Material, space: TaylorHood, points: VolumePoints, elements: Array):
        self.material, self.space, self.points, self.elements = material, space, points, elements
        self.compliance = 0.0 if material.bulk_modulus is None else 1 / material.bulk_modulus
        self.unknowns = space.element_unknowns()[elements]

    def add_residual(self, state: PointState, out: Array) -> None:
        """Add internal forces in N and volume constraints in m^3 to ``out`` (size,)."""
        for part in self._parts():
            here, weights, N = state.chosen(part), self._weights(part), self.points.pressure_values
            change, here = self._resisting(here)
            B, stress = self._operator(part), self.stress(here)
            weighted = np.moveaxis(weights * stress.reshape(9, *weights.shape), 0, -1)
            forces = np.einsum("ep,epm->em", weighted.reshape(len(B), -1), B)
            volumes = np.einsum("eq,eq,qv->ev", self._share(here) * weights, change, N)
            out += np.bincount(self.unknowns[part].ravel(), np.hstack([forces, volumes]).ravel(), out.size)

    def add_tangent(self, state: PointState, pattern: Pattern, data: Array) -> None:
        """Add the derivative of the residual to the entries ``data`` (nnz,) of a pattern."""
        for part in self._parts():
            here, weights, N = state.chosen(part), self._weights(part), self.points.pressure_values
            B, (count, points) = self._operator(part), weights.shape
            gradient = self.material.volume_change_gradient(here.F).reshape(9, count, points)
            moduli = self.moduli(self._resisting(here)[1]).reshape(9, 9, count, points)
            resistance, share = here.resistance[:, None], self._share(here)
            moduli = np.moveaxis(weights * (moduli + resistance * gradient[:, None] * gradient), (0, 1), (-2, -1))
            slope, weights = np.moveaxis(share * weights * gradient, 0, -1), share * weights
            across = B.transpose(0, 2, 1)
            K_uu = across @ (moduli @ B.reshape(count, points, 9, -1)).reshape(B.shape)
            K_up = across @ np.einsum("eqi,qv->eqiv", slope, N).reshape(count, 9 * points, -1)
            K_pp = -self.compliance * np.einsum("eq,qv,qx->evx", weights, N, N)
            blocks = np.block([[K_uu, K_up], [K_up.transpose(0, 2, 1), K_pp]])
            places = self._places(part, pattern)
            data += np.bincount(places.ravel(), blocks.ravel(), data.size)

    def stress(self, state: PointState) -> Array:
        """First Piola-Kirchhoff stress (3, 3, E, Q) in Pa, with that of the history."""
        stress = self.material.first_piola_kirchhoff(state.F, state.pressure)
        if state.scale is None or state.history_stress is None:
            return stress
        volumetric = state.pressure * self.material.volume_change_gradient(state.F)
        history_stress = state.history_stress[FULL]
        left = history_stress if self.material.small_strain else np.einsum("iKeq,KJeq->iJeq", state.F, history_stress)
        return (stress - volumetric) * state.scale[:, None] + volumetric + left

    def moduli(self, state: PointState) -> Array:
        """dP/dF at fixed pressure (3, 3, 3, 3, E, Q) in Pa."""
        moduli = self.material.tangent(state.F, state.pressure)
        if state.scale is None or state.history_stress is None:
            return moduli
        volumetric = moduli - self.material.tangent(state.F, 0 * state.pressure)
        moduli = (moduli - volumetric) * state.scale[:, None] + volumetric
        return (
            moduli if self.material.small_strain else moduli + np.einsum("ik,JLeq->iJkLeq", np.eye(3), state.history_stress[FULL])
        )

    def _share(self, state: PointState) -> Array:
        """Of the volume constraint, beside the resistance to what it leaves, (E, 1)."""
        return 1 - state.resistance[:, None] * self.compliance

    def _resisting(self, state: PointState) -> tuple[Array, PointState]:
        """The volume change (E, Q) that the pressure does not ask for, and the state with the pressure that resists it."""
        change = self.material.volume_change(state.F) - self.compliance * state.pressure
        return change, replace(state, pressure=state.pressure + state.resistance[:, None] * change)

    def _parts(self) -> Iterator[slice]:
        return (slice(first, first + CHUNK) for first in range(0, len(self.elements), CHUNK))

    def _weights(self, part: slice) -> Array:
        return self.points.weights[self.elements[part]]

    def _operator(self, part: slice) -> Array:
        """B = dF/du at the points in 1/m, shape (E, 9 Q, displacements of an element)."""
        gradients, hoop = (values[self.elements[part]] for values in (self.points.gradients, self.points.hoop))
        dim = self.space.dim
        B = np.zeros((*hoop.shape[:2], 3, 3, hoop.shape[2], dim))
        for k in range(dim):
            B[:, :, k, :dim, :, k] = np.moveaxis(gradients, -1, -2)
        if dim == 2:
            B[:, :, 2, 2, :, 0] = hoop
        return B.reshape(len(B), 9 * hoop.shape[1], -1)

    def _places(self, part: slice, pattern: Pattern) -> Array:
        """Places (E, n, n) in the entries of the tangent of the blocks of each element."""
        dim, width = self.space.dim, self.space.elements.shape[1]
        corners = self.space.pressures.shape[1]
        block = np.concatenate([np.repeat(np.arange(width), dim), width + np.arange(corners)])
        component = np.concatenate([np.tile(np.arange(dim), width), np.zeros(corners, int)])
        rows = pattern.indptr[self.unknowns[part]]
        offsets = pattern.offsets[self.elements[part]][:, block[:, None], block]
        return rows[:, :, None] + offsets + component
