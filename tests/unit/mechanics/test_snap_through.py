"""Where no equilibrium is near, the body is followed to the next one."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tactsim.errors import ConvergenceError
from tactsim.experiments.indentation import graded_section
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.fem.equilibrium import newton
from tactsim.mechanics.contact import contact_equilibrium
from tactsim.results.result import Status

PUNCH = {
    "specimen": {"material": {"kind": "neo_hookean", "c10": 1668.0}, "thickness": 6.154e-3, "radius": 14.73e-3},
    "body": {"kind": "punch", "radius": 4.96e-3, "fillet": 0.3722e-3},
    "contact": {"kind": "coulomb", "friction": 0.0},
    "displacement": 1.141e-3,
    "mesh": {"growth": 0.6, "finest": 0.1984e-3},
    "stop": "displacement",
}
"""Two elements on the fillet: near 1.12 mm one point of it opens and closes by turns, whatever the step, in plain Newton."""


@pytest.fixture
def deep_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mesh on which these points were met: with small elements beneath the fillets too."""
    section = IndentationSetup.section
    monkeypatch.setattr(IndentationSetup, "section", lambda self: replace(section(self), deep=True))
    monkeypatch.setattr(graded_section, "PEAK_ELEMENTS", 12)


@pytest.fixture
def plain_newton(monkeypatch: pytest.MonkeyPatch) -> None:
    """No step with an old factor, none from the forces that hold at the guess, none halved: each passes this point by luck."""
    monkeypatch.setattr(newton, "NEAR", 0.0)
    monkeypatch.setattr(newton, "CONTRACTION", 0.0)
    monkeypatch.setattr(newton, "LARGEST_GROWTH", np.inf)


@pytest.mark.usefixtures("deep_cells", "plain_newton")
@pytest.mark.parametrize("displacement", [1.1235e-3, pytest.param(PUNCH["displacement"], marks=pytest.mark.slow)])
def test_a_punch_goes_on_past_a_point_that_opens_and_closes(displacement: float) -> None:
    result = Indentation.model_validate(PUNCH | {"displacement": displacement}).run()
    assert result.status is Status.CONVERGED
    forces = [step.values["reaction_force"] for step in result.steps]
    assert forces == sorted(forces)


@pytest.mark.slow
@pytest.mark.usefixtures("deep_cells", "plain_newton")
@pytest.mark.parametrize("displacement", [1.1235e-3, PUNCH["displacement"]])
def test_without_the_drag_it_would_not(monkeypatch: pytest.MonkeyPatch, displacement: float) -> None:
    monkeypatch.setattr(contact_equilibrium, "SNAP_STEP", 0.0)
    assert Indentation.model_validate(PUNCH | {"displacement": displacement}).run().status is Status.FAILED


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
    action = contact_equilibrium.Action(directions=(), force=force, relaxation=None if force else object())
    contact_equilibrium._after_snap(problem, state, 1e-3, action)
    expected = 1e-3 + 1e-6 * np.arange(len(began)) * (force is not None)
    assert len(began) > 1
    np.testing.assert_allclose(began, expected, rtol=1e-12)


DEEP = {
    "specimen": {"material": {"kind": "neo_hookean", "c10": 2936.0}, "thickness": 17.98e-3, "radius": 10.16e-3},
    "body": {"kind": "annulus", "inner_radius": 1.338e-3, "outer_radius": 3.523e-3, "fillet": 0.3376e-3},
    "contact": {"kind": "coulomb", "friction": 0.0},
    "displacement": 3.675e-3,
    "mesh": {"growth": 0.6, "finest": 0.1409e-3},
    "recess": 0.4873e-3,
    "stop": "displacement",
}
"""A random case in which a point of the outer edge opens at 3.43 mm."""


@pytest.mark.slow
@pytest.mark.usefixtures("deep_cells")
def test_a_snap_under_a_whole_step_crushes_what_the_drag_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Indentation.model_validate(DEEP).run().status is Status.CONVERGED
    monkeypatch.setattr(contact_equilibrium, "SNAP_LENGTH", contact_equilibrium.SNAP_STEP)
    assert Indentation.model_validate(DEEP).run().status is Status.FAILED
