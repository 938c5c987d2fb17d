"""Contact with friction of tissue that relaxes to almost nothing at once, whose forces follow the rate of the closing."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.indentation import course
from tactsim.experiments.indentation.timed_indentation import TimedIndentation
from tactsim.fem.equilibrium import newton
from tactsim.materials import viscoelasticity
from tactsim.results import Result
from tactsim.results.result import Status

EVEN = 1e-3
"""How much of the largest force may be lost from one state to the next under an even ramp: the tolerance in time is 5e-3."""
FINER = 1e-2
"""Difference allowed of a force from that of a finer tolerance in time: twice the default one."""


def grasped(friction: float, **more: Any) -> Result:
    """Atrial tissue on few cells, closed by 0.5 mm by each jaw in a second."""
    return Grasp.model_validate(
        {
            "block": {"size": (30e-3, 30e-3, 15e-3), "tissue": "atrial"},
            "matrix": {"rows": 3, "columns": 3, "pitch": 8e-3, "size": 7e-3},
            "contact": {"kind": "coulomb", "friction": friction},
            "mesh": {"kind": "structured", "cells": [3, 3, 2]},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 0.5e-3, "duration": 1.0}]},
            **more,
        }
    ).run()


def forces_of(result: Result) -> list[float]:
    """The closing force in N at each state."""
    return [step.values["reaction_force"] for step in result.steps]


@pytest.mark.parametrize("friction", [pytest.param(0.3, marks=pytest.mark.slow), 1.0])
def test_forces_rise_evenly(friction: float) -> None:
    result = grasped(friction)
    assert result.status is Status.CONVERGED
    forces = forces_of(result)
    assert all(later > before - EVEN * forces[-1] for before, later in pairwise(forces))
    finer = grasped(friction, time={"tolerance": 1e-3})
    assert finer.status is Status.CONVERGED
    np.testing.assert_allclose(forces[-1], forces_of(finer)[-1], rtol=FINER)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_forces_expected_to_grow_as_they_did_per_distance_end_the_grasp(friction: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutant of the test above."""
    monkeypatch.setattr(viscoelasticity, "FLOWING", 0.0)
    assert grasped(friction).status is Status.FAILED


ANNULUS = {
    "specimen": {"material": "atrial", "thickness": 6.711e-3, "radius": 17.56e-3},
    "body": {"kind": "annulus", "inner_radius": 2.515e-3, "outer_radius": 4.473e-3, "fillet": 0.2831e-3},
    "contact": {"kind": "coulomb", "friction": 0.385},
    "mesh": {"growth": 0.6, "finest": 0.1789e-3},
    "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 0.3705e-3, "duration": 2.66}]},
}
"""A random case whose friction meets further points of the surface all the time."""


@pytest.mark.slow
def test_an_annulus_that_sinks_into_it_meets_further_points_without_jolts(monkeypatch: pytest.MonkeyPatch) -> None:
    """527 linear systems with a contact that begins softer than the tissue is at once, 1216 with one as stiff."""
    systems, solve = [0], newton._Solution._linear_step

    def counted(*args: Any) -> Any:
        systems[0] += 1
        return solve(*args)

    monkeypatch.setattr(newton._Solution, "_linear_step", counted)
    result = TimedIndentation.model_validate(ANNULUS).run()
    assert result.status is Status.CONVERGED
    forces = forces_of(result)
    assert all(later > before - EVEN * forces[-1] for before, later in pairwise(forces))
    soft, systems[0] = systems[0], 0
    monkeypatch.setattr(course, "AT_FIRST", 1.0)
    assert TimedIndentation.model_validate(ANNULUS).run().status is Status.CONVERGED
    assert 1.5 * soft < systems[0]
