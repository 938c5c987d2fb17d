"""What every accepted state with contact is held to: the one place that looks at it again before it counts.

A state is judged by its unknowns and its contact forces alone, not by what the solver says of itself: the deformation, the gaps
and the balance are computed anew. Every model with contact takes its states from `guaranteed_equilibrium`; a step that ends in a
state that breaks the guarantee is taken back and a shorter one tried, as after any other failure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.penalty import Regularisation
from tactsim.errors import ConvergenceError
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.fem.assembly.surface import SurfaceAssembly
from tactsim.fem.equilibrium.balance import Balance, ExternalForces, NewtonState
from tactsim.fem.equilibrium.diagnosis import inside_out_in_words
from tactsim.fem.equilibrium.newton import Problem
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium, contact_equilibrium
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.units import format_quantity

ROUND_OFF = 1e-9
"""Relative excess over a bound, and length of a vector beside that of its own plane, that is round-off."""
RESIDUAL_SHARE = 2.0
"""Largest residual over Newton's tolerance: under a prescribed force the contact is evaluated at positions that differ by
round-off from those at which Newton stopped, and the round-off of the contact, which residuals are measured by, counts again."""


def guaranteed_equilibrium(
    problem: Problem,
    state: ContactEquilibrium,
    load: float,
    guess: Array,
    action: Action,
) -> ContactEquilibrium:
    """The state of `contact_equilibrium` with the same arguments and its reactions, once it has passed `check_accepted`.

    ``load`` is in m, ``guess`` (size,) holds the unknowns.

    Raises
    ------
    ConvergenceError
        If there is none, or it breaks the guarantee.
    """
    reached = contact_equilibrium(problem, state, load, guess, action)
    try:
        return replace(reached, reactions=check_accepted(problem, reached, action))
    except ConvergenceError as error:
        error.solutions = reached.iterations
        raise


def check_accepted(problem: Problem, state: ContactEquilibrium, action: Action) -> Array:
    """Check that a state keeps all that is guaranteed of an accepted one.

    1. Unknowns, deformation and contact forces are finite numbers.
    2. J > 0 in every element whose material is not a small-strain one, and no section has passed the axis of revolution.
    3. No surface point is deeper in a rigid body than the penetration tolerance, and none presses across a gap wider than the
       reach of the regularisation.
    4. Pressures only push, and friction lies along the rigid body and within the limit of the contact law.
    5. The body has the volume that its pressure asks for, to Newton's tolerance.
    6. Internal forces, the recorded contact forces and all other loads balance, to Newton's tolerance.

    Parameters
    ----------
    action : that the state was solved with

    Returns
    -------
    reactions : (displacement unknowns,) in N of contacts and supports: the internal forces less those of the loads

    Raises
    ------
    ConvergenceError
        Naming what is broken and by how much.
    """
    body = problem.body
    kinematics = body.kinematics(state.unknowns)
    fault = _not_finite(state, kinematics) or _inside_out(body, kinematics)
    for number, contact in enumerate(state.contacts, 1):
        fault = fault or _contact_fault(body, state, contact, f"rigid body {number}")
    if fault is None:
        recorded = tuple(_Recorded(contact) for contact in state.contacts)
        forces = ExternalForces(recorded, tuple(action.loads), action.load_control)  # type: ignore[arg-type]
        balance = problem.balance(forces, action.relaxation)
        now = balance.at(state.unknowns, kinematics, 0.0)
        fault = _unbalanced(balance, now)
    if fault is not None:
        raise ConvergenceError(f"the state breaks what every accepted state is held to: {fault}")
    return now.internal[: body.space.displacement_size]


@dataclass(frozen=True)
class _Recorded:
    """The forces that an accepted state recorded for one contact, as an interface that no longer follows displacements."""

    contact: PosedContact

    @property
    def surface(self) -> SurfaceAssembly:
        """The surface that they act on."""
        return self.contact.surface

    def converged(self, _displacement: Array) -> Array:
        """Traction (d, n) in Pa."""
        return self.contact.state.traction

    def rounding(self, displacement: Array) -> Array:
        """Traction (n,) in Pa lost in the round-off of the positions; the multipliers by which a point pressed are gone."""
        return self.contact.rounding(displacement, pressed=self.contact.state.pressure > 0)


def _not_finite(state: ContactEquilibrium, kinematics: Kinematics) -> str | None:
    values = {"unknowns": (state.unknowns,), "deformation": (kinematics.F, kinematics.J)}
    contacts = [(c.place, c.state.pressure, c.state.tangential, c.state.normals) for c in state.contacts]
    values["contact forces"] = tuple(array for arrays in contacts for array in arrays)
    return next((f"its {name} are no finite numbers" for name, arrays in values.items() if not _finite(arrays)), None)


def _finite(arrays: Sequence[Array]) -> bool:
    return all(np.isfinite(array).all() for array in arrays)


def _inside_out(body: Body, kinematics: Kinematics) -> str | None:
    inside_out = body.oriented_volume_ratio(kinematics).min() <= 0
    return f"{inside_out_in_words(body, kinematics)}; allowed: above 0" if inside_out else None


def _contact_fault(body: Body, state: ContactEquilibrium, contact: PosedContact, name: str) -> str | None:
    """What is wrong with the contact of a rigid body, None if nothing is."""
    gap = contact.gap(contact.surface.points.interpolate(body.space.split(state.unknowns)[0]))
    return _apart_or_inside(gap, contact, state.regularisation, name) or _force_fault(contact, name)


def _apart_or_inside(gap: Array, contact: PosedContact, regularisation: Regularisation, name: str) -> str | None:
    deepest, pressed = float(-gap.min()), contact.state.pressure > 0
    if deepest > regularisation.tolerance * (1 + ROUND_OFF):
        penetration, allowed = (format_quantity(value, "m") for value in (deepest, regularisation.tolerance))
        return f"{name} is penetrated by {penetration}; allowed: {allowed}"
    clear = float(gap[pressed].max()) if pressed.any() else 0.0
    if clear > regularisation.reach * (1 + ROUND_OFF) + ROUND_OFF * regularisation.tolerance:
        wide, reach = (format_quantity(value, "m") for value in (clear, regularisation.reach))
        return f"{name} presses across a gap of {wide}; allowed: {reach}"
    return None


def _force_fault(contact: PosedContact, name: str) -> str | None:
    pressure, tangential = contact.state.pressure, contact.state.tangential
    if pressure.min() < 0:
        return f"{name} pulls with {format_quantity(float(-pressure.min()), 'Pa')}; allowed: only to press"
    friction = np.linalg.norm(tangential, axis=0)
    limit = np.where(pressure > 0, contact.pair.traction_limit(pressure), 0.0)
    beyond = friction > limit * (1 + ROUND_OFF)
    if beyond.any():
        point = int(np.where(beyond, friction - limit, -np.inf).argmax())
        size, allowed = (format_quantity(float(value[point]), "Pa") for value in (friction, limit))
        return f"friction of {size} on {name} where the contact law allows {allowed}"
    across = np.abs(np.einsum("in,in->n", tangential, contact.state.normals))
    if (across > ROUND_OFF * np.maximum(pressure, friction)).any():
        return f"friction on {name} has {format_quantity(float(across.max()), 'Pa')} across its surface; allowed: along it"
    return None


def _unbalanced(balance: Balance, now: NewtonState) -> str | None:
    """What is wrong with the balance of volume and forces, None if nothing is."""
    volume = now.internal[balance.body.space.displacement_size :].sum() / balance.body.points.weights.sum()
    if not abs(volume) <= RESIDUAL_SHARE * balance.tolerance:
        return f"its volume differs by {volume:.1e} of itself from what its pressure asks for; allowed: {balance.tolerance:g}"
    if not now.residual <= RESIDUAL_SHARE * balance.tolerance:
        return f"its forces are out of balance, a residual of {now.residual:.1e}; allowed: {balance.tolerance:g}"
    return None
