"""Newton's solution of a body in contact with rigid bodies, past points that stick and slip by turns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import RelaxationStep
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.equilibrium.balance import Equilibrium, point_displacements
from tactsim.fem.equilibrium.newton import Problem
from tactsim.fem.equilibrium.prescribed_force import PrescribedForce
from tactsim.mechanics.contact.contact_steps import begun_from, held
from tactsim.mechanics.contact.posed_contact import PosedContact

STALLED = 0.1
"""Residual below which Newton was near."""
HELD_ROUNDS = 6
"""How often limits of friction are held before a step counts as failed."""


@dataclass(frozen=True)
class Action:
    """What a step prescribes of the rigid bodies, and what acts on the body beside them.

    Attributes
    ----------
    directions : unit vector (d,) along which each rigid body moves
    force : with which they press along these together in N, if that is prescribed instead of the displacement
    relaxation : coefficients of the time step of materials that relax
    loads : further loads on the body
    """

    directions: Sequence[Array]
    force: float | None = None
    relaxation: RelaxationStep | None = None
    loads: Sequence[FollowerLoad] = ()

    @property
    def load_control(self) -> PrescribedForce | None:
        """The prescribed force, if there is one."""
        return None if self.force is None else PrescribedForce(tuple(self.directions), self.force)


def contact_solution(
    problem: Problem,
    guess: Array,
    contacts: Sequence[PosedContact],
    action: Action,
    *,
    from_guess: bool,
    coarse: float,
) -> Equilibrium:
    """Newton's solution; if it stalls with points that stick and slip by turns, from solutions with limits of friction that do
    not depend on the pressure, which have no such turns (Tresca's friction; the fixed point of Panagiotopoulos 1975,
    doi:10.1007/BF00534623, is Coulomb's).

    Newton starts at a ``guess`` (size,), from the forces of the contacts, or ``from_guess`` with those that belong to it, and
    ends at a ``coarse`` residual if that is above its tolerance.

    Raises
    ------
    ConvergenceError
        If Newton fails.
    """
    attempt = _Attempt(problem, contacts, action, coarse, guess)
    begun = attempt.warm_started() if from_guess else contacts
    for _ in range(HELD_ROUNDS):
        try:
            return attempt.solved(begun)
        except ConvergenceError as stalled:
            if not stalled.history or stalled.history[-1] > STALLED:
                raise
        between = attempt.solved([held(contact, move) for contact, move in attempt.moves])
        attempt = replace(attempt, guess=between.unknowns, rigid_displacement=between.rigid_displacement)
        begun = attempt.warm_started()
    return attempt.solved(begun)


@dataclass(frozen=True)
class _Attempt:
    """Where Newton starts: at a ``guess`` (size,), with the rigid bodies moved on by ``rigid_displacement`` in m."""

    problem: Problem
    contacts: Sequence[PosedContact]
    action: Action
    coarse: float
    guess: Array
    rigid_displacement: float = 0.0

    @property
    def moves(self) -> Iterator[tuple[PosedContact, Array]]:
        """Each contact with the displacements (d, n) of its points in m."""
        body, control = self.problem.body, self.action.load_control
        return zip(
            self.contacts, point_displacements(body, self.guess, self.contacts, control, self.rigid_displacement), strict=True
        )

    def warm_started(self) -> list[PosedContact]:
        """The contacts with the forces that belong to the guess."""
        return [begun_from(contact, contact.at(move)) for contact, move in self.moves]

    def solved(self, interfaces: Sequence[PosedContact]) -> Equilibrium:
        """Newton's solution with these contacts; raises ConvergenceError."""
        return self.problem.solve(
            self.guess,
            interfaces=interfaces,
            loads=self.action.loads,
            load_control=self.action.load_control,
            rigid_displacement=self.rigid_displacement,
            relaxation=self.action.relaxation,
            coarse=self.coarse,
        )
