"""What a solution took, from its problem and its accepted steps."""

from __future__ import annotations

from collections.abc import Sequence

from tactsim.fem.newton import Problem
from tactsim.results.result import StepRecord
from tactsim.results.scene import SolverReport


def solver_report(
    problem: Problem, steps: Sequence[StepRecord], *, rejected_steps: int, mesh_adaptations: int = 0
) -> SolverReport:
    """Sizes of the model, and the Newton iterations of all accepted steps."""
    space = problem.body.space
    return SolverReport(
        unknowns=space.size,
        elements=len(space.elements),
        linear_solver=problem.solver.name,
        rejected_steps=rejected_steps,
        newton_iterations=sum(step.newton_iterations for step in steps),
        mesh_adaptations=mesh_adaptations,
    )
