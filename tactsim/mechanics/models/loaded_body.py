"""A body under prescribed motions of its faces, tractions, pressures and rigid bodies, each with its own course in time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np
from scipy.sparse import csr_matrix

from tactsim.array import Array
from tactsim.contact.penalty import Regularisation
from tactsim.fem.assembly.body import Body, RelaxationStep
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.assembly.regularising_springs import RegularisingSprings
from tactsim.fem.assembly.space import TaylorHood
from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.fem.solvers.linear import solved
from tactsim.fem.solvers.solver_choice import solver_for
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.mechanics.contact.guarantee import guaranteed_equilibrium
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.fields.point_values import cauchy_stress, von_mises
from tactsim.mechanics.fields.section_fields import section_frame
from tactsim.mechanics.fields.solid_fields import solid_frame
from tactsim.mechanics.models.prescribed_motion import Prescribed, PrescribedMotions
from tactsim.mesh.quadratic import QuadraticMesh
from tactsim.results.fields import VON_MISES
from tactsim.results.result import FieldFrame

ACCURACY = 1e-6
"""Error of the first guess of a step, over its size: Newton mends it."""


class FactoredForce(Protocol):
    """A load that a factor makes larger."""

    def at(self, pressure: float, /) -> FollowerLoad:
        """The load at a factor, or a pressure in Pa."""


@dataclass(frozen=True)
class MovedContact:
    """A contact that begins as ``posed``; its rigid body moves by ``displacements`` (k, d) in m, each times its factor."""

    posed: PosedContact
    displacements: Array

    def place(self, factors: Sequence[float]) -> Array:
        """Place (d,) in m of the rigid body at its k factors."""
        return self.posed.place + np.asarray(factors) @ self.displacements


@dataclass(frozen=True)
class Conditions:
    """What acts on a body; the factors of the motions come first, then those of the loads, then those of each contact in turn.

    ``unit_loads`` are loads with the size that each has at the factor one, which `FactoredForce.at` takes.
    """

    motions: PrescribedMotions
    motion_count: int
    loads: tuple[FactoredForce, ...] = ()
    unit_loads: tuple[float, ...] = ()
    contacts: tuple[MovedContact, ...] = ()

    @property
    def count(self) -> int:
        """Number of factors."""
        return self.motion_count + len(self.loads) + sum(len(contact.displacements) for contact in self.contacts)

    @property
    def only_contacts_act(self) -> bool:
        """Whether all that deforms the body are rigid bodies, each of which moves."""
        still = not self.loads and not self.motions.move
        return still and bool(self.contacts) and all(contact.displacements.any() for contact in self.contacts)

    def split(self, factors: Sequence[float]) -> tuple[Sequence[float], Sequence[float]]:
        """The factors of motions and of loads."""
        first, second = self.motion_count, self.motion_count + len(self.loads)
        return factors[:first], factors[first:second]

    def places(self, factors: Sequence[float]) -> list[Array]:
        """Place (d,) in m of every rigid body at all the factors."""
        places, first = [], self.motion_count + len(self.loads)
        for contact in self.contacts:
            last = first + len(contact.displacements)
            places.append(contact.place(factors[first:last]))
            first = last
        return places


class LoadedBody:
    """Finds the equilibrium of a body at given factors of its conditions.

    Parameters
    ----------
    mesh, body : what deforms
    conditions : what acts on it
    regularisation : of its contacts
    options : of Newton's method
    """

    def __init__(
        self,
        mesh: QuadraticMesh,
        body: Body,
        conditions: Conditions,
        regularisation: Regularisation,
        *,
        options: NewtonOptions | None = None,
    ):
        self.mesh, self.body, self.conditions = mesh, body, conditions
        self.space: TaylorHood = body.space
        self._regularisation = regularisation
        solver = solver_for(body) if self.space.dim == 3 else None
        self.problem = Problem(body, conditions.motions.unknowns, solver=solver, options=options or NewtonOptions())
        self._springs: tuple[FollowerLoad, ...] = (RegularisingSprings(body),) if conditions.contacts else ()

    def at_rest(self) -> ContactEquilibrium:
        """The undeformed body."""
        contacts = tuple(contact.posed for contact in self.conditions.contacts)
        return ContactEquilibrium.at_rest(self.body, contacts, self._regularisation)

    def equilibrium(
        self, now: ContactEquilibrium, loads: tuple[float, ...], guess: Array, relaxation: RelaxationStep | None
    ) -> ContactEquilibrium:
        """The equilibrium at these factors, reached from ``now``; its ``load`` is how far the rigid bodies moved, in m.

        ``guess`` (size + 1,) holds the unknowns and that distance.

        Raises
        ------
        ConvergenceError
            If there is none that Newton finds.
        """
        motions, forces = self.conditions.split(loads)
        acting = [*self._springs, *self._forces(forces)]
        held = self.conditions.motions.at(motions)
        problem = self._problem(held)
        stiffness = partial(self._stiffness, self.body.with_relaxation(relaxation), now, acting)
        unknowns = self._lifted(problem, held, guess[:-1], stiffness)
        if not now.contacts:
            reached = problem.solve(unknowns, loads=acting, relaxation=relaxation)
            return ContactEquilibrium(
                now.load, reached.unknowns, reached.iterations, reached.history[-1], (), now.regularisation, reached.kinematics
            )
        places = self.conditions.places(loads)
        steps = [place - contact.place for place, contact in zip(places, now.contacts, strict=True)]
        distance = max(float(np.linalg.norm(step)) for step in steps)
        directions = [step / distance if distance > 0 else step for step in steps]
        return guaranteed_equilibrium(
            problem, now, now.load + distance, unknowns, Action(directions, relaxation=relaxation, loads=acting)
        )

    def frame(self, state: ContactEquilibrium, *, time: float, isochoric: Array | None = None) -> FieldFrame:
        """Fields of a state for ParaView, with von Mises's stress in Pa, the mean of each element.

        ``time`` is in s, ``isochoric`` (6, E, Q) in Pa as in `cauchy_stress`.
        """
        draw = section_frame if self.space.dim == 2 else solid_frame
        frame = draw(self.mesh, self.body, state, time=time, isochoric=isochoric)
        stress = cauchy_stress(self.body, state.unknowns, state.kinematics, isochoric)
        return replace(frame, cell_data={**frame.cell_data, VON_MISES: von_mises(stress).mean(axis=1)})

    def internal_forces(self, unknowns: Array, relaxation: RelaxationStep | None = None) -> Array:
        """Internal nodal forces (n, d) in N: what acts on each node from outside."""
        return self._nodal(self.body.with_relaxation(relaxation).residual(unknowns))

    def tangent(self, state: ContactEquilibrium, factors: Sequence[float]) -> csr_matrix:
        """Tangent of body and loads in N/m, of a body that does not relax; prescribed unknowns have one on the diagonal."""
        motions, loads = self.conditions.split(factors)
        forces, constraints = self._forces(loads), self._problem(self.conditions.motions.at(motions)).constraints
        return self.body.pattern.matrix(constraints.apply(self._stiffness(self.body, state, forces)))

    def load_forces(self, unknowns: Array, factors: Sequence[float]) -> list[Array]:
        """Nodal forces (n, d) in N of each load, of all the factors of the conditions."""
        u, _ = self.space.split(unknowns)
        return [self._nodal(load.force(u)) for load in self._forces(self.conditions.split(factors)[1])]

    def contact_forces(self, state: ContactEquilibrium) -> list[Array]:
        """Nodal forces (n, d) in N of each rigid body."""
        return [self._nodal(one.surface.force(one.state.traction)) for one in state.contacts]

    def _nodal(self, forces: Array) -> Array:
        """Those (n, d) on displacements, of forces (size,) on all unknowns."""
        return forces[: self.space.displacement_size].reshape(-1, self.space.dim)

    def _forces(self, factors: Sequence[float]) -> list[FollowerLoad]:
        """The loads at their factors."""
        together = zip(self.conditions.loads, self.conditions.unit_loads, factors, strict=True)
        return [load.at(factor * unit) for load, unit, factor in together]

    def _stiffness(self, body: Body, state: ContactEquilibrium, loads: Sequence[FollowerLoad]) -> Array:
        """Entries of the tangent of a body and of loads in a state."""
        data = body.tangent(state.unknowns, state.kinematics)
        u, _ = self.space.split(state.unknowns)
        for load in loads:
            load.add_stiffness(data, u)
        return data

    def _problem(self, held: Prescribed) -> Problem:
        """The problem with what is held; where nodes slide, of its own, as their directions turn from step to step."""
        if held.slides is None:
            return self.problem
        constraints = Constraints(held.unknowns, self.body.pattern, slides=held.slides)
        return Problem(self.body, constraints, solver=self.problem.solver, options=self.problem.options)

    def _lifted(self, problem: Problem, held: Prescribed, guess: Array, stiffness: Callable[[], Array]) -> Array:
        """The guess with the prescribed displacements; what it misses of them goes on linearly into the body."""
        unknowns, missing = guess.copy(), held.missing(guess)
        if not missing.any():
            return unknowns
        if np.abs(missing).max() > ACCURACY * held.largest:
            data, matrix = stiffness(), self.body.pattern.matrix
            right = problem.constraints.free(-(matrix(data) @ missing)) + missing
            unknowns += solved(problem.solver, matrix(problem.constraints.apply(data)), right, ACCURACY)
        unknowns[held.unknowns] = held.values
        return unknowns + held.missing(unknowns)
