"""Newton's solution of a body in contact with rigid bodies, past points that stick and slip by turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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

    def warm_started() -> list[PosedContact]:
        """The contacts with the forces that belong to the guess."""
        moves = point_displacements(problem.body, guess, contacts, load_control, rigid_displacement)
        return [begun_from(contact, contact.at(move)) for contact, move in zip(contacts, moves, strict=True)]

    def solve(interfaces: Sequence[PosedContact]) -> Equilibrium:
        """From the guess, with what acts."""
        return problem.solve(
            guess,
            interfaces=interfaces,
            loads=action.loads,
            load_control=load_control,
            rigid_displacement=rigid_displacement,
            relaxation=action.relaxation,
            coarse=coarse,
        )

    load_control, rigid_displacement = action.load_control, 0.0
    begun = warm_started() if from_guess else list(contacts)
    for held_round in range(HELD_ROUNDS + 1):
        try:
            return solve(begun)
        except ConvergenceError as stalled:
            if held_round == HELD_ROUNDS or not stalled.history or stalled.history[-1] > STALLED:
                raise
        moves = point_displacements(problem.body, guess, contacts, load_control, rigid_displacement)
        between = solve([held(contact, move) for contact, move in zip(contacts, moves, strict=True)])
        guess, rigid_displacement = between.unknowns, between.rigid_displacement
        begun = warm_started()
    raise AssertionError("the last round returns or raises")
