"""A deformable body: space, materials per region, and its residual and tangent."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType

import numpy as np

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.fem.assembly import kernels, section_kernels
from tactsim.fem.assembly.interpreted import InterpretedPart, PointState
from tactsim.fem.assembly.material_forms import compiled_form
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.threads import loop_threads
from tactsim.interfaces import Material

ELASTIC_STEP = np.empty((6, 0, 0))


@dataclass(frozen=True)
class Kinematics:
    """Deformation at the volume points: ``F`` (3, 3, E, Q), ``J`` and the isochoric invariants ``I1``, ``I2`` (E, Q)."""

    F: Array
    J: Array
    I1: Array
    I2: Array


@dataclass(frozen=True)
class RelaxationStep:
    """The present step of materials that relax: S = scale * S_iso(F) + stress.

    ``scale`` (E,) dimensionless; ``stress`` (6, E, Q), second Piola-Kirchhoff in Pa, components 11, 22, 33, 12, 23, 13.
    """

    scale: Array
    stress: Array


class Body:
    """A body of one or more materials in a Taylor-Hood space.

    The weak form, for all test displacements v and pressures q (Simo, Taylor & Pister 1985, doi:10.1016/0045-7825(85)90033-7,
    in the displacement-pressure form):

    .. math::
        \\int (P_{iso}(F) + p\\, \\partial_F g) : \\nabla v\\, dV = f(v), \\qquad \\int q\\, (g(F) - p / K)\\, dV = 0

    with the stress P = P_iso + p dg/dF and the volume change g of each material. Linear pressures hold g to p / K in the mean
    around each corner only. A body may resist what that leaves, by

    .. math:: \\int \\tfrac12 \\kappa\\, (g(F) - p / K)^2\\, dV, \\qquad \\kappa = \\frac{a G}{1 + a G / K}

    in its potential, with a multiple a of the shear modulus G. That is zero in every exact solution, so that it changes no order
    of convergence (grad-div stabilisation: Franca & Hughes 1988, doi:10.1016/0045-7825(88)90168-5; Olshanskii & Reusken 2004,
    doi:10.1090/S0025-5718-03-01629-6). Where a material relaxes, this resistance relaxes with its isochoric stress: all of a body
    that is held relaxes alike, and no resistance outlasts the tissue's own stiffness. Where a material has no compiled form, its
    own methods are called at the points (``interpreted``), several times slower.

    Parameters
    ----------
    space : TaylorHood
    materials : one per region
    regions : (E,) index into ``materials``
    volume_stiffness : a, for all elements or (E,); with zero, the elements are those of Taylor and Hood

    Attributes
    ----------
    linear : (E,) whether the material is of small strains
    compliance : (E,) of the volume in 1/Pa, zero where the material is incompressible
    shear_moduli : (E,) of the energies in Pa
    moduli_at_once : (E,) shear moduli before anything has relaxed, in Pa

    Raises
    ------
    InputError
        If there is not one region per element, or a region has no material.
    """

    relaxation: RelaxationStep | None = None
    """Coefficients of the present time step, for materials that relax."""

    def __init__(
        self,
        space: TaylorHood,
        materials: Sequence[Material],
        regions: Array,
        *,
        volume_stiffness: float | Array = 0.0,
    ):
        if len(regions) != len(space.elements) or regions.min() < 0 or regions.max() >= len(materials):
            raise InputError(f"regions must give one of {len(materials)} materials for each of {len(space.elements)} elements")
        self.space = space
        self.pattern = Pattern(space)
        self.materials = tuple(materials)
        self.regions = np.asarray(regions)
        self.numbers = np.arange(len(self.regions))
        self.points = space.volume_points()
        self.stabilisation = np.broadcast_to(volume_stiffness, self.regions.shape)
        self.linear = np.array([m.small_strain for m in materials])[self.regions]
        self.forms = tuple(compiled_form(material) for material in materials)
        self.compliance = np.array([0.0 if m.bulk_modulus is None else 1 / m.bulk_modulus for m in materials])[self.regions]
        self.shear_moduli = np.array([m.shear_modulus for m in materials])[self.regions]
        self.moduli_at_once = np.array([_instantaneous_modulus(m) for m in materials])[self.regions]
        most = self.stabilisation * self.moduli_at_once
        self.volume_stiffness = self.stabilisation * self.shear_moduli / (1 + most * self.compliance)

    def with_relaxation(self, relaxation: RelaxationStep | None) -> Body:
        """The same body in a time step of materials that relax."""
        body = copy.copy(self)
        body.relaxation = relaxation
        return body

    def kinematics(self, unknowns: Array) -> Kinematics:
        """Deformation at the quadrature points for unknowns (size,)."""
        u, _ = self.space.split(unknowns)
        shape = self.points.weights.shape
        F, invariants = np.zeros((9, *shape)), np.empty((3, *shape))
        with loop_threads(len(self.regions)):
            self._kernels.deformation(u, self.space.elements, self.points.gradients, self.points.hoop, F, invariants)
        return Kinematics(F.reshape(3, 3, *shape), *invariants)

    def oriented_volume_ratio(self, state: Kinematics) -> Array:
        """J at the points (E, Q), negative wherever matter lies inside out; infinite where a material is of small strains.

        A section that has passed the axis of revolution is inside out, too: hoop stretch and ratio of areas are negative there,
        their product J is not.
        """
        J = state.J if self.space.measure != "axisymmetric" else np.where(state.F[2, 2] > 0, state.J, -np.abs(state.J))
        return np.where(self.linear[:, None], np.inf, J) if self.linear.any() else J

    def pressure(self, unknowns: Array) -> Array:
        """Pressure unknown (tension positive) at the quadrature points in Pa, shape (E, Q)."""
        _, p = self.space.split(unknowns)
        return np.einsum("qv,ev->eq", self.points.pressure_values, p[self.space.pressures])

    def energy_slopes(self, state: Kinematics, *, second: bool) -> Array:
        """W1, W2 and with ``second`` W11, W12, W22 at the points, shape (2 or 5, E, Q); the shear modulus first if linear.

        Scaled as the present step of a relaxing material asks; zero where a material has no compiled form.
        """
        slopes = np.zeros((5 if second else 2, *state.J.shape))
        for index, material in enumerate(self.materials):
            mine = self.regions == index if len(self.materials) > 1 else slice(None)
            if self.forms[index] == "invariants":
                values = material.energy_gradient(state.I1[mine], state.I2[mine])  # type: ignore[attr-defined]
                if second:
                    values = (*values, *material.energy_hessian(state.I1[mine], state.I2[mine]))  # type: ignore[attr-defined]
                for slot, value in zip(slopes, values, strict=True):
                    slot[mine] = value
            elif self.forms[index] == "small_strain":
                slopes[0, mine] = material.shear_modulus
        return slopes if self.relaxation is None else slopes * self.relaxation.scale[:, None]

    def volume_error(self, unknowns: Array, state: Kinematics) -> Array:
        """Volume ratio less the one that the pressure asks for, at the quadrature points (E, Q).

        .. math:: g(F) - p / K

        It is J - 1 for exactly incompressible tissue; compressible tissue may change its volume as its pressure asks.
        """
        change = np.where(self.linear[:, None], np.trace(state.F) - 3, state.J - 1)
        for part in self._interpreted:
            change[part.elements] = part.material.volume_change(state.F[:, :, part.elements])
        return change - self.compliance[:, None] * self.pressure(unknowns)

    def compiled_elastic_stress(self, state: Kinematics, tension: Array) -> Array:
        """Second Piola-Kirchhoff stress (6, E, Q) in Pa, isochoric but for a ``tension`` (E, Q) in Pa, not scaled by a step of
        time; where a material has no compiled form, its entries mean nothing."""
        elastic, stress = self.with_relaxation(None), np.zeros((6, *state.J.shape))
        self._kernels.elastic_stress(state.F, elastic.energy_slopes(state, second=False), tension, self.linear, stress)
        return stress

    @property
    def volume_resistance(self) -> Array:
        """kappa (E,) in Pa, in a step of time as much of it as has not relaxed."""
        return self.volume_stiffness if self.relaxation is None else self.volume_stiffness * self.relaxation.scale

    def residual(self, unknowns: Array, state: Kinematics | None = None) -> Array:
        """Internal forces in N, then the volume constraints in m^3, shape (size,)."""
        state = self.kinematics(unknowns) if state is None else state
        u, p = self.space.split(unknowns)
        out = np.zeros(self.space.size)
        slopes, pattern = self.energy_slopes(state, second=False), self.pattern
        with loop_threads(len(self.regions)):
            history_stress = self._history_stress()
            self._kernels.residual(u, p, self._tables(), slopes, history_stress, pattern.order, pattern.color_starts, out)
        for part in self._interpreted:
            part.add_residual(self._at(part, unknowns, state), out)
        return out

    def tangent(self, unknowns: Array, state: Kinematics | None = None) -> Array:
        """Entries (nnz,) of the tangent at unknowns (size,) in the order of ``pattern``, a new array."""
        state = self.kinematics(unknowns) if state is None else state
        u, p = self.space.split(unknowns)
        pattern = self.pattern
        data = np.zeros(len(pattern.indices))
        slopes = self.energy_slopes(state, second=True)
        with loop_threads(len(self.regions)):
            places = (pattern.order, pattern.color_starts, pattern.indptr, pattern.offsets)
            self._kernels.tangent(u, p, self._tables(), slopes, self._history_stress(), *places, data)
        for part in self._interpreted:
            part.add_tangent(self._at(part, unknowns, state), pattern, data)
        return data

    @property
    def _kernels(self) -> ModuleType:
        """The compiled loops."""
        return kernels if self.space.dim == 3 else section_kernels

    @cached_property
    def _interpreted(self) -> tuple[InterpretedPart, ...]:
        """The regions of materials without a compiled form."""
        uncompiled = [index for index, form in enumerate(self.forms) if form is None]
        chosen = ((self.materials[index], np.flatnonzero(self.regions == index)) for index in uncompiled)
        return tuple(InterpretedPart(material, self.space, self.points, mine) for material, mine in chosen if mine.size)

    def _at(self, part: InterpretedPart, unknowns: Array, state: Kinematics) -> PointState:
        """What a part is computed from."""
        mine, relaxation = part.elements, self.relaxation
        history = (None, None) if relaxation is None else (relaxation.scale[mine], relaxation.stress[:, mine])
        return PointState(state.F[:, :, mine], self.pressure(unknowns)[mine], self.volume_resistance[mine], *history)

    def _history_stress(self) -> Array:
        return ELASTIC_STEP if self.relaxation is None else self.relaxation.stress

    def _tables(self) -> tuple[Array, ...]:
        """What the compiled loops read of the mesh and the materials; elements without a compiled form have no weight there."""
        return (*self._lasting_tables, self.volume_resistance)

    @cached_property
    def _lasting_tables(self) -> tuple[Array, ...]:
        """Those of them that no step of time changes."""
        points = self.points
        compiled_elements = np.array([form is not None for form in self.forms])[self.regions]
        return (
            self.space.elements,
            self.space.pressures,
            points.gradients,
            points.hoop,
            points.weights if compiled_elements.all() else points.weights * compiled_elements[:, None],
            points.pressure_values,
            self.linear | ~compiled_elements,
            self.compliance,
        )


def _instantaneous_modulus(material: Material) -> float:
    """Small-strain shear modulus of a material at once in Pa."""
    if material.relaxation is None:
        return material.shear_modulus
    remaining, relaxing, _ = material.relaxation.amplitudes
    return material.shear_modulus * (remaining + float(relaxing.sum()))
