"""A problem that is solved for a part of its body, as long as what acts on the body is its own mirror image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium.balance import Balance, Equilibrium
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.mirrored_part import MirroredPart
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.solvers.solver_choice import solver_for

UNLIKE = 10.0
"""Residual of the whole over what was asked of the part, above which the state is no mirror image; below, what is left is the
round-off of the other parts."""


class MirroredProblem(Problem):
    """A body without fixed unknowns, solved for a part of it until a solution of the part is none of the whole.

    Every solution is looked at in the whole body. One that misses what was asked by round-off is finished there; from the first
    that is no mirror image on, the whole is solved.

    Parameters
    ----------
    part : of the body
    options : of Newton's method
    """

    def __init__(self, part: MirroredPart, *, options: NewtonOptions):
        solver = solver_for(part.body)
        super().__init__(part.whole, np.zeros(0, int), solver=solver, options=options)
        self._part: MirroredPart | None = part
        held = Constraints(part.held, part.body.pattern, counts=part.counts)
        self._on_part = Problem(part.body, held, solver=solver, options=options)
        self._in_whole: Problem | None = None

    @property
    def copies(self) -> int:  # type: ignore[override]  # constant elsewhere
        """Of the part; one once the whole is solved."""
        return 1 if self._part is None else self._part.copies

    def reached(self, balance: Balance, guess: Array, rigid_displacement: float, goal: float) -> Equilibrium:
        """As `Problem.reached`, from a ``guess`` (size,)."""
        u, _ = self.body.space.split(guess)
        if self._part is not None and not self._part.mirrors(balance.forces.nodal(u, self.body.space.size)):
            self._whole_from_now_on()
        if self._part is None:
            return self._whole.reached(balance, guess, rigid_displacement, goal)
        solution, residual = self._on(self._part, balance, guess, rigid_displacement, goal)
        if residual <= goal:
            return solution
        if not residual <= UNLIKE * goal:
            self._whole_from_now_on()
            return self._whole.reached(balance, guess, rigid_displacement, goal)
        finished = self._whole.reached(balance, solution.unknowns, solution.rigid_displacement, goal)
        return replace(finished, history=(*solution.history[:-1], *finished.history))

    def _on(
        self, part: MirroredPart, balance: Balance, guess: Array, rigid_displacement: float, goal: float
    ) -> tuple[Equilibrium, float]:
        """The equilibrium of the part, unfolded, and the residual of the whole there."""
        on_part = self._on_part.balance(part.forces(balance.forces), part.relaxation(balance.body.relaxation))
        solution = self._on_part.reached(on_part, part.folded(guess), rigid_displacement, goal)
        unknowns = part.unfolded(solution.unknowns)
        state = balance.at(unknowns, self.body.kinematics(unknowns), solution.rigid_displacement)
        return replace(solution, unknowns=unknowns, kinematics=state.kinematics, tractions=state.tractions), state.residual

    def _whole_from_now_on(self) -> None:
        """Give the part up, and its factor."""
        self.solver.close()
        self._part, self.solver = None, self._whole.solver

    @property
    def _whole(self) -> Problem:
        """The problem of the whole, made when it is first needed."""
        if self._in_whole is None:
            self._in_whole = free_problem(self.body, self.options)
        return self._in_whole


def free_problem(body: Body, options: NewtonOptions) -> Problem:
    """A body in 3D without fixed unknowns, by the solver that suits it."""
    return Problem(body, np.zeros(0, int), solver=solver_for(body), options=options)
