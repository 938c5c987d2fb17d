"""Newton's method for the equilibrium of a body under loads and contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np

from tactsim.array import Array
from tactsim.deadline import check_time
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body, Kinematics, RelaxationStep
from tactsim.fem.assembly.external_forces import AnyInterface, FollowerLoad, LinearisedContact
from tactsim.fem.equilibrium.balance import Balance, Equilibrium, ExternalForces, NewtonState, Scales, point_displacements
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.diagnosis import inside_out_in_words, not_finite_in_words
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.equilibrium.newton_step import Factored, NewtonStep, bordered, contact_system
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce
from tactsim.fem.solvers.linear import LinearSolver, finest_step, is_exact, resolved, solved
from tactsim.fem.solvers.solver_choice import stiff_contact_solver
from tactsim.fem.threads import one_vector_thread

CYCLE_AFTER = 6
CYCLE_RATIO = 0.9
"""A residual above this part of the smallest of the four before it, from iteration ``CYCLE_AFTER`` on, is part of a cycle."""
LARGEST_GROWTH, DISTORTED = 4.0, 0.75
"""A step that multiplies the unbalanced forces by more, and leaves less than this part of the smallest J or more than its inverse
of the largest, has gone astray and is halved. Forces alone do not say so: where points of a contact change their state, they may
grow a hundredfold on the way to it."""
NEAR = 0.1
"""Residual of a guess, and its unbalanced forces over those of the contact, below which Newton starts from the contact forces
that hold there, not from those of the last step; and residual below which a step that goes astray is no reason to mistrust those
that follow.

