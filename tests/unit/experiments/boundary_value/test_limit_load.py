"""Loads beyond the largest that an equilibrium bears: the run ends below it and says so, not on the other side of the axis."""

from __future__ import annotations

import numpy as np
import pytest
from small_problems import RUBBER, SIDE, SQUARE, asked

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.fem.assembly.body import Body
from tactsim.fem.equilibrium import newton
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")
C10, INNER, OUTER = 40e3, 10e-3, 11e-3


def sphere_pressure(stretch: float) -> float:
    """Pressure in Pa that inflates the neo-Hookean hollow sphere to a stretch of its bore.

    Source: Ogden 1997, Non-Linear Elastic Deformations, section 5.3.2, integrated: W'(l) / (l^3 - 1) is 4 c10 (l^-2 + l^-5).
    """

    def primitive(x: float) -> float:
        return -4 * C10 * (1 / x + 1 / (4 * x**4))

    outer = (1 + (INNER / OUTER) ** 3 * (stretch**3 - 1)) ** (1 / 3)
    return primitive(stretch) - primitive(outer)


LIMIT = max(sphere_pressure(stretch) for stretch in np.linspace(1.3, 1.6, 301))


def inflated(pressure: float, **fields):
    shell = {"kind": "ball", "inner_radius": INNER, "radial": [{"length": OUTER - INNER, "cells": 2}], "around": 8}
    problem = {
        "dimension": "axisymmetric",
        "geometry": shell,
        "material": {"kind": "neo_hookean", "c10": C10},
        "conditions": [{"kind": "pressure", "face": "inner", "pressure": pressure}],
        "asked": asked("displacement", at=(INNER, 0.0), component="r"),
    }
    return BoundaryValueProblem.model_validate(problem | fields).run()


def stretch_of(result) -> float:
    return 1 + float(result.quantities["number"].value) / INNER


def test_below_its_limit_the_sphere_follows_the_closed_form():
    result = inflated(0.95 * LIMIT)
    assert result.status is Status.CONVERGED
    assert sphere_pressure(stretch_of(result)) == pytest.approx(0.95 * LIMIT, rel=1e-4)  # two elements across the wall


@pytest.mark.parametrize(("share", "steps"), [(1.2, 10), pytest.param(2.0, 10, marks=pytest.mark.slow), (1.2, 1), (20.0, 10)])
def test_beyond_its_limit_it_ends_below_it_and_says_so(share, steps):
    result = inflated(share * LIMIT, steps=steps)
    assert result.status is Status.FAILED
    assert "limit load" in result.reason
    reached = result.steps[-1].values["time"] * share
    assert 0.8 < reached < 1.001
    assert 1.2 < stretch_of(result) < 1.43


def test_without_the_look_at_the_axis_it_passes_it(monkeypatch):
    monkeypatch.setattr(Body, "oriented_volume_ratio", lambda _body, state: state.J)
    monkeypatch.setattr(newton, "LARGEST_GROWTH", np.inf)  # which keeps it from there as well
    result = inflated(1.2 * LIMIT)
    assert result.status is Status.CONVERGED
    assert stretch_of(result) < 0


def test_what_fails_for_another_reason_is_at_no_limit_load():
    pressed = [{"kind": "displacement", "face": "left", "x": 0.0}, {"kind": "clamped", "face": "bottom"}]
    crushed = {"kind": "pressure", "face": "top", "pressure": 1e6, "follows": False}
    fields = {"dimension": "plane_strain", "geometry": SQUARE, "material": RUBBER, "asked": asked("volume")}
    result = BoundaryValueProblem.model_validate({**fields, "conditions": [*pressed, crushed]}).run()
    assert result.status is Status.FAILED
    assert "limit load" not in result.reason


def blown_up(steps, thickness):
    sheet = {
        "kind": "cylinder",
        "radial": [{"length": SIDE, "cells": 12, "ratio": 0.3}],
        "axial": [{"length": thickness, "cells": 1}],
    }
    return BoundaryValueProblem(
        dimension="axisymmetric",
        geometry=sheet,
        material=RUBBER,
        conditions=[{"kind": "clamped", "face": "outer"}, {"kind": "pressure", "face": "bottom", "pressure": 1.6}],
        asked=asked("displacement", at=(0.0, thickness), component="z"),
        steps=steps,
    ).run()


def test_a_sheet_that_is_limp_while_flat_is_blown_up_at_once_as_in_many_steps(monkeypatch):
    once, slowly = (blown_up(steps, SIDE / 800) for steps in (1, 40))
    assert once.status is slowly.status is Status.CONVERGED
    assert once.quantities["number"].value == pytest.approx(slowly.quantities["number"].value, rel=1e-9)
    monkeypatch.setattr(newton, "LARGEST_GROWTH", np.inf)
    assert blown_up(1, SIDE / 800).status is Status.FAILED, "the first step goes astray, and is halved"


def test_a_sheet_too_limp_for_its_first_step_is_told_of_shorter_ones():
    refused = blown_up(2, SIDE / 10_000)
    assert refused.status is Status.FAILED
    assert "gave up at 0 s" in refused.reason
    assert "steps: 200 instead of 2 begins with shorter ones" in refused.reason
