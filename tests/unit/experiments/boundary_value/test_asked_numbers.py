"""What is asked of a solution: energies that balance the work, stresses about an axis that turn with the body."""

from __future__ import annotations

from math import pi

import pytest
from principal_ogden import PrincipalOgden
from small_problems import CUBE, PLANES, ROD, SIDE, asked, number, result_of

from tactsim.errors import InputError
from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.mechanics.outcome.success import LARGEST_FORCE_ERROR
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")


def test_the_energy_of_a_nearly_incompressible_pad_is_the_work_done_on_it():
    pad = {
        "kind": "cylinder",
        "radial": [{"length": SIDE, "cells": 8, "ratio": 0.2}],
        "axial": [{"length": SIDE / 10, "cells": 2}],
    }
    pressed, force = 1e-5 * SIDE, {"kind": "force", "face": "top", "component": "z"}
    fields = {
        "dimension": "axisymmetric",
        "geometry": pad,
        "material": {"kind": "linear_elastic", "youngs_modulus": 3e3, "poisson_ratio": 0.49995},  # K / G = 1e4
        "conditions": [{"kind": "clamped", "face": "bottom"}, {"kind": "displacement", "face": "top", "r": 0.0, "z": -pressed}],
        "asked": asked("energy") | {"force": force},
        "steps": 1,
    }
    found = result_of(**fields).quantities
    # Clapeyron: exact of a linear law on any mesh; K / 2 tr(eps)^2 at each point would be 16 times as much on this one.
    assert found["number"].value == pytest.approx(-found["force"].value * pressed / 2, rel=1e-8)


@pytest.mark.parametrize(("constants", "share"), [("instantaneous", 0.4), ("equilibrium", 1.0)])
def test_the_energy_of_a_relaxing_body_is_what_lasts(constants, share):
    relaxation = {"fractions": [0.6], "times": [1.0], "constants": constants}
    pulled, stretch = {"kind": "displacement", "face": "top", "z": 0.3 * SIDE}, 1.3
    material = {"kind": "neo_hookean", "c10": 1e3, "relaxation": relaxation}
    energy = number(geometry=CUBE, material=material, conditions=[*PLANES, pulled], asked=asked("energy"))
    assert energy == pytest.approx(share * 1e3 * (stretch**2 + 2 / stretch - 3) * SIDE**3, rel=1e-7)


def test_stresses_about_the_axis_turn_with_the_body():
    tube = {**ROD, "inner_radius": SIDE / 2, "part": "whole", "around": 2}
    planes = [{"kind": "displacement", "face": face, "z": 0.0} for face in ("bottom", "top")]
    place = (1.0 * SIDE, 0.0, SIDE / 2)
    question = {name: {"kind": "stress", "at": place, "component": name} for name in ("radial", "hoop")}

    def stresses(turn):
        angles = (("inner", 0.2 + turn), ("outer", turn))
        turned = [{"kind": "rotation", "face": face, "angle": angle, "axial": "free"} for face, angle in angles]
        material = {"kind": "neo_hookean", "c10": 1e3, "bulk_modulus": 1e5}
        result = result_of(geometry=tube, material=material, conditions=[*planes, *turned], asked=question)
        return [float(result.quantities[name].value) for name in question]

    still = stresses(0.0)
    assert still[1] - still[0] > 10.0  # equal ones would turn into each other unseen
    assert stresses(pi / 2) == pytest.approx(still, rel=1e-6)  # an invariance but for Newton's tolerance


def test_no_energy_is_asked_of_a_law_that_has_none():
    law = PrincipalOgden(modulus=1e3, alpha=2.0)
    with pytest.raises(InputError, match="the material principal_ogden gives no energy; write its method"):
        BoundaryValueProblem(dimension="3d", geometry=CUBE, material=law, conditions=PLANES, asked=asked("energy"))


def test_a_number_of_an_early_time_is_held_to_what_penetration_may_take_away():
    """Under a ball it takes away most where least is pressed."""
    ball = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": SIDE}, "z": -SIDE / 4}
    cylinder = {
        "kind": "cylinder",
        "radial": [{"length": SIDE, "cells": 16, "ratio": 3.0}],
        "axial": [{"length": SIDE, "cells": 10}],
    }
    force = {"kind": "contact_force", "component": "z"}
    fields = {
        "dimension": "axisymmetric",
        "geometry": cylinder,
        "material": {"kind": "neo_hookean", "c10": 1e3},
        "conditions": [{"kind": "clamped", "face": "bottom"}],
        "contacts": [ball],
        "penetration_tolerance": 1.25e-3 * SIDE,
    }
    at_the_end = BoundaryValueProblem.model_validate({**fields, "asked": {"force": force}}).run()
    assert at_the_end.status is Status.CONVERGED
    assert at_the_end.steps[0].values["penetration_force_error"] > LARGEST_FORCE_ERROR
    early = BoundaryValueProblem.model_validate({**fields, "asked": {"force": {**force, "time": 0.1}}}).run()
    assert early.status is Status.FAILED
    assert early.reason.startswith("penetration takes away")
    assert early.reason.endswith("at a time of 100 ms")
