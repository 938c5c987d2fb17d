"""What a boundary value problem reports beside quantities and history."""

from __future__ import annotations

from typing import Literal

from tactsim.results.scene import Scene, SolverReport


class BoundaryValueScene(Scene):
    """What its figure needs."""

    kind: Literal["boundary_value_problem"] = "boundary_value_problem"
    dimension: Literal["3d", "plane_strain", "axisymmetric"]
    """Of the model."""
    asked: dict[str, str]
    """Unit of each number that is asked for, by its name."""
    solver: SolverReport
    """What the solution took."""
