"""A rigid body pressed onto a face of a boundary value problem: what its penetration costs, whatever the face and the body."""

from __future__ import annotations

import pytest
from mutants import assert_kills

from tactsim.experiments.boundary_value import posing
from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.mechanics.models.loaded_body import Conditions
from tactsim.results import Result
from tactsim.results.result import Status

pytestmark = pytest.mark.usefixtures("one_thread")
SQUARE = {"kind": "block", "x": [{"length": 10e-3, "cells": 10}], "y": [{"length": 10e-3, "cells": 10}]}
TISSUE = {"kind": "neo_hookean", "c10": 1e3, "bulk_modulus": 1e5}
LAYER = {
    "kind": "cylinder",
    "radial": [{"length": 0.8e-3, "cells": 24}, {"length": 7.2e-3, "cells": 12, "ratio": 3.0}],
    "axial": [{"length": 1e-3, "cells": 8, "ratio": 0.2}],
}


def pressed(side: str, opposite: str, component: str, at: tuple[float, float]) -> Result:
    """A ball pressed by 0.4 mm into a side of a square held at the opposite one."""
    return BoundaryValueProblem.model_validate(
        {
            "dimension": "plane_strain",
            "geometry": SQUARE,
            "material": TISSUE,
            "conditions": [{"kind": "clamped", "face": opposite}],
            "contacts": [{"face": side, "side": side, "at": at, "body": {"kind": "sphere", "radius": 6e-3}, component: -0.4e-3}],
            "penetration_tolerance": 1e-6,
            "steps": 4,
            "asked": {"force": {"kind": "contact_force", "component": component}},
        }
    ).run()


def test_the_side_on_which_a_body_presses_does_not_matter() -> None:
    top = pressed("top", "bottom", "y", (5e-3, 10e-3))
    right = pressed("right", "left", "x", (10e-3, 5e-3))
    for result in (top, right):
        assert result.status is Status.CONVERGED, result.reason
        assert 1e-4 < result["penetration_force_error"].value < 2e-3
    for name in ("force", "penetration_force_error"):
        assert right[name].value == pytest.approx(top[name].value, rel=1e-6), name


def layer(tolerance: float) -> tuple[float, float]:
    """Force in N, and the estimated part of it that is lost, of a ball pressed by 20 um into a bonded layer of 1 mm."""
    result = BoundaryValueProblem.model_validate(
        {
            "dimension": "axisymmetric",
            "geometry": LAYER,
            "material": {"kind": "neo_hookean", "c10": 500.0},
            "conditions": [{"kind": "clamped", "face": "bottom"}],
            "contacts": [{"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 5e-3}, "z": -20e-6}],
            "penetration_tolerance": tolerance,
            "steps": 2,
            "asked": {"force": {"kind": "contact_force", "component": "z"}},
        }
    ).run()
    return abs(float(result["force"].value)), float(result["penetration_force_error"].value)


def test_what_penetration_takes_away_is_estimated_on_a_thin_layer(monkeypatch: pytest.MonkeyPatch) -> None:
    exact, _ = layer(1e-9)
    force, estimate = layer(2e-6)
    lost = 1 - force / exact

    def check(estimate: float) -> None:
        assert 0.8 * lost < estimate < 2 * lost

    assert 4e-3 < lost < 2e-2
    check(estimate)
    monkeypatch.setattr(Conditions, "only_contacts_act", False)
    assert_kills(check, growth_of_a_cube_of_its_size=(layer(2e-6)[1],))


def on_coarse_cells(tolerance: float | None) -> Result:
    """A ball pressed by 2.5 mm into a quarter of a bonded block, on cells as large as its radius."""
    cells = [{"length": 10e-3, "cells": 2}]
    return BoundaryValueProblem.model_validate(
        {
            "dimension": "3d",
            "geometry": {"kind": "block", "x": cells, "y": cells, "z": cells},
            "material": {"kind": "neo_hookean", "c10": 3e3},
            "conditions": [
                {"kind": "clamped", "face": "bottom"},
                {"kind": "displacement", "face": "left", "x": 0.0},
                {"kind": "displacement", "face": "front", "y": 0.0},
            ],
            "contacts": [{"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 5e-3}, "z": -2.5e-3}],
            "penetration_tolerance": tolerance,
            "steps": 3,
            "asked": {"force": {"kind": "contact_force", "component": "z"}},
        }
    ).run()


def test_a_ball_on_coarse_cells_in_space_needs_no_wider_tolerance_than_the_default() -> None:
    wide, default = on_coarse_cells(1e-6), on_coarse_cells(None)
    for result in (wide, default):
        assert result.status is Status.CONVERGED, result.reason
    assert default["max_penetration"].value <= 1e-6 * 10e-3
    # What the wider tolerance takes away, by its estimate.
    assert default["force"].value == pytest.approx(wide["force"].value, rel=2 * wide["penetration_force_error"].value)


@pytest.mark.slow
def test_without_its_widening_the_default_tolerance_is_not_reached_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posing, "WIDEST", 0.0)
    failed = on_coarse_cells(None)
    assert failed.status is Status.FAILED
    assert "instead of 10 nm, penetration_tolerance: 100 nm is easier to reach" in failed.reason
