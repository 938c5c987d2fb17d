"""A body that goes back takes the contact with it: Newton does not begin with tissue that nothing touches.

Mutant: a start from the forces at the guess whenever the residual is small, as it is beside forces of large cells at the base.
The rule itself is tried in `tests/unit/fem/test_newton.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tactsim.errors import ConvergenceError
from tactsim.experiments.indentation.course import started
from tactsim.experiments.indentation.indentation import Indentation
from tactsim.fem.equilibrium.balance import Balance, NewtonState
from tactsim.mechanics.contact.contact_equilibrium import ContactEquilibrium
from tactsim.mechanics.models.pressed_model import PressedModel

BALL = Indentation.model_validate(
    {
        "specimen": {"material": {"kind": "mooney_rivlin_2", "c10": 1.1e3, "c01": 1.4e3}, "thickness": 15e-3, "radius": 3.5e-3},
        "body": {"kind": "sphere", "radius": 1.8e-3},
        "contact": {"kind": "coulomb", "friction": 0.5},
        "stop": "displacement",
        "displacement": 0.3e-3,
        "mesh": {"growth": 1.2, "finest": 0.05e-3},
    }
)
"""Cells at the base that are a hundred times as long as those at the contact."""
DEEP = (20e-6, 0.1e-3, 0.2e-3, 0.3e-3)
"""Displacements in m."""
FEW = 5
"""Linear systems of a retreat in which nothing slips."""


@pytest.fixture(scope="module")
def pressed() -> tuple[PressedModel, ContactEquilibrium]:
    """A ball pressed into tissue."""
    model = BALL.model()
    state = started(BALL, model, BALL.specimen.materials[0].shear_modulus)
    for load in DEEP:
        state = model.equilibrium(state, load, state.unknowns)
    return model, state


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [1.2, 4.0])
def test_a_retreat_by_more_than_the_penetration_is_a_few_systems(
    pressed: tuple[PressedModel, ContactEquilibrium], tolerances: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, state = pressed
    load = state.load - tolerances * state.penetration
    assert model.equilibrium(state, load, state.unknowns).iterations <= FEW
    at: Callable[..., NewtonState] = Balance.at
    monkeypatch.setattr(Balance, "at", lambda *args: replace(at(*args), contact_force=np.inf))
    with pytest.raises(ConvergenceError, match="inside out"):
        model.equilibrium(state, load, state.unknowns)
