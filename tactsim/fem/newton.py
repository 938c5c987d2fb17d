"""Newton's method for the equilibrium of a body under nodal forces, follower pressures and contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tactsim.deadline import check_time
from tactsim.errors import ConvergenceError
from tactsim.fem.body import Body, Kinematics, PastStress
from tactsim.fem.constraints import Constraints
from tactsim.fem.diagnosis import inside_out_in_words, not_finite_in_words
from tactsim.fem.external_forces import FollowerLoad, Interface
from tactsim.fem.linear import DirectSolver, direct_solver, resolved, solved
from tactsim.fem.prescribed_force import PrescribedForce

Array = np.ndarray


CYCLE_AFTER = 6
CYCLE_RATIO = 0.9
"""A residual above this part of the smallest of the four before it, from iteration ``CYCLE_AFTER`` on, goes in a circle."""
ROUND_OFF = 128 * np.finfo(float).eps
"""Residuals below this part of the forces that a stress of the shear modulus makes are round-off: F is one plus small numbers."""


FORCING, LARGEST_FORCING = 0.05, 1e-2
"""Error of a linear step over its size, over the residual that it starts from, and at most: so small that Newton still converges
nearly quadratically (Eisenstat & Walker 1996, doi:10.1137/0917003). Direct solvers are exact anyway."""


SHARE_OF_TOLERANCE = 0.1
"""Part of Newton's tolerance that the error of the last linear step may leave."""


@dataclass(frozen=True)
class NewtonOptions:
    """When Newton stops, and when it gives up."""

    tolerance: float = 1e-10
    """Largest residual over the largest nodal force (not below round-off), and over the mean nodal volume."""
    max_iterations: int = 25
    smallest_damping: float = 1 / 256
    search_halvings: int = 5
    """How often a step is halved for a smaller residual, once the residual has moved in circles."""
    patience: int = 8
    """Newton gives up when this many iterations in a row have not halved the smallest residual before them."""
    start_patience: int | None = None
    """Newton gives up when the first so many iterations have not halved the residual: a shorter load step is cheaper. None means
    ``patience`` alone."""
    most_halvings: int = 10
    """Newton gives up when it has halved its steps so often in all: a shorter load step is cheaper."""
    volume_floor: float = 0.2
    """A step is shortened until no J falls below this part of the smallest J before it."""


@dataclass(frozen=True)
class Equilibrium:
    """A converged state: the unknowns, the deformation, the traction at each interface, and how Newton got there."""

    unknowns: Array
    kinematics: Kinematics
    tractions: tuple[Array, ...]
    history: tuple[float, ...]
    travel: float = 0.0
    """Travel in m of the interfaces along a prescribed force."""

    @property
    def iterations(self) -> int:
        """Linear systems solved."""
        return len(self.history) - 1


@dataclass(frozen=True)
class _Iterate:
    """Where Newton is: ``internal`` less external nodal forces in N, the interfaces' moves in m and tractions in Pa, the relative
    ``residual``, and the root of the sum of all squared ``unbalanced`` forces in N."""

    unknowns: Array
    kinematics: Kinematics
    travel: float
    internal: Array
    moved: list[Array]
    tractions: tuple[Array, ...]
    residual: float
    unbalanced: float


