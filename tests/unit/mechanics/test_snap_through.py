"""Where no equilibrium is near, the body is followed to the next one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tactsim.errors import ConvergenceError
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.mechanics.contact import contact_equilibrium
from tactsim.mechanics.contact.contact_solution import Action
from tactsim.results.result import Status

CASE = {"contact": {"kind": "coulomb", "friction": 0.0}, "stop": "displacement"}
PUNCH = CASE | {
    "specimen": {"material": {"kind": "mooney_rivlin_2", "c10": 337.3, "c01": 46.46}, "thickness": 13.1e-3, "radius": 12.14e-3},
    "body": {"kind": "punch", "radius": 3.334e-3, "fillet": 0.2849e-3},
    "displacement": 2.784e-3,
    "mesh": {"growth": 0.6, "finest": 0.1334e-3},
}
"""A random case in which one point of the fillet opens and closes by turns on the way, whatever the step."""
DEEP = CASE | {
    "specimen": {"material": {"kind": "mooney_rivlin_2", "c10": 210.1, "c01": 324.2}, "thickness": 17.32e-3, "radius": 10.98e-3},
    "body": {"kind": "annulus", "inner_radius": 1.013e-3, "outer_radius": 3.099e-3, "fillet": 0.1853e-3},
    "displacement": 3.463e-3,
    "mesh": {"growth": 0.6, "finest": 0.124e-3},
    "recess": 0.9243e-3,
}
STIFFER = CASE | {
    "specimen": {
        "material": {"kind": "mooney_rivlin_2", "c10": 1.942e4, "c01": 3.837e4, "bulk_modulus": 3.014e7},
        "thickness": 18.44e-3,
        "radius": 7.207e-3,
    },
    "body": {"kind": "annulus", "inner_radius": 1.479e-3, "outer_radius": 2.127e-3, "fillet": 0.1274e-3},
    "displacement": 3.677e-3,
    "mesh": {"growth": 0.6, "finest": 0.08507e-3},
    "recess": 0.2339e-3,
}
"""Random cases of 48 and of 52 steps that are followed past several such points: at 2.891 and 3.523 mm first."""


def test_a_punch_goes_on_past_a_point_that_opens_and_closes() -> None:
    result = Indentation.model_validate(PUNCH).run()
    assert result.status is Status.CONVERGED
    forces = [step.values["reaction_force"] for step in result.steps]
    assert forces == sorted(forces)


@pytest.mark.slow
@pytest.mark.parametrize("case", [DEEP, STIFFER])
def test_without_the_drag_it_would_not(case: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    assert Indentation.model_validate(case).run().status is Status.CONVERGED
    monkeypatch.setattr(contact_equilibrium, "SNAP_STEP", 0.0)
    assert Indentation.model_validate(case).run().status is Status.FAILED


def test_what_never_comes_to_rest_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def stuck(*_: object, **__: object) -> None:
        raise ConvergenceError("stuck", solutions=2)

    body = Indentation.example().model().body
    with pytest.raises(ConvergenceError, match="no equilibrium after a snap") as caught:
        contact_equilibrium.after_snap(body, SimpleNamespace(unknowns=np.zeros(body.space.size)), stuck)
    assert caught.value.solutions > 0


@pytest.mark.parametrize("force", [None, 1.0])
def test_under_a_force_each_step_starts_from_where_the_last_left_the_rigid_body(
    force: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body displaced by the last step, under a rigid body that has not followed, would be pressed by a force from nowhere."""
    body, began = Indentation.example().model().body, []

    def creeping(problem: object, state: object, load: float, *_: object, **__: object) -> SimpleNamespace:
        began.append(load)
        return SimpleNamespace(load=load + 1e-6, unknowns=np.zeros(body.space.size), iterations=1)

    monkeypatch.setattr(contact_equilibrium, "_equilibrium", creeping)
    problem, state = SimpleNamespace(body=body), SimpleNamespace(load=1e-3, unknowns=np.zeros(body.space.size))
    action = Action(directions=(), force=force, relaxation=None if force else object())
    contact_equilibrium._after_snap(problem, state, 1e-3, action)
    expected = 1e-3 + 1e-6 * np.arange(len(began)) * (force is not None)
    assert len(began) > 1
    np.testing.assert_allclose(began, expected, rtol=1e-12)


@pytest.mark.slow
def test_a_snap_under_a_whole_step_crushes_what_the_drag_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_equilibrium, "SNAP_LENGTH", contact_equilibrium.SNAP_STEP)
    assert Indentation.model_validate(DEEP).run().status is Status.FAILED
