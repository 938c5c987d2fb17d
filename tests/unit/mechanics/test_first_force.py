"""The first state under a force, found through displacements: few of them, and the forces found there are the first guess."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from tactsim.array import Array
from tactsim.errors import ConvergenceError
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.mechanics.contact import contact_equilibrium
from tactsim.mechanics.contact.first_force import ATTEMPTS, FIRST, NEAR, state_near
from tactsim.results.result import Status


def found(force: float, pressing: Callable[[float], float]) -> tuple[float | None, list[float]]:
    """The displacement that is found for a body of 1 m, and those that were tried; NaN stands for no state."""
    tried = []

    def moved(displacement: float, guess: Array) -> SimpleNamespace:
        tried.append(displacement)
        pressed = pressing(displacement)
        if np.isnan(pressed):
            raise ConvergenceError("no state", [])
        surface = SimpleNamespace(total=lambda traction: traction)
        contact = SimpleNamespace(surface=surface, state=SimpleNamespace(traction=np.array([pressed])))
        return SimpleNamespace(load=displacement, unknowns=guess, contacts=(contact,))

    near = state_near(force, [np.ones(1)], 1.0, moved, np.zeros(3))
    return (None if near is None else near.load), tried


@pytest.mark.parametrize("power", [0.5, 1.0, 1.5, 2.0, 3.0, 5.0])
@pytest.mark.parametrize("wanted", [0.2 * FIRST, 3 * FIRST, 30 * FIRST])
def test_a_few_displacements_suffice_whatever_the_force_grows_like(power: float, wanted: float):
    place, tried = found(wanted**power, lambda displacement: displacement**power)
    assert place is not None
    assert abs((place / wanted) ** power - 1) <= NEAR
    assert len(tried) <= 8


def test_gaps_and_displacements_without_a_state_are_passed():
    def pressing(displacement: float) -> float:
        if displacement < 3 * FIRST:
            return 0.0
        return np.nan if displacement > 11 * FIRST else displacement - 3 * FIRST

    place, tried = found(7.5 * FIRST, pressing)
    assert place is not None
    assert max(tried) < 22 * FIRST, "what fails beyond a state that presses is no reason to go on"


def test_a_force_that_nothing_gives_is_not_found():
    place, tried = found(1.0, lambda _: 0.5)
    assert place is None
    assert len(tried) == ATTEMPTS


def leaning(cells: tuple[int, int, int]) -> Grasp:
    """Jaws that lean away from each other by four degrees, so that the block is held at one side first."""
    return Grasp.model_validate(
        {
            "block": {"size": (30e-3, 24e-3, 14e-3), "tissue": "icf_stable"},
            "upper": {"tilt_x": np.radians(2.0)},
            "lower": {"tilt_x": np.radians(-2.0)},
            "matrix": {"rows": 2, "columns": 2, "pitch": 8e-3, "size": 7e-3},
            "contact": {"kind": "coulomb", "friction": 0.4},
            "mesh": {"kind": "structured", "cells": cells},
            "loading": {"control": "force", "pieces": [{"kind": "ramp", "to": 0.5, "duration": 1.0}]},
            "time": {"steps": 1},
        }
    )


@pytest.mark.parametrize(("cells", "systems"), [((4, 3, 2), 13), pytest.param((4, 4, 3), 14, marks=pytest.mark.slow)])
def test_forces_found_under_a_displacement_are_those_that_a_force_begins_with(cells: tuple[int, int, int], systems: int):
    """10 systems, and 8 on finer cells; two thirds of those without these forces are allowed."""
    usual = leaning(cells).run()
    assert usual.status is Status.CONVERGED
    assert usual.steps[0].newton_iterations <= systems


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "systems"), [((4, 3, 2), 13), ((4, 4, 3), 14)])
def test_a_force_that_begins_without_them_takes_more(cells: tuple[int, int, int], systems: int, monkeypatch: pytest.MonkeyPatch):
    """The mutant of the test above: 19 and 21 systems."""
    monkeypatch.setattr(contact_equilibrium, "expected", lambda contact, distance: contact)
    assert leaning(cells).run().steps[0].newton_iterations > systems
