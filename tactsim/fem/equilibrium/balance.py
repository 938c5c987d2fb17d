"""Balance of forces on a body: how far an iterate of Newton's method is from equilibrium."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.fem.assembly.external_forces import AnyInterface, FollowerLoad
from tactsim.fem.assembly.history_variables import ROUND_OFF
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce


@dataclass(frozen=True)
class ExternalForces:
    """What acts on a body: interfaces, loads, and under load control the force that the interfaces together must exert."""

    interfaces: tuple[AnyInterface, ...] = ()
    loads: tuple[FollowerLoad, ...] = ()
    load_control: PrescribedForce | None = None

    def nodal(self, displacement: Array, size: int) -> Array:
        """Forces (size,) in N of the loads at nodal displacements (n, d)."""
        total = np.zeros(size)
        for load in self.loads:
            total += load.force(displacement)
        return total


@dataclass(frozen=True)
class Scales:
    """What residuals are measured by: mean nodal ``volume`` in m^3, and ``rounding`` (n,) of the internal nodal forces in N
    without deformation."""

    volume: float
    rounding: Array

    @classmethod
    def of(cls, body: Body) -> Scales:
        """Those of a body."""
        volume = body.points.weights.sum() / len(body.space.pressure_corners)
        return cls(volume, ROUND_OFF * np.repeat(rounding_forces(body), body.space.dim))

    def rounding_at(self, F: Array) -> Array:
        """Round-off (n,) of the internal nodal forces in N at a deformation gradient (3, 3, ...): what cancels there, a pressure
        against the stress of the shape, grows like the square of the stretch."""
        return max(1.0, float(F.max()), -float(F.min())) ** 2 * self.rounding


@dataclass(frozen=True)
class NewtonState:
    """Where Newton is: ``unknowns`` (size,), ``internal`` (size,) less external nodal forces in N, displacements (d, n) of each
    interface's points relative to its rigid displacement in m, tractions (d, n) in Pa, the relative ``residual``, and the roots
    of the sums of all squared ``unbalanced`` forces of nodes and of those of the interfaces, in N."""

    unknowns: Array
    kinematics: Kinematics
    rigid_displacement: float
    internal: Array
    displacements: list[Array]
    tractions: tuple[Array, ...]
    residual: float
    unbalanced: float
    contact_force: float


@dataclass(frozen=True)
class Equilibrium:
    """A converged state: ``unknowns`` (size,), the deformation, ``tractions`` (d, n) in Pa at each interface, and the relative
    residuals on the way there."""

    unknowns: Array
    kinematics: Kinematics
    tractions: tuple[Array, ...]
    history: tuple[float, ...]
    rigid_displacement: float = 0.0
    """Displacement in m of the interfaces along a prescribed force."""

    @property
    def iterations(self) -> int:
        """Newton steps with a tangent of their own; those with the last factor are not counted."""
        return len(self.history) - 1


@dataclass(frozen=True)
class Balance:
    """The forces on one body in one solution; residuals are relative to forces, at least to ``rounding / tolerance``."""

    body: Body
    constraints: Constraints
    forces: ExternalForces
    scales: Scales
    tolerance: float

    def at(self, unknowns: Array, kinematics: Kinematics, rigid_displacement: float) -> NewtonState:
        """The state at these unknowns (size,) and this rigid displacement in m of the interfaces.

        Raises
        ------
        ConvergenceError
            If round-off hides a prescribed force.
        """
        interfaces, control = self.forces.interfaces, self.forces.load_control
        internal = self.body.residual(unknowns, kinematics)
        largest = float(np.abs(self.constraints.counted(internal[: self.body.space.displacement_size])).max())
        internal -= self.forces.nodal(self.body.space.split(unknowns)[0], self.body.space.size)
        moved = point_displacements(self.body, unknowns, interfaces, control, rigid_displacement)
        tractions = tuple(interface.converged(d) for interface, d in zip(interfaces, moved, strict=True))
        rounding = [interface.rounding(d) for interface, d in zip(interfaces, moved, strict=True)]
        contact = [interface.surface.force(traction) for interface, traction in zip(interfaces, tractions, strict=True)]
        residual, unbalanced = self._norms(internal, largest, contact, self.scales.rounding_at(kinematics.F), rounding)
        if control is not None:
            surfaces = [interface.surface for interface in interfaces]
            residual = max(residual, control.error(surfaces, tractions, rounding, self.tolerance))
        contact_force = float(np.sqrt(sum(force @ force for force in contact)))
        return NewtonState(
            unknowns, kinematics, rigid_displacement, internal, moved, tractions, residual, unbalanced, contact_force
        )

    def _norms(
        self, internal: Array, largest: float, contact: Sequence[Array], noise: Array, rounding: Sequence[Array]
    ) -> tuple[float, float]:
        """Largest unbalanced force over the largest force (or the node's round-off over the tolerance), or largest volume
        error over the mean nodal volume; and the root of the sum of all squared unbalanced forces in N."""
        residual, split, counted = internal.copy(), self.body.space.displacement_size, self.constraints.counted
        scale = max(largest, float(np.abs(counted(internal[:split])).max()))
        for interface, force, lost in zip(self.forces.interfaces, contact, rounding, strict=True):
            scale = max(scale, float(np.abs(counted(force)).max()))
            residual -= force
            noise = noise + interface.surface.largest_force(lost)[:split]
        residual = counted(self.constraints.free(residual))
        measure = np.maximum(scale, counted(noise) / self.tolerance)  # zero where nothing acts and the force does not count
        unbalanced = np.divide(np.abs(residual[:split]), measure, out=np.zeros(split), where=measure != 0).max()
        relative = float(max(unbalanced, np.abs(residual[split:]).max() / self.scales.volume))
        return relative, float(np.linalg.norm(residual[:split]))


def point_displacements(
    body: Body, unknowns: Array, interfaces: Sequence[AnyInterface], control: PrescribedForce | None, rigid_displacement: float
) -> list[Array]:
    """Displacement (d, n) in m of the points of each interface, relative to its rigid displacement under load control."""
    moved = [interface.surface.points.interpolate(body.space.split(unknowns)[0]) for interface in interfaces]
    if control is None:
        return moved
    return [displacement - rigid_displacement * e[:, None] for displacement, e in zip(moved, control.directions, strict=True)]


def rounding_forces(body: Body) -> Array:
    """Nodal forces (n,) in N that a stress as large as the shear modulus could make without cancellation."""
    points = body.points
    size = np.abs(points.gradients).max(axis=-1) + points.hoop
    forces = np.einsum("e,eq,eqa->ea", body.moduli_at_once, points.weights, size)
    return np.bincount(body.space.elements.ravel(), forces.ravel())
