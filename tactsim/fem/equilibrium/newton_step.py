"""One step of Newton's method, under a prescribed force with that of the rigid displacement."""

from __future__ import annotations

from dataclasses import dataclass

from tactsim.array import Array
from tactsim.fem.equilibrium.prescribed_force import Border


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