Why both: a residual is over the largest force of a node, which grows with the cells. Where those at the base are ten times those
at the contact, a body that goes back by more than its penetration leaves all points open at a residual of 0.07. Newton then took
the whole contact off the tissue: a ball in a sine wave took 989 linear systems, now 269."""
CONTRACTION = 0.3
"""A step with an old factor that leaves more than this part of the residual is dropped."""
MOST_FURTHER = 5.0
"""A new tangent and factor cost as much as so many steps with an old one, in sections of 8 000 and of 32 000 unknowns: where
the last contraction promises more of them, a new one is made."""


class Problem:
    """A body with ``fixed`` unknowns, by their numbers (k,) or as constraints; keeps the sparse solver between solutions."""

    copies = 1
    """How many parts like the one that is solved make up the body."""

    def __init__(
        self, body: Body, fixed: Array | Constraints, *, solver: LinearSolver | None = None, options: NewtonOptions | None = None
    ):
        self.body = body
        self.constraints = fixed if isinstance(fixed, Constraints) else Constraints(fixed, body.pattern)
        self.solver = solver or stiff_contact_solver(body.space.dim)
        self.options = options or NewtonOptions()
        self._scales = Scales.of(body)
        self._factored: Factored | None = None

    @one_vector_thread()
    def solve(
        self,
        guess: Array,
        *,
        interfaces: Sequence[AnyInterface] = (),
        loads: Sequence[FollowerLoad] = (),
        load_control: PrescribedForce | None = None,
        rigid_displacement: float = 0.0,
        relaxation: RelaxationStep | None = None,
        coarse: float = 0.0,
    ) -> Equilibrium:
        """Equilibrium nearest to the guess, which holds the prescribed values.

        Parameters
        ----------
        guess : (size,) unknowns
        interfaces, loads : what acts on the body
        load_control : the force that the interfaces must exert, if it is prescribed instead of their displacement
        rigid_displacement : first guess of their displacement in m under load control
        relaxation : coefficients of the time step of materials that relax
        coarse : a residual that suffices, if it is above the tolerance of the options

        Raises
        ------
        ConvergenceError
            If Newton does not converge or an element would turn inside out; the history is in the error.
        OutOfTime
            If the time allowed has passed.
        """
        balance = self.balance(ExternalForces(tuple(interfaces), tuple(loads), load_control), relaxation)
        return self.reached(balance, guess, rigid_displacement, max(self.options.tolerance, coarse))

    def reached(self, balance: Balance, guess: Array, rigid_displacement: float, goal: float) -> Equilibrium:
        """The equilibrium that `solve` returns from a ``guess`` (size,), to a residual of ``goal``; raises as that does."""
        solution = _Solution(balance, self.solver, self.options, goal, self._factored)
        try:
            return solution.run(guess.copy(), rigid_displacement)
        finally:
            self._factored = solution.factored

    def balance(self, forces: ExternalForces, relaxation: RelaxationStep | None = None) -> Balance:
        """What measures how far a state under these forces is from equilibrium; ``relaxation`` as in `solve`."""
        body = self.body if relaxation is None else self.body.with_relaxation(relaxation)
        return Balance(body, self.constraints, forces, self._scales, self.options.tolerance)


class _Solution:
    """The iterations of one solution, until the relative residual is below ``goal``."""

    def __init__(self, balance: Balance, solver: LinearSolver, options: NewtonOptions, goal: float, factored: Factored | None):
        self._balance, self._solver, self._options, self._goal = balance, solver, options, goal
        self._body, self._forces = balance.body, balance.forces
        self._iterates: list[Any] = [interface.start() for interface in self._forces.interfaces]
        self._history: list[float] = []
        self._halvings, self._searching = 0, False
        self.factored = factored

    def run(self, guess: Array, rigid_displacement: float) -> Equilibrium:
        """The equilibrium; raises as `Problem.solve` says."""
        state, history = self._start(guess, rigid_displacement), self._history
        for iteration in range(self._options.max_iterations + 1):
            history.append(state.residual)
            if history[-1] < self._goal:
                return Equilibrium(state.unknowns, state.kinematics, state.tractions, tuple(history), state.rigid_displacement)
            exhausted = iteration == self._options.max_iterations or self._halvings > self._options.most_halvings
            if exhausted or not np.isfinite(history[-1]) or self._stagnates():
                break
            check_time()
            state = self._iterated(state)
        self._give_up(state)

    def _start(self, unknowns: Array, rigid_displacement: float) -> NewtonState:
        kinematics = self._admissible(unknowns, 0.0)
        if kinematics is None:
            worst = inside_out_in_words(self._body, self._body.kinematics(unknowns))
            raise ConvergenceError(f"an element is inside out in the state that Newton starts from: {worst}")
        state = self._balance.at(unknowns, kinematics, rigid_displacement)
        if state.residual < NEAR and state.unbalanced < NEAR * state.contact_force:
            self._iterates = self._forces_at(state)
        return self._polished(state)

    def _forces_at(self, state: NewtonState) -> list[Any]:
        """The forces of the interfaces that belong to the displacement."""
        return [i.iterate_at(d) for i, d in zip(self._forces.interfaces, state.displacements, strict=True)]

    def _iterated(self, state: NewtonState) -> NewtonState:
        """The state after one more step; the iterated forces follow."""
        if not self._searching and self._cycles():
            self._searching = True
        if self._searching:
            self._iterates = self._forces_at(state)
        now = self._linearised(state)
        step = self._linear_step(state, now)
        damping, after = self._searched(state, step, *self._damped(state, step))
        self._advance_iterates(now, step, damping)
        return self._polished(after) if damping == 1 else after

    def _linearised(self, state: NewtonState) -> list[LinearisedContact]:
        both = zip(self._forces.interfaces, state.displacements, self._iterates, strict=True)
        return [interface.linearised(displacement, iterate) for interface, displacement, iterate in both]

    def _advance_iterates(self, now: Sequence[LinearisedContact], step: NewtonStep, damping: float) -> None:
        interfaces = self._forces.interfaces
        moves = point_displacements(self._body, step.unknowns, interfaces, self._forces.load_control, step.rigid_displacement)
        together = zip(interfaces, now, self._iterates, moves, strict=True)
        self._iterates = [i.advanced(n, c, move, damping) for i, n, c, move in together]

    def _polished(self, state: NewtonState) -> NewtonState:
        """The state after steps with the last factor, as long as they pay."""
        controlled = self._forces.load_control is not None
        if self.factored is None or (controlled and self.factored.along is None) or not is_exact(self._solver):
            return state
        while self._goal <= state.residual < self._options.polished:
            now = self._linearised(state)
            step = self._step_with_last_factor(state, now)
            kinematics = self._admissible(state.unknowns + step.unknowns, self._options.volume_floor)
            if kinematics is None:
                break
            after = self._balance.at(
                state.unknowns + step.unknowns, kinematics, state.rigid_displacement + step.rigid_displacement
            )
            if not after.residual < CONTRACTION * state.residual:
                break
            self._advance_iterates(now, step, 1.0)
            contraction, state = after.residual / state.residual, after
            if state.residual * contraction**MOST_FURTHER > self._goal:
                break
        return state

    def _give_up(self, state: NewtonState) -> NoReturn:
        history = self._history
        if not np.isfinite(history[-1]):
            interfaces = self._forces.interfaces
            where = not_finite_in_words(self._body, state.kinematics, state.internal, interfaces, state.tractions)
            raise ConvergenceError(f"after {len(history)} iterations {where} is no finite number", history)
        raise ConvergenceError(f"Newton did not converge in {len(history)} iterations (residual {history[-1]:.2e})", history)

    def _searched(
        self, before: NewtonState, step: NewtonStep, damping: float, kinematics: Kinematics
    ) -> tuple[float, NewtonState]:
        """The step length and the state after it: halved while it goes astray, and until the unbalanced forces shrink once the
        residual has cycled or a step far from equilibrium has gone astray."""
        for halved in range(self._options.search_halvings + 1):
            if halved:
                damping /= 2
                kinematics = self._body.kinematics(before.unknowns + damping * step.unknowns)
            after = self._balance.at(
                before.unknowns + damping * step.unknowns,
                kinematics,
                before.rigid_displacement + damping * step.rigid_displacement,
            )
            if not (self._searching or _gone_astray(before, after)) or after.unbalanced < before.unbalanced:
                break
            self._searching = self._searching or before.residual > NEAR
        return damping, after

    def _cycles(self) -> bool:
        """Whether the residual has returned to where it was, as when contact points change their state in a cycle. From then on
        Newton linearises at the forces that belong to the displacement, and halves steps that raise the unbalanced forces."""
        return len(self._history) > CYCLE_AFTER and self._history[-1] > CYCLE_RATIO * min(self._history[-5:-1])

    def _stagnates(self) -> bool:
        """Whether the last iterations, or the first ones, have not halved the residual, as when contact points alternate; the
        search that begins once they do has its own chance."""
        patience, start, history = self._options.patience, self._options.start_patience, self._history
        if start is not None and len(history) > start and min(history) > 0.5 * history[0]:
            return len(history) > start + self._options.patience or not (self._searching or self._cycles())
        return len(history) > 2 * patience and min(history[-patience:]) > 0.5 * min(history[:-patience])

    def _linear_step(self, state: NewtonState, now: Sequence[LinearisedContact]) -> NewtonStep:
        """Newton's step of the unknowns, and of the rigid displacement of the interfaces under load control."""
        body, interfaces, control = self._body, self._forces.interfaces, self._forces.load_control
        allowed = self._options.inexactness(state.residual, self._goal, bordered=control is not None)
        accuracy = max(allowed, finest_step(self._solver))
        constraints, solver = self._balance.constraints, self._solver
        data = body.tangent(state.unknowns, state.kinematics)
        for interface, force in zip(interfaces, now, strict=True):
            interface.surface.add_stiffness(data, force.derivative)
        u, _ = body.space.split(state.unknowns)
        for load in self._forces.loads:
            load.add_stiffness(data, u)
        system = contact_system(body.pattern, constraints, data, interfaces, now)
        self.factored = None  # by a solver that fails, the last factor is lost
        step = solved(solver, system, -constraints.free(self._residual(state, now)), accuracy)
        border = None if control is None else control.border([interface.surface for interface in interfaces], now)
        along = None if border is None else resolved(solver, system.matrix, constraints.free(border.column), accuracy)
        self.factored = Factored(along)
        return bordered(step, border, along)

    def _residual(self, state: NewtonState, now: Sequence[LinearisedContact]) -> Array:
        """Internal forces (size,) less those of the interfaces at the linearised tractions."""
        residual = state.internal.copy()
        for interface, force in zip(self._forces.interfaces, now, strict=True):
            residual -= interface.surface.force(force.traction)
        return residual

    def _step_with_last_factor(self, state: NewtonState, now: Sequence[LinearisedContact]) -> NewtonStep:
        """Step by the last tangent, of which the solver holds the factor."""
        control, interfaces = self._forces.load_control, self._forces.interfaces
        step = self._solver.solve(-self._balance.constraints.free(self._residual(state, now)))
        border = None if control is None else control.border([interface.surface for interface in interfaces], now)
        return bordered(step, border, None if self.factored is None else self.factored.along)

    def _damped(self, before: NewtonState, step: NewtonStep) -> tuple[float, Kinematics]:
        """Largest step length, halving from one, that keeps every element right side out."""
        least, damping = float(self._body.oriented_volume_ratio(before.kinematics).min()), 1.0
        floor = self._options.volume_floor * min(1.0, least)
        while damping >= self._options.smallest_damping:
            after = self._admissible(before.unknowns + damping * step.unknowns, floor)
            if after is not None:
                self._halvings += round(-np.log2(damping))
                return damping, after
            damping /= 2
        worst = inside_out_in_words(self._body, self._body.kinematics(before.unknowns + 2 * damping * step.unknowns))
        raise ConvergenceError(f"an element turns inside out in the direction that Newton wants: {worst}")

    def _admissible(self, unknowns: Array, floor: float) -> Kinematics | None:
        after = self._body.kinematics(unknowns)
        finite = np.isfinite(after.J).all()  # no J is where an entry of F is not
        return after if finite and self._body.oriented_volume_ratio(after).min() > floor else None


def _gone_astray(before: NewtonState, after: NewtonState) -> bool:
    """Whether a step has crushed or blown up elements and left far larger unbalanced forces."""
    if after.unbalanced <= LARGEST_GROWTH * before.unbalanced:
        return False
    J, J_after = before.kinematics.J, after.kinematics.J
    return bool(J_after.min() < DISTORTED * J.min() or J_after.max() > J.max() / DISTORTED)
