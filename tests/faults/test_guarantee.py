"""What every accepted state with contact is held to, and that no state which breaks it is accepted.

Mutants: a state with a wrong number, a turned element, a penetrated or pulling body, friction outside of its cone, volume or
forces out of balance.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import tactsim
from tactsim.contact.coulomb import Coulomb
from tactsim.contact.jaw import Jaw
from tactsim.contact.penalty import Augmentation
from tactsim.errors import ConvergenceError
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.contact import contact_equilibrium, guarantee
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.mechanics.contact.contact_steps import accepted
from tactsim.mechanics.contact.guarantee import check_accepted
from tactsim.mechanics.models.block_model import GraspModel
from tactsim.mechanics.models.first_guess import FIRST_PART
from tactsim.mesh.structured_block import structured_block

pytestmark = pytest.mark.usefixtures("one_thread")
SIZE, CLOSING = (20e-3, 20e-3, 10e-3), 0.3e-3


@cache
def grasp():
    """A block, nearly incompressible, between two jaws, and its state once they have closed."""
    block = structured_block(SIZE, (2, 2, 2), ())
    jaws = [Jaw(width=40e-3, depth=40e-3, fillet=1e-3, side=side) for side in JAWS]
    material = NeoHookean(c10=1000.0, bulk_modulus=2e6)
    model = GraspModel(block.mesh, [material], block.facets, jaws=jaws, offsets=np.full((2, 2), 10e-3))
    start = model.start(Coulomb(friction=0.4), Augmentation(1e-6, softest=4e3, switch_length=5e-3, softness=1e-5))
    half = model.equilibrium(start, CLOSING / 2, model.compressed(FIRST_PART * CLOSING / 2))
    return model, start, model.equilibrium(half, CLOSING, half.unknowns)


def held(state):
    model, _, _ = grasp()
    check_accepted(model.problem, state, Action((), loads=[model.springs]))


def with_forces(state, **changes):
    """The state with the forces on its first body changed, each by a function of what the body's contact recorded."""
    first = state.contacts[0]
    recorded = replace(first.state, **{name: change(first.state) for name, change in changes.items()})
    return replace(state, contacts=(replace(first, state=recorded), *state.contacts[1:]))


def with_unknowns(state, change):
    """The state with other displacements (n, 3) and pressures (m,) of its nodes, changed in place."""
    model, _, _ = grasp()
    unknowns = state.unknowns.copy()
    change(*model.space.split(unknowns))
    return replace(state, unknowns=unknowns)


def raised(state, distance):
    """The state with its first body moved on by a distance in m."""
    first = state.contacts[0]
    return replace(state, contacts=(replace(first, place=first.place - [0, 0, distance]), *state.contacts[1:]))


def turned_inside_out(u, p):
    model, _, _ = grasp()
    corner = int(model.mesh.elements[0, 0])
    others = model.mesh.nodes[model.mesh.elements[0, 1:4]].mean(axis=0)
    u[corner] += 2.5 * (others - model.mesh.nodes[corner])


def swollen(u, p):
    """All nodes a thousandth farther from the middle, the faces where they were."""
    model, _, _ = grasp()
    u[:, :2] += 1e-3 * (model.mesh.nodes[:, :2] - 10e-3)


def pushed(tangential, normals, size):
    along = np.cross(normals.T, [1.0, 0.0, 0.0]).T
    return tangential + size * along


def test_a_state_of_the_solver_keeps_it():
    held(grasp()[2])


MUTANTS = {
    "unknowns that are no numbers": (lambda s: with_unknowns(s, lambda u, p: p.__setitem__(0, np.nan)), "unknowns are no finite"),
    "a force that is no number": (
        lambda s: with_forces(s, pressure=lambda c: np.where(c.pressure > 0, np.inf, 0.0)),
        "contact forces are no finite",
    ),
    "an element inside out": (lambda s: with_unknowns(s, turned_inside_out), "element 0 at .*volume ratio -.*; allowed: above 0"),
    "a penetrated body": (lambda s: raised(s, 5e-6), r"rigid body 1 is penetrated by 5\..* µm; allowed: 1 µm"),
    "pressure across a gap": (lambda s: raised(s, -20e-6), "rigid body 1 presses across a gap of .* µm; allowed: 7.6"),
    "a body that pulls": (
        lambda s: with_forces(s, pressure=lambda c: np.where(c.pressure == 0, -1.0, c.pressure)),
        "rigid body 1 pulls with 1 Pa",
    ),
    "friction outside of its cone": (
        lambda s: with_forces(s, tangential=lambda c: np.where(c.pressure > 0, pushed(c.tangential, c.normals, 1e3), 0.0)),
        "friction of .* on rigid body 1 where the contact law allows",
    ),
    "friction a thousandth outside of its cone": (
        lambda s: with_forces(s, tangential=lambda c: 0.4004 * c.pressure * np.cross(c.normals.T, [1.0, 0.0, 0.0]).T),
        "friction of .* on rigid body 1 where the contact law allows",
    ),
    "friction without pressure": (
        lambda s: with_forces(
            s, tangential=lambda c: np.where(c.pressure > 0, c.tangential, pushed(c.tangential, c.normals, 1.0))
        ),
        "friction of 1 Pa on rigid body 1 where the contact law allows 0 Pa",
    ),
    "friction across the surface": (
        lambda s: with_forces(s, tangential=lambda c: 0.5 * c.tangential + 1e-3 * c.pressure * c.normals),
        "across its surface",
    ),
    "another volume": (lambda s: with_unknowns(s, swollen), "its volume differs by"),
    "forces out of balance": (
        lambda s: with_forces(s, pressure=lambda c: c.pressure * (1 - 1e-6), tangential=lambda c: c.tangential * (1 - 1e-6)),
        "out of balance, a residual of",
    ),
    "another pressure of the tissue": (
        lambda s: with_unknowns(s, lambda u, p: p.__imul__(1 + 1e-6)),
        "its volume differs by|out of balance",
    ),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_a_state_that_breaks_it_is_refused_with_what_is_broken(name):
    change, words = MUTANTS[name]
    with pytest.raises(ConvergenceError, match=f"breaks what every accepted state is held to: .*({words})"):
        held(change(grasp()[2]))


def test_a_step_that_ends_in_such_a_state_is_no_step(monkeypatch):
    """A solver that records half of the friction that it balanced is not believed."""

    def halved(contact, displacement):
        after = accepted(contact, displacement)
        return replace(after, state=replace(after.state, tangential=0.5 * after.state.tangential))

    model, start, _ = grasp()
    monkeypatch.setattr(contact_equilibrium, "accepted", halved)
    with pytest.raises(ConvergenceError, match="out of balance") as refused:
        model.equilibrium(start, CLOSING, model.compressed(FIRST_PART * CLOSING))
    assert refused.value.solutions > 0, "the work counts for the headway of the path"


def test_no_model_takes_its_states_from_elsewhere():
    """The solver of contact is called in one place, which checks what it returns."""
    root = Path(tactsim.__file__).parent
    callers = {path.name for path in root.rglob("*.py") if " contact_equilibrium(" in path.read_text(encoding="utf-8")}
    assert callers == {"contact_equilibrium.py", Path(guarantee.__file__).name}
