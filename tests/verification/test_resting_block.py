"""A soft block that lies on a plane with friction, held by nothing else, pressed by a dead load and pushed from the side.

Reference: equilibrium. The plane bears all of the load, and of the push up to friction times that; beyond it the block slides,
and there is no equilibrium. Mutants: points that touch without a force count as open, which ended two of the three cases at once
(found from the state in which nothing slips, all three end, at three times the linear systems); a push beyond the limit.
"""

from __future__ import annotations

import pytest
from mutants import assert_kills
from small_problems import result_of

from tactsim.experiments.boundary_value import posing
from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.mechanics.contact import contact_equilibrium
from tactsim.results.result import Status

WIDTH, HEIGHT, PRESSURE, FRICTION = 20e-3, 10e-3, 2e3, 0.3
LOAD = PRESSURE * WIDTH
RAMP, HOLD = ({"kind": "ramp", "to": 1.0, "duration": 1.0}, {"kind": "hold", "duration": 1.0})
FORCES = {name: {"kind": "contact_force", "component": axis} for name, axis in (("normal", "y"), ("shear", "x"))}
CASES = [(8, 1e7), (16, 5e4), (16, 1e7)]
"""Cells along the plane and bulk modulus in Pa."""


def resting(cells: int, bulk_modulus: float, push: float = 0.0, friction: float = FRICTION) -> dict:
    """The fields of a problem in which the push from the side grows to that part of the load once the load has."""
    spans = [{"length": length, "cells": count} for length, count in ((WIDTH, cells), (HEIGHT, cells // 2))]
    pressed = {"kind": "traction", "face": "top", "y": -PRESSURE, "amplitude": {"pieces": [RAMP, HOLD]}}
    pushed = {"kind": "traction", "face": "left", "x": push * LOAD / HEIGHT, "amplitude": {"pieces": [HOLD, RAMP]}}
    plane = {"face": "bottom", "side": "bottom", "body": {"kind": "plane"}, "law": {"kind": "coulomb", "friction": friction}}
    return {
        "dimension": "plane_strain",
        "geometry": {"kind": "block"} | {axis: [span] for axis, span in zip("xy", spans, strict=True)},
        "material": {"kind": "neo_hookean", "c10": 5e3, "bulk_modulus": bulk_modulus},
        "conditions": [pressed, pushed] if push else [pressed],
        "contacts": [plane],
        "steps": 10,
        "asked": FORCES,
    }


@pytest.mark.parametrize(("cells", "bulk_modulus"), [*CASES[:2], pytest.param(*CASES[2], marks=pytest.mark.slow)])
def test_a_plane_bears_the_load_of_a_block_that_nothing_else_holds(cells, bulk_modulus, one_thread, verification_record):
    result = result_of(**resting(cells, bulk_modulus))
    normal = result.quantities["normal"].value

    def check(load):
        assert normal == pytest.approx(load, rel=1e-8)

    check(LOAD)
    known = {"reference": "equilibrium", "kind": "exact", "mesh": f"{cells} cells, bulk modulus {bulk_modulus:g} Pa"}
    verification_record("force of a block on a plane", normal, LOAD, tolerance=1e-8, **known)
    assert_kills(check, one_face_less=(LOAD * (1 - 1 / cells),))


@pytest.mark.parametrize("case", [CASES[0], pytest.param(CASES[1], marks=pytest.mark.slow)])
def test_a_block_would_not_stay_if_what_touches_counted_as_open(case, one_thread, monkeypatch):
    monkeypatch.setattr(posing, "lying_on", lambda contact: contact)
    monkeypatch.setattr(contact_equilibrium, "_from_stick", lambda *step: None)
    assert BoundaryValueProblem.model_validate(resting(*case)).run().status is Status.FAILED


@pytest.mark.parametrize("cells", [8, pytest.param(16, marks=pytest.mark.slow)])
def test_friction_bears_a_push_up_to_its_limit(cells, one_thread, verification_record):
    """Balance holds on any mesh."""
    push = 0.97 * FRICTION
    shear = -result_of(**resting(cells, 2e5, push)).quantities["shear"].value
    assert shear == pytest.approx(push * LOAD, rel=1e-6)
    known = {"reference": "equilibrium", "kind": "exact", "mesh": f"{cells} cells", "tolerance": 1e-6}
    verification_record("push on a block", shear, push * LOAD, **known)
    beyond = resting(cells, 2e5, 1.03 * FRICTION)
    assert BoundaryValueProblem.model_validate(beyond).run().status is Status.FAILED, "it slides away"
