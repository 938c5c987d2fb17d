"""Equilibrium of a body with rigid bodies that move together, the contact as stiff as the penetration tolerance asks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tactsim.array import Array
from tactsim.contact.penalty import Augmentation, Regularisation
from tactsim.contact.stick import Stick
from tactsim.errors import Collapsed, ConvergenceError, TooShort
from tactsim.fem.assembly.body import Body, Kinematics
from tactsim.fem.assembly.external_forces import FollowerLoad
from tactsim.fem.equilibrium.diagnosis import collapsed_in_words
from tactsim.fem.equilibrium.newton import Problem
from tactsim.mechanics.contact.contact_solution import Action, contact_solution
from tactsim.mechanics.contact.contact_steps import accepted, augmented, continued, expected, grown, moved_on, touching
from tactsim.mechanics.contact.first_force import state_near
from tactsim.mechanics.contact.posed_contact import PosedContact
from tactsim.mechanics.contact.snap_through import after_snap

PENALTY_ATTEMPTS = 5
"""How often a step is solved again with a stiffer contact before it counts as failed."""
AUGMENTATIONS = 20
"""How often with better multipliers."""
PATIENCE, SHRUNK = 6, 0.5
"""After so many augmentations, if penetration and slip have not only shrunk from one to the next, the contact becomes stiffer for
the rest of the step whenever they do not fall below this part of the last ones (Bertsekas 1982,
doi:10.1016/C2013-0-10366-2).

Why: where the free face rolls onto a jaw, a cell or two of the face hang between a point that presses and its neighbour that
lifts. In a soft contact augmentations overshoot there: the tissue opens where it was pressed too hard and presses the neighbour,
then the other way round, for all of the ``AUGMENTATIONS``, and no step is short enough to end this. Averaged forces end some such
turns only: jaws of 30 mm with edges of 1 mm, closed by 2.5 mm at friction 0.2, took 160 linear solutions and gave up half way;
stiffened twice, they take 40. All shipped cases approach evenly, by up to eleven, and are not touched."""
COARSE = 4.5e-2
"""Residual that suffices between augmentations, with friction: without it Newton is as fast to the end."""
SHARPER = 0.3
"""Factor of that residual once an augmentation has not raised the residual above it."""

SNAP_STEP = 5e-3
"""Step over the load below which a step that fails is one to which no equilibrium is near, so that the body snaps to another."""
SNAP_LENGTH = 2e-4
"""What of such a step, over the load, the body snaps under; the rest follows from there.

