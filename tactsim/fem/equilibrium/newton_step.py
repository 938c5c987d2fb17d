"""One step of Newton's method, under a prescribed force with that of the rigid displacement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.fem.assembly.external_forces import AnyInterface, LinearisedContact
from tactsim.fem.assembly.pattern import Pattern
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.prescribed_force import Border
from tactsim.fem.solvers.linear import LinearSystem


@dataclass(frozen=True)
class NewtonStep:
    """A step of the ``unknowns`` (size,), and of the ``rigid_displacement`` of the interfaces in m under load control."""

    unknowns: Array
    rigid_displacement: float


@dataclass(frozen=True)
class Factored:
    """A factor that the solver holds, and the solution ``along`` the border (size,) with it under load control."""

    along: Array | None


def bordered(step: Array, border: Border | None, along: Array | None) -> NewtonStep:
    """The step (size,) at rest with that of the rigid displacement, if the force is prescribed."""
    if border is None or along is None:
        return NewtonStep(step, 0.0)
    rigid_displacement = border.displacement_step(step, along)
    return NewtonStep(step + rigid_displacement * along, rigid_displacement)


def contact_system(
    pattern: Pattern, constraints: Constraints, data: Array, interfaces: Sequence[AnyInterface], now: Sequence[LinearisedContact]
) -> LinearSystem:
    """The system of a tangent's entries (nnz,), in which constraints are applied in place, and the linearised forces in it."""

    def nearby() -> csr_matrix:
        uncoupled = data.copy()
        for interface, force in zip(interfaces, now, strict=True):
            interface.surface.add_stiffness(uncoupled, -force.coupling)
        return pattern.matrix(constraints.apply(uncoupled))

    def surface() -> Array:
        return np.unique(np.concatenate([interface.surface.unknowns.ravel() for interface in interfaces]))

    return LinearSystem(pattern.matrix(constraints.apply(data)), nearby, surface if interfaces else None)
