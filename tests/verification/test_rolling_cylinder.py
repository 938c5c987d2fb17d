"""A long cylinder of rubber between plates: pressed as its quarter is, and then rolled by the upper plate."""

from __future__ import annotations

import pytest
from mutants import assert_kills

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.results.result import Status

RADIUS, PRESSED, TRAVEL = 10e-3, 1e-3, 2e-3
WHILE_PRESSED = {"pieces": [{"kind": "ramp", "to": 1.0, "duration": 1.0}, {"kind": "hold", "duration": 1.0}]}
AFTERWARDS = {"pieces": [{"kind": "hold", "duration": 1.0}, {"kind": "ramp", "to": 1.0, "duration": 1.0}]}


def between_plates(part, contacts, asked, cells=8):
    result = BoundaryValueProblem.model_validate(
        {
            "dimension": "plane_strain",
            "geometry": {"kind": "cylinder", "radial": [{"length": RADIUS, "cells": cells}], "part": part},
            "material": {"kind": "neo_hookean", "c10": 20e3},
            "contacts": [{"face": "outer", "body": {"kind": "plane"}} | one for one in contacts],
            "asked": asked,
        }
    ).run()
    assert result.status is Status.CONVERGED, result.reason
    return {name: float(one.value) for name, one in result.quantities.items()}


def test_the_whole_is_pressed_as_its_quarter_is(one_thread, verification_record):
    """The whole has the cells of four quarters. Mutant: a quarter that is pressed by all of the approach."""
    force = {"force": {"kind": "contact_force", "component": "y"}}
    whole = between_plates("whole", [{"side": "top", "y": -PRESSED}, {"side": "bottom"}], force)["force"]

    def check(quarter):
        assert 2 * quarter == pytest.approx(whole, rel=1e-5), "the penetration allowed over the approach is 2e-5 times a half"

    quarters = [
        between_plates("quarter", [{"side": "top", "y": -approach}], force)["force"] for approach in (PRESSED / 2, PRESSED)
    ]
    check(quarters[0])
    known = {"reference": "its quarter", "kind": "invariance", "mesh": "16 x 16 cells", "tolerance": 1e-5}
    verification_record("force of a pressed cylinder", whole, 2 * quarters[0], **known)
    assert_kills(check, all_of_it=(quarters[1],))


@pytest.mark.slow
def test_a_cylinder_rolls_half_as_far_as_the_plate(one_thread, verification_record):
    """The motion is the same turned by half a turn about the middle, so that the middle follows the mean of both plates.
    Mutants: a middle that follows the plate, one that stays, and a cylinder that slips."""
    middle = {"x": {"kind": "displacement", "at": [0.0, 0.0], "component": "x"}}

    def rolled(friction):
        law = {"law": {"kind": "coulomb", "friction": friction}}
        top = {"side": "top", "y": -PRESSED, "amplitude": WHILE_PRESSED, "motions": [{"x": TRAVEL, "amplitude": AFTERWARDS}]}
        return between_plates("whole", [{"side": "bottom"} | law, top | law], middle)["x"]

    reached = rolled(1.0)

    def check(expected, reached=reached):
        assert reached == pytest.approx(expected, rel=1e-6), "of the springs that hold a body before it is touched: 1e-8"

    check(TRAVEL / 2)
    known = {"reference": "symmetry about the middle", "kind": "exact", "mesh": "16 x 16 cells", "tolerance": 1e-6}
    verification_record("travel of a rolling cylinder", reached, TRAVEL / 2, **known)
    assert_kills(check, follows=(TRAVEL,), stays=(0.0,), slips=(TRAVEL / 2, rolled(0.0)))
