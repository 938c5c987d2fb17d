"""A problem that is solved for a part of its body, as long as what acts on the body is its own mirror image."""

from __future__ import annotations

from collections.abc import Sequence

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

UNLIKE = 2.0
"""Residual of the whole over what was asked of the part, above which the solution of the part is none of the whole: both are
measured alike, up to round-off."""


class MirroredProblem(Problem):
    """A body without fixed unknowns, solved for a part of it until a solution of the part is none of the whole.

    Every solution is looked at in the whole body; from the first that does not hold there, the whole is solved.

    Parameters
    ----------
    part : of the body
    options : of Newton's method
    """

    def __init__(self, part: MirroredPart, *, options: NewtonOptions):
        super().__init__(part.whole, np.zeros(0, int), solver=solver_for(part.body), options=options)
        self._part: MirroredPart | None = part
        self._on_part = Problem(part.body, part.held, solver=self.solver, options=options)
        self._on_part.constraints = Constraints(part.held, part.body.pattern, counts=part.counts)

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
        if self._part is not None:
            forces = ExternalForces(tuple(interfaces), tuple(loads), nodal_force, load_control)
            solution = self._solved_on(
                self._part, guess, forces, rigid_displacement=rigid_displacement, relaxation=relaxation, coarse=coarse
            )
            if solution is not None:
                return solution
            self.solver.close()
            self._part, self.solver = None, solver_for(self.body)
        return super().solve(
            guess,
            interfaces=interfaces,
            loads=loads,
            nodal_force=nodal_force,
            load_control=load_control,
            rigid_displacement=rigid_displacement,
            relaxation=relaxation,
            coarse=coarse,
        )

    def _solved_on(
        self,
        part: MirroredPart,
        guess: Array,
        forces: ExternalForces,
        *,
        rigid_displacement: float,
        relaxation: RelaxationStep | None,
        coarse: float,
    ) -> Equilibrium | None:
        """The equilibrium of the part, unfolded; None if loads are not mirrored, or the whole is not in equilibrium there."""
        if not part.mirrors(forces.nodal(self.body.space.split(guess)[0], self.body.space.size)):
            return None
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
        if not state.residual <= UNLIKE * max(self.options.tolerance, coarse):
            return None
        return Equilibrium(unknowns, state.kinematics, state.tractions, solution.history, solution.rigid_displacement)
