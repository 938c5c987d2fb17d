"""Sticking jaws: a limit far above the pressure, so that a point that touches or lifts changes its traction steadily."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.contact import stick
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.results.result import Status

GRASP = {
    "block": {
        "size": [19.47e-3, 20.95e-3, 11.89e-3],
        "tissue": {"kind": "neo_hookean", "c10": 4907.0, "bulk_modulus": 5.031e6},
    },
    "contact": {"kind": "stick"},
    "matrix": {"rows": 3, "columns": 3, "pitch": 4.867e-3, "size": 3.894e-3},
    "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 0.5948e-3, "duration": 1.0}]},
    "mesh": {"kind": "structured", "cells": [4, 4, 4]},
    "time": {"steps": 1},
}
"""A random grasp whose free faces roll onto the jaws."""


def test_faces_that_roll_onto_sticking_jaws_are_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    def forces() -> np.ndarray:
        result = Grasp.model_validate(GRASP).run()
        assert result.status is Status.CONVERGED
        return np.asarray(result.quantities["taxel_force_upper"].value)

    usual = forces()
    monkeypatch.setattr(stick, "STRONGEST", 30.0)
    np.testing.assert_allclose(forces(), usual, atol=1e-3 * usual.max())
    monkeypatch.setattr(stick, "STRONGEST", 0.3)  # the mutant: friction that gives way
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(forces(), usual, atol=1e-3 * usual.max())