Why: against drag only the contact follows the load, and in elements shorter than the step it crushes them. With whole steps three
random deep indentations searched for 300 solutions among states turned nearly inside out, and gave up; with these all pass."""


@dataclass(frozen=True)
class ContactEquilibrium:
    """An accepted state: ``unknowns`` (size,), and ``load``, the displacement in m of the rigid bodies from first touch.

    ``reactions`` (d n,) in N are what contacts and supports exert on the nodes: the internal forces less those of the loads, as
    `check_accepted` computed them; None of a state that it has not passed.
    """

    load: float
    unknowns: Array
    iterations: int
    residual: float
    contacts: tuple[PosedContact, ...]
    regularisation: Regularisation
    kinematics: Kinematics
    reactions: Array | None = None

    @classmethod
    def at_rest(cls, body: Body, contacts: tuple[PosedContact, ...], regularisation: Regularisation) -> ContactEquilibrium:
        """The undeformed body with these contacts."""
        unknowns = np.zeros(body.space.size)
        return cls(0.0, unknowns, 0, 0.0, contacts, regularisation, body.kinematics(unknowns))

    @property
    def penetration(self) -> float:
        """Largest penetration in m of a surface point in any of the rigid bodies, 0 if none is in one."""
        return max([0.0, *(-float(one.pair.body.signed_distance(one.state.points)[0].min()) for one in self.contacts)])

    def expecting(self, reached: Sequence[PosedContact]) -> ContactEquilibrium:
        """This state before a step whose forces are expected to be those of the contacts ``reached`` from it."""
        both = zip(self.contacts, reached, strict=True)
        return replace(self, contacts=tuple(replace(contact, growth=there.growth) for contact, there in both))


def contact_equilibrium(
    problem: Problem, state: ContactEquilibrium, load: float, guess: Array, action: Action
) -> ContactEquilibrium:
    """The state of ``_equilibrium`` from a ``guess`` (size,), or why none can be reached from ``state`` by any shorter step.

    Raises
    ------
    ConvergenceError
        If Newton fails, or no penalty keeps the tissue out of the bodies.
    Collapsed
        If so, and an element of ``state`` is nearly inside out already.
    """
    if action.force is not None:
        contacts, distance = touching(state.contacts, problem.body.space.split(state.unknowns)[0], action.directions)
        state, load = replace(state, load=state.load + distance, contacts=contacts), load + distance
    try:
        return _equilibrium(problem, state, load, guess, action)
    except TooShort:
        raise
    except ConvergenceError as error:
        if collapsed := collapsed_in_words(problem.body, state.kinematics, state.unknowns):
            raise Collapsed(
                f"{collapsed}, and no step leads on: the mesh is too coarse there, or the load too large; {error}"
            ) from error
        for another_way in (_softened, _approached, _by_displacement, _from_stick):
            if reached := another_way(problem, state, load, guess, action):
                return reached
        if not 0 < load - state.load <= SNAP_STEP * load:
            raise
    return _after_snap(problem, state, load, action)


def _softened(
    problem: Problem, state: ContactEquilibrium, load: float, guess: Array, action: Action
) -> ContactEquilibrium | None:
    """The state of tissue that relaxes, the contact no stiffer than its present pressure asks; None if it is not found so."""
    if action.relaxation is None or state.regularisation.flows:
        return None
    softer = state.regularisation.softened(max(float(contact.state.pressure.max()) for contact in state.contacts))
    if softer is None:
        return None
    try:
        return _equilibrium(problem, replace(state, regularisation=softer), load, guess, action)
    except ConvergenceError:
        return None


def _approached(
    problem: Problem, state: ContactEquilibrium, load: float, guess: Array, action: Action
) -> ContactEquilibrium | None:
    """The state, found through those of wider penetration tolerances; None if it is not.

    Why: on cells coarser than the patch that presses, more points touch a round body than the surface can follow; a stiff
    contact opens and closes them in turns, however short the step. Those of a softer contact are nearly the same, without turns.
    """
    if not state.regularisation.wider:
        return None
    iterations, reached = 0, state
    try:
        for regularisation in (*state.regularisation.wider, state.regularisation):
            start = replace(state, regularisation=regularisation)
            reached = _equilibrium(problem, start, load, guess, action, from_guess=iterations > 0)
            guess, iterations = reached.unknowns, iterations + reached.iterations
    except ConvergenceError:
        return None
    return replace(reached, iterations=iterations)


def _by_displacement(
    problem: Problem, state: ContactEquilibrium, load: float, guess: Array, action: Action
) -> ContactEquilibrium | None:
    """The first state under a force, found through those of displacements; None if it is not, or something presses before."""
    if action.force is None or any(contact.state.pressure.any() for contact in state.contacts):
        return None

    def moved(distance: float, unknowns: Array) -> ContactEquilibrium:
        return _equilibrium(problem, state, state.load + distance, unknowns, replace(action, force=None))

    try:
        near = state_near(action.force, action.directions, float(np.ptp(problem.body.space.nodes, axis=0).max()), moved, guess)
        if near is None:
            return None
        return _equilibrium(problem, state.expecting(near.contacts), near.load, near.unknowns, action, from_guess=True)
    except ConvergenceError:
        return None


def _from_stick(
    problem: Problem, state: ContactEquilibrium, load: float, guess: Array, action: Action
) -> ContactEquilibrium | None:
    """The first state with augmented contact, found from that in which nothing slips; None if it is not, or there is no friction.

    Why: friction holds a thin block between jaws nearly all over, so that it presses a hundred times as hard in the middle as it
    would without. On the way there from rest, points stuck and slipped by turns: blocks thinner than a tenth of their width found
    none (friction 0.3 to 1). From stick, 19 linear systems suffice where 113 had led nowhere.
    """
    friction = state.regularisation.augments and any(contact.pair.has_friction for contact in state.contacts)
    if not friction or any(contact.state.pressure.any() for contact in state.contacts):
        return None
    sticking = tuple(replace(contact, pair=replace(contact.pair, law=Stick())) for contact in state.contacts)
    try:
        stuck = _equilibrium(problem, replace(state, contacts=sticking), load, guess, action)
        reached = _equilibrium(problem, state.expecting(stuck.contacts), stuck.load, stuck.unknowns, action, from_guess=True)
    except ConvergenceError:
        return None
    return replace(reached, iterations=stuck.iterations + reached.iterations)


def _after_snap(problem: Problem, state: ContactEquilibrium, load: float, action: Action) -> ContactEquilibrium:
    """The state past the one that the body snaps to when no equilibrium is near; raises ConvergenceError if it comes to none."""
    divisible = action.relaxation is None and action.force is None
    near = min(load, state.load + SNAP_LENGTH * load) if divisible else load

    def solve(now: ContactEquilibrium, drag: Sequence[FollowerLoad]) -> ContactEquilibrium:
        dragged = replace(action, loads=[*action.loads, *drag])
        place = near if action.force is None else now.load  # which is where the rigid bodies are, as the body is at ``now``
        return _equilibrium(problem, state, place, now.unknowns, dragged, from_guess=True)

    snapped = after_snap(problem.body, state, solve)
    if near == load:
        return snapped
    beyond = _equilibrium(problem, snapped, load, snapped.unknowns, action)
    return replace(beyond, iterations=snapped.iterations + beyond.iterations)


def _begun(state: ContactEquilibrium, load: float, action: Action) -> tuple[Regularisation, tuple[PosedContact, ...]]:
    """How stiff the contact is in a step to a ``load`` in m, and the contacts with the multipliers that it begins with.

    Tissue that flows goes on with the forces that act, and those of other tissue are expected to grow as they did over the last
    step. Why: where the tissue keeps a hundred thousandth of its stiffness, forces follow the rate of the motion. What they grew
    by per distance leads Newton astray, and penetration that new multipliers let go is a motion much faster than the jaws':
    grasps of atrial tissue with friction gave up within milliseconds, or their forces went up and down.
    """
    regularisation = state.regularisation
    if isinstance(regularisation, Augmentation) and regularisation.flows and action.relaxation is not None:
        regularisation = regularisation.over_step(float(action.relaxation.scale.min()))
        return regularisation, tuple(continued(contact, regularisation) for contact in state.contacts)
    if not regularisation.augments:
        return regularisation, state.contacts
    return regularisation, tuple(expected(contact, load - state.load) for contact in state.contacts)


def _equilibrium(
    problem: Problem,
    state: ContactEquilibrium,
    load: float,
    guess: Array,
    action: Action,
    *,
    from_guess: bool = False,
) -> ContactEquilibrium:
    """The state in which each rigid body has moved by ``load`` in m along its unit vector, its penetration in tolerance.

    With a prescribed force the bodies move on from ``load`` until together they press so hard along these vectors. Newton starts
    from the contact forces of ``state``, or from those that belong to the guess.

    Raises
    ------
    ConvergenceError
        If Newton fails, or no penalty keeps the tissue out of the bodies.
    """
    regularisation, before = _begun(state, load, action)
    anticipates = regularisation.augments and not regularisation.flows
    coarse = COARSE if anticipates and any(contact.pair.has_friction for contact in before) else 0.0
    iterations, excess, overshot = 0, np.inf, False
    for attempt in range(PENALTY_ATTEMPTS if not regularisation.augments else AUGMENTATIONS):
        contacts = moved_on(before, load - state.load, action.directions, regularisation)
        try:
            solved = contact_solution(problem, guess, contacts, action, from_guess=from_guess, coarse=coarse)
        except ConvergenceError as error:
            error.solutions += iterations
            raise
        load += solved.rigid_displacement
        contacts = moved_on(before, load - state.load, action.directions, regularisation)
        iterations += solved.iterations
        if solved.iterations == 0:
            coarse *= SHARPER
        u = problem.body.space.split(solved.unknowns)[0]
        displacements = [contact.surface.points.interpolate(u) for contact in contacts]
        results = [contact.at(displacement) for contact, displacement in zip(contacts, displacements, strict=True)]
        deepest = max(float(-result.gap.min()) for result in results)
        slip = max(float(r.elastic_slip(c.state, c.pair).max()) for r, c in zip(results, contacts, strict=True))
        last, excess = excess, regularisation.excess(deepest, slip)
        overshot = overshot or excess > last
        regularisation = regularisation.seen(max(float(result.pressure.max()) for result in results))
        if excess <= 1 and not coarse:
            both = zip(contacts, displacements, state.contacts, strict=True)
            grown_contacts = tuple(grown(accepted(contact, d), start, load - state.load) for contact, d, start in both)
            kept = regularisation.after_step_from(state.regularisation)
            return ContactEquilibrium(
                load, solved.unknowns, iterations, solved.history[-1], grown_contacts, kept, solved.kinematics
            )
        coarse = 0.0 if excess <= 1 else coarse
        if regularisation.augments:
            before = tuple(augmented(old, result) for old, result in zip(before, results, strict=True))
            if overshot and attempt >= PATIENCE and excess > SHRUNK * last:
                regularisation = regularisation.stiffer()
        guess = solved.unknowns
    almost = f"the forces of contact are still those of a coarse solution after {AUGMENTATIONS} augmentations"
    raise ConvergenceError(regularisation.excess_in_words(deepest, slip) if excess > 1 else almost, solutions=iterations)
