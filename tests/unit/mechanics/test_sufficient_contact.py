"""A grasp's own tolerance is never refused by the check of what penetration takes away: the last state is solved again."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from tactsim.experiments.grasp import path, regularisation, setup
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.outcome import sufficient_contact
from tactsim.mechanics.outcome.success import LARGEST_FORCE_ERROR
from tactsim.results.result import Result, Status


@pytest.fixture
def coarse_default(monkeypatch: pytest.MonkeyPatch) -> None:
    """A default tolerance with which the example misses more of its force than a success may."""
    monkeypatch.setattr(setup, "PENETRATION", 5e-3)
    monkeypatch.setattr(setup, "PENETRATION_OF_CLOSING", 0.1)
    monkeypatch.setattr(regularisation, "SOFTNESS_OF_HEIGHT", 0.05)  # or the contact would be stiffer than its tolerance asks


def force(result: Result) -> float:
    return float(result.quantities["reaction_force"].value)


def test_the_last_state_is_solved_again_until_penetration_takes_away_little(
    coarse_default: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(path, "SufficientContact", lambda problem, *_: problem)
        refused = Grasp.example().run()
    assert refused.status is Status.FAILED
    assert refused.reason.startswith("penetration takes away")
    tightened = Grasp.example().run()
    assert tightened.status is Status.CONVERGED
    assert tightened.quantities["penetration_force_error"].value <= LARGEST_FORCE_ERROR
    assert any("at the end, for the error of the force" in line for line in tightened.assumptions)
    monkeypatch.undo()
    exact = Grasp.example().run()
    assert abs(force(tightened) / force(exact) - 1) <= LARGEST_FORCE_ERROR  # what the estimate bounds
    assert abs(force(refused) / force(exact) - 1) > LARGEST_FORCE_ERROR


def test_a_tolerance_that_was_asked_for_stays(coarse_default: None) -> None:
    example = Grasp.example()
    asked = example.model_copy(update={"penetration_tolerance": example.tolerance})
    assert asked.run().status is Status.FAILED


def pressing(force: float) -> ContactEquilibrium:
    """A state under a force in N of which penetration takes away 2 %, and which took three linear systems."""
    pressure, weights = np.array([force]), np.ones(1)
    state = SimpleNamespace(pressure=pressure, tangential=np.zeros((1, 1)), traction=pressure[None], points=None, creep=0.0)
    pair = SimpleNamespace(body=SimpleNamespace(signed_distance=lambda _points: (np.array([-0.02]),)))
    surface = SimpleNamespace(points=SimpleNamespace(weights=weights), total=lambda traction: traction @ weights)
    contact = SimpleNamespace(state=state, pair=pair, surface=surface, growth=None)
    return ContactEquilibrium(1.0, np.zeros(1), 3, 0.0, (contact,), None, None)  # type: ignore[arg-type]


def test_a_step_that_was_taken_back_is_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its force may be larger than any of the run; beside it what penetration takes away would look small."""
    monkeypatch.setattr(sufficient_contact, "_tightened", lambda now, reached, error: now)
    monkeypatch.setattr(sufficient_contact, "MOST_TIGHTENINGS", 1)
    start, taken_back, loose, tight = map(pressing, (1.0, 100.0, 2.0, 2.0))
    reached = iter((taken_back, taken_back, loose, tight))
    inner = SimpleNamespace(body=None, equilibrium=lambda *_: next(reached))
    problem = sufficient_contact.SufficientContact(inner, 1.0)
    assert problem.equilibrium(start, (1.0,), np.zeros(1), None).contacts is taken_back.contacts
    assert problem.equilibrium(start, (1.0,), np.zeros(1), None).contacts is tight.contacts


def test_what_was_reached_from_another_state_is_no_part_of_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that goes back to an earlier state, even after others were accepted, knows the forces on the way to it alone."""
    monkeypatch.setattr(sufficient_contact, "_tightened", lambda now, reached, error: now)
    monkeypatch.setattr(sufficient_contact, "MOST_TIGHTENINGS", 1)
    start, hard, beyond, loose, tight = map(pressing, (1.0, 100.0, 100.0, 2.0, 2.0))
    reached = iter((hard, hard, beyond, beyond, loose, tight))
    problem = sufficient_contact.SufficientContact(SimpleNamespace(body=None, equilibrium=lambda *_: next(reached)), 1.0)
    accepted = problem.equilibrium(start, (1.0,), np.zeros(1), None)
    problem.equilibrium(accepted, (1.0,), np.zeros(1), None)
    assert problem.equilibrium(start, (1.0,), np.zeros(1), None).contacts is tight.contacts
