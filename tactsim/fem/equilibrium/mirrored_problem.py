"""A problem that is solved for a part of its body, as long as what acts on the body is its own mirror image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.fem.assembly.body import RelaxationStep
from tactsim.fem.assembly.external_forces import AnyInterface, FollowerLoad
from tactsim.fem.equilibrium.balance import ExternalForces
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.mirrored_part import MirroredPart
from tactsim.fem.equilibrium.newton import Equilibrium, Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce
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
        self._on_part = Problem(part.body, part.held, solver=solver, options=options)
        self._on_part.constraints = Constraints(part.held, part.body.pattern, counts=part.counts)
        self._in_whole: Problem | None = None

    @property
    def copies(self) -> int:  # type: ignore[override]  # constant elsewhere
        """Of the part; one once the whole is solved."""
        return 1 if self._part is None else self._part.copies

    def solve(
        self,
        guess: Array,
        *,
        interfaces: Sequence[AnyInterface] = (),
        loads: Sequence[FollowerLoad] = (),
        nodal_force: Array | None = None,
        load_control: PrescribedForce | None = None,
        rigid_displacement: float = 0.0,
        relaxation: RelaxationStep | None = None,
        coarse: float = 0.0,
    ) -> Equilibrium:
        """As `Problem.solve`."""
        forces = ExternalForces(tuple(interfaces), tuple(loads), nodal_force, load_control)
        given: dict[str, Any] = {"rigid_displacement": rigid_displacement, "relaxation": relaxation, "coarse": coarse}
        history: tuple[float, ...] = ()
        if self._part is not None and self._part.mirrors(forces.nodal(self.body.space.split(guess)[0], self.body.space.size)):
            solution, residual = self._solved_on(self._part, guess, forces, **given)
            goal = max(self.options.tolerance, coarse)
            if residual <= goal:
                return solution
            if residual <= UNLIKE * goal:
                guess, history = solution.unknowns, solution.history[:-1]
                given["rigid_displacement"] = solution.rigid_displacement
            else:
                self._part = None
        else:
            self._part = None
        solution = self._whole().solve(
            guess, interfaces=interfaces, loads=loads, nodal_force=nodal_force, load_control=load_control, **given
        )
        return replace(solution, history=(*history, *solution.history))

    def _whole(self) -> Problem:
        """The problem of the whole, made when it is first needed."""
        if self._in_whole is None:
            self._in_whole = Problem(self.body, np.zeros(0, int), solver=solver_for(self.body), options=self.options)
        if self._part is None:
            self.solver = self._in_whole.solver
        return self._in_whole

    def _solved_on(
        self,
        part: MirroredPart,
        guess: Array,
        forces: ExternalForces,
        *,
        rigid_displacement: float,
        relaxation: RelaxationStep | None,
        coarse: float,
    ) -> tuple[Equilibrium, float]:
        """The equilibrium of the part, unfolded, and the residual of the whole there."""
        on_part = part.forces(forces)
        solution = self._on_part.solve(
            part.folded(guess),
            interfaces=on_part.interfaces,
            loads=on_part.loads,
            nodal_force=on_part.nodal_force,
            load_control=on_part.load_control,
            rigid_displacement=rigid_displacement,
            relaxation=part.relaxation(relaxation),
            coarse=coarse,
        )
        unknowns = part.unfolded(solution.unknowns)
        state = self.balance(forces, relaxation).at(unknowns, self.body.kinematics(unknowns), solution.rigid_displacement)
        unfolded = Equilibrium(unknowns, state.kinematics, state.tractions, solution.history, solution.rigid_displacement)
        return unfolded, state.residual