class Problem:
    """A body with fixed unknowns, interfaces and loads; keeps the sparse solver between solutions."""

    def __init__(self, body: Body, fixed: Array, *, solver: DirectSolver | None = None, options: NewtonOptions | None = None):
        self.body = body
        self.constraints = Constraints(fixed, body.pattern)
        self.solver = solver or direct_solver()
        self.options = options or NewtonOptions()
        self._volume_scale = body.points.weights.sum() / len(body.space.pressure_corners)
        self._noise = ROUND_OFF * np.repeat(body.rounding_forces(), body.space.dim)

    def solve(
        self,
        guess: Array,
        *,
        interfaces: Sequence[Interface] = (),
        loads: Sequence[FollowerLoad] = (),
        nodal_force: Array | None = None,
        push: PrescribedForce | None = None,
        travel: float = 0.0,
        past: PastStress | None = None,
        coarse: float = 0.0,
    ) -> Equilibrium:
        """Equilibrium nearest to the guess, which holds the prescribed values.

        Parameters
        ----------
        guess : (size,) unknowns
        interfaces, loads, nodal_force : what acts on the body
        push : the force that the interfaces must exert, if it is prescribed instead of their place
        travel : first guess of their travel in m
        past : what materials that relax remember
        coarse : a residual that suffices, if it is above the tolerance of the options

        Raises
        ------
        ConvergenceError
            If Newton does not converge or an element would turn inside out; the history is in the error.
        OutOfTime
            If the time allowed has passed.
        """
        options, history = self.options, []
        tolerance = max(options.tolerance, coarse)
        body = self.body if past is None else self.body.with_past(past)
        carried = [interface.start() for interface in interfaces]
        unknowns, halvings = guess.copy(), 0
        kinematics = self._admissible(unknowns, 0.0)
        if kinematics is None:
            worst = inside_out_in_words(body, body.kinematics(unknowns))
            raise ConvergenceError(f"an element is inside out in the state that Newton starts from: {worst}")
        forces = (interfaces, loads, nodal_force, push)
        state = self._balance(body, unknowns, kinematics, travel, forces)
        searching = False
        for iteration in range(options.max_iterations + 1):
            history.append(state.residual)
            if history[-1] < tolerance:
                return Equilibrium(state.unknowns, state.kinematics, state.tractions, tuple(history), state.travel)
            exhausted = iteration == options.max_iterations or halvings > options.most_halvings
            if exhausted or not np.isfinite(history[-1]) or self._stagnates(history):
                break
            check_time()
            if searching := searching or self._cycles(history):
                carried = [i.settled(d) for i, d in zip(interfaces, state.moved, strict=True)]
            now = [i.linearised(d, c) for i, d, c in zip(interfaces, state.moved, carried, strict=True)]
            needed = SHARE_OF_TOLERANCE * tolerance / history[-1]
            accuracy = min(max(FORCING * history[-1], needed), LARGEST_FORCING)
            step, further = self._linear_step(body, state, (interfaces, now, loads, accuracy), push)
            damping, admissible = self._damped(state.unknowns, step, state.kinematics)
            halvings += round(-np.log2(damping))
            search = options.search_halvings if searching else 0
            damping, state = self._searched(body, state, (step, further), (damping, admissible, search), forces)
            moves = self.displacements(step, interfaces, push, further)
            carried = [i.advanced(n, c, move, damping) for i, n, c, move in zip(interfaces, now, carried, moves, strict=True)]
        if not np.isfinite(history[-1]):
            where = not_finite_in_words(body, state.kinematics, state.internal, interfaces, state.tractions)
            raise ConvergenceError(f"after {len(history)} iterations {where} is no finite number", history)
        raise ConvergenceError(f"Newton did not converge in {len(history)} iterations (residual {history[-1]:.2e})", history)

    def _balance(self, body: Body, unknowns: Array, kinematics: Kinematics, travel: float, forces: tuple[Any, ...]) -> _Iterate:
        """The iterate at these unknowns with the forces that hold there."""
        interfaces, loads, nodal_force, push = forces
        internal = body.residual(unknowns, kinematics)
        scale = np.abs(internal[: body.space.displacement_size]).max()
        internal -= self._nodal(unknowns, loads, nodal_force)
        moved = self.displacements(unknowns, interfaces, push, travel)
        tractions = tuple(interface.converged(d) for interface, d in zip(interfaces, moved, strict=True))
        noise = [interface.rounding(d) for interface, d in zip(interfaces, moved, strict=True)]
        residual, unbalanced = self._residual_norm(internal, scale, interfaces, (tractions, noise))
        if push is not None:
            surfaces = [interface.surface for interface in interfaces]
            residual = max(residual, push.error(surfaces, tractions, noise, self.options.tolerance))
        return _Iterate(unknowns, kinematics, travel, internal, moved, tractions, residual, unbalanced)

    def _searched(
        self,
        body: Body,
        before: _Iterate,
        way: tuple[Array, float],
        start: tuple[float, Kinematics, int],
        forces: tuple[Any, ...],
    ) -> tuple[float, _Iterate]:
        """The step length, halved some times at most until the unbalanced forces shrink, and where it leads."""
        (step, further), (damping, kinematics, most) = way, start
        for halved in range(most + 1):
            if halved:
                damping /= 2
                kinematics = body.kinematics(before.unknowns + damping * step)
            travel = before.travel + damping * further
            after = self._balance(body, before.unknowns + damping * step, kinematics, travel, forces)
            if after.unbalanced < before.unbalanced:
                break
        return damping, after

    @staticmethod
    def _cycles(history: list[float]) -> bool:
        """Whether the residual is back where it was: contact points switch in a circle. From then on Newton linearises the forces
        that hold, not those it carries, and halves steps that raise the unbalanced forces."""
        return len(history) > CYCLE_AFTER and history[-1] > CYCLE_RATIO * min(history[-5:-1])

    def _stagnates(self, history: list[float]) -> bool:
        """Whether the last iterations brought nothing, as when contact points switch to and fro, or the first ones."""
        patience, start = self.options.patience, self.options.start_patience
        if start is not None and len(history) > start and min(history) > 0.5 * history[0]:
            return True
        return len(history) > 2 * patience and min(history[-patience:]) > 0.5 * min(history[:-patience])

    def _nodal(self, unknowns: Array, loads: Sequence[FollowerLoad], nodal_force: Array | None) -> Array:
        u, _ = self.body.space.split(unknowns)
        total = np.zeros(self.body.space.size)
        for load in loads:
            total += load.force(u)
        return total if nodal_force is None else total + nodal_force

    def displacements(
        self, unknowns: Array, interfaces: Sequence[Interface], push: PrescribedForce | None, travel: float
    ) -> list[Array]:
        """Displacement (d, n) of each surface relative to the travel of its interface."""
        moved = [interface.surface.points.interpolate(self.body.space.split(unknowns)[0]) for interface in interfaces]
        if push is None:
            return moved
        return [displacement - travel * e[:, None] for displacement, e in zip(moved, push.directions, strict=True)]

    def _residual_norm(
        self, internal: Array, scale: float, interfaces: Sequence[Interface], forces: tuple[Any, Any]
    ) -> tuple[float, float]:
        """Largest unbalanced force over the largest force (or the node's round-off over the tolerance), or largest volume
        error over the mean nodal volume; and the root of the sum of all squared unbalanced forces in N."""
        residual, split = internal.copy(), self.body.space.displacement_size
        scale, noise = max(scale, float(np.abs(internal[:split]).max())), self._noise.copy()
        for interface, traction, lost in zip(interfaces, *forces, strict=True):
            force = interface.surface.force(traction)
            scale = max(scale, float(np.abs(force).max()))
            residual -= force
            noise += interface.surface.largest_force(lost)[:split]
        residual = self.constraints.free(residual)
        unbalanced = (np.abs(residual[:split]) / np.maximum(scale, noise / self.options.tolerance)).max()
        relative = float(max(unbalanced, np.abs(residual[split:]).max() / self._volume_scale))
        return relative, float(np.linalg.norm(residual[:split]))

    def _linear_step(
        self, body: Body, state: _Iterate, parts: tuple[Any, ...], push: PrescribedForce | None
    ) -> tuple[Array, float]:
        """Newton's step of the unknowns, and of the interfaces' travel if their force is prescribed."""
        interfaces, now, loads, accuracy = parts
        residual, data = state.internal.copy(), body.tangent(state.unknowns, state.kinematics)
        coupling = np.zeros(len(data))
        for interface, force in zip(interfaces, now, strict=True):
            residual -= interface.surface.force(force.traction)
            data += interface.surface.stiffness(force.derivative)
            if force.coupling.any():
                coupling += interface.surface.stiffness(force.coupling)
        u, _ = body.space.split(state.unknowns)
        for load in loads:
            data += load.stiffness(u)
        matrix = body.pattern.matrix(self.constraints.apply(data))
        nearby = body.pattern.matrix(self.constraints.apply(data - coupling)) if coupling.any() else matrix
        step = solved(self.solver, matrix, -self.constraints.free(residual), accuracy, nearby)
        if push is None:
            return step, 0.0
        border = push.border([interface.surface for interface in interfaces], now)
        along = resolved(self.solver, matrix, self.constraints.free(border.column), accuracy)
        further = border.travel(step, along)
        return step + further * along, further

    def _damped(self, unknowns: Array, step: Array, before: Kinematics) -> tuple[float, Kinematics]:
        """Largest step length, halving from one, that keeps every element right side out."""
        floor, damping = self.options.volume_floor * min(1.0, float(before.J.min())), 1.0
        while damping >= self.options.smallest_damping:
            after = self._admissible(unknowns + damping * step, floor)
            if after is not None:
                return damping, after
            damping /= 2
        worst = inside_out_in_words(self.body, self.body.kinematics(unknowns + 2 * damping * step))
        raise ConvergenceError(f"an element turns inside out in the direction that Newton wants: {worst}")

    def _admissible(self, unknowns: Array, floor: float) -> Kinematics | None:
        after = self.body.kinematics(unknowns)
        nonlinear = ~self.body.linear
        J = after.J[nonlinear]
        ok = np.isfinite(after.F).all() and (not J.size or J.min() > floor)
        return after if ok else None
