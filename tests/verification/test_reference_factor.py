"""Tissue of moduli f times as large reads f times as much where the closing is prescribed, with friction and large strain too."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.localization.source import readings_of
from tactsim.interfaces.readings import Readings
from tactsim.materials.library import material

STIFFER = 1.2
FRICTION = 0.6


def plain(factor: float = 1.0, friction: float = FRICTION) -> Readings:
    """Readings of a coarse block of ICF whose constants are multiplied."""
    tissue = material("icf_stable").model_dump(include={"c10", "c01", "c11"})
    grasp = Grasp.model_validate(
        {
            "block": {
                "size": [40e-3, 40e-3, 20e-3],
                "tissue": {"kind": "mooney_rivlin_3"} | {name: factor * value for name, value in tissue.items()},
            },
            "contact": {"kind": "coulomb", "friction": friction},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-3, "duration": 1.0}]},
            "mesh": {"kind": "structured", "cells": [6, 6, 3]},
            "time": {"steps": 1},
        }
    )
    return readings_of(grasp.run(), noise=0.0)


@pytest.mark.slow
def test_forces_are_in_proportion_to_the_moduli(verification_record) -> None:
    reference, stiffer = plain(), plain(STIFFER)
    assert stiffer.forces == pytest.approx(STIFFER * reference.forces, rel=1e-4)  # the solver's tolerance
    known = {"reference": "forces of the softer one, 1.2 times as large", "kind": "invariance", "mesh": "6 x 6 x 3 cells"}
    expected = STIFFER * np.asarray(reference.forces)
    verification_record("grasp of tissue 20 % stiffer, taxel forces", stiffer.forces, expected, tolerance=1e-4, **known)
    slipping = plain(friction=0.4).forces / reference.forces
    assert np.ptp(slipping) > 1e-2, "other friction is no common factor"
