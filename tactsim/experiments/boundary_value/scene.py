"""What a boundary value problem reports beside quantities and history."""

from __future__ import annotations

from typing import Annotated, Literal

from tactsim.interfaces import RigidBody
from tactsim.model import FrozenModel
from tactsim.registry import Registered
from tactsim.results.scene import Scene, SolverReport


class TouchingBody(FrozenModel):
    """A rigid body, at first touch and where it came to."""

    body: Annotated[RigidBody, Registered(RigidBody)]
    """The body in its own axes."""
    axis: tuple[float, ...]
    """Unit vector from the tissue to the body."""
    place: tuple[float, ...]
    """Its reference point in m."""
    reached: tuple[float, ...] | None = None
    """Its reference point in m in the last accepted state; None in results of before it was kept."""


class BoundaryValueScene(Scene):
    """What its figure needs."""

    kind: Literal["boundary_value_problem"] = "boundary_value_problem"
    dimension: Literal["3d", "plane_strain", "axisymmetric"]
    """Of the model."""
    asked: dict[str, str]
    """Unit of each number that is asked for, by its name."""
    touching: tuple[TouchingBody, ...] = ()
    """The rigid bodies, in the order of the case."""
    solver: SolverReport
    """What the solution took."""
