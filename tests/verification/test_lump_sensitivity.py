"""Adjoint sensitivities against a central difference of two grasps on the same mesh.

One taxel covers the whole face: what moves it into the tissue is then exact on any mesh, and the check is that of the adjoint.
Jaws may penetrate by a thousandth of the closing: what the default tolerance leaves changes forces by more than the lump does.
"""

import numpy as np
import pytest
from mutants import assert_kills

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.model import grasp_mesh
from tactsim.experiments.grasp.setup import Embedded
from tactsim.experiments.localization import lump_sensitivity
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.materials.library import named_material
from tactsim.mechanics.models.block_source import StructuredSource
from tactsim.mesh.inclusions.sphere import Sphere

CELLS = (6, 6, 4)
BALL = Sphere(center=(20e-3, 20e-3, 10e-3), radius=6e-3)
"""In the middle, where the density is a tenth above its mean over the block, so that the check sees where the ball lies."""
CHANGE = 0.05
AGREEMENT = 0.02
"""Tissue slips a little at the rim of the jaws, where the adjoint sticks."""


@pytest.fixture(scope="module")
def plain():
    closing = {"control": "displacement", "pieces": [{"kind": "ramp", "to": "0.5 mm", "duration": "1 s"}]}
    return Grasp.model_validate(
        {
            "block": {"tissue": "icf_stable"},
            "contact": {"kind": "coulomb", "friction": 1.0},
            "loading": closing,
            "time": {"steps": 1},
            "penetration_tolerance": "0.5 um",
            "matrix": {"rows": 1, "columns": 1, "pitch": "50 mm", "size": "50 mm"},
            "mesh": {"kind": "structured", "cells": list(CELLS)},
        }
    )


def forces(grasp):
    result = grasp.run()
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])


@pytest.fixture(scope="module")
def difference(plain):
    """Change of the forces over the change of the stiffness in elements whose middle lies in the ball."""
    tissue = named_material("icf_stable").material
    differences = []
    for factor in (1 - CHANGE, 1 + CHANGE):
        scaled = {name: factor * getattr(tissue, name) for name in ("c10", "c01", "c11")}
        lump = Embedded(shape=BALL, material=type(tissue).model_validate(tissue.model_dump() | scaled))
        differences.append(forces(plain.model_copy(update={"inclusions": (lump,)})))
    return (differences[1] - differences[0]) / (2 * CHANGE)


def predicted(plain, monkeypatch):
    """Change of the forces by the adjoint; and the mutant, as if the density were the same everywhere in the block."""
    monkeypatch.setattr(lump_sensitivity, "CELLS", CELLS)
    computed = lump_sensitivity.sensitivity(plain)
    same = plain.model_copy(update={"mesh": StructuredSource(kind="structured", cells=CELLS)})
    mesh = grasp_mesh(same).block.mesh
    inside = np.linalg.norm(mesh.nodes[mesh.elements[:, :4]].mean(axis=1) - BALL.center, axis=1) < BALL.radius
    points = np.repeat(inside, len(computed.places) // len(inside))
    changes = computed.densities * computed.volumes
    even = changes.sum(axis=-1) * computed.volumes[points].sum() / computed.volumes.sum()
    return changes[..., points].sum(axis=-1), even


def test_adjoint_is_the_difference(plain, difference, monkeypatch, verification_record):
    """Mutants: the wrong sign, and a density that is the same everywhere."""
    expected, even = predicted(plain, monkeypatch)

    def check(expected):
        assert np.abs(expected - difference).max() < AGREEMENT * np.abs(difference).max()

    check(expected)
    known = {"reference": "central difference of two grasps", "kind": "invariance", "mesh": "structured, 6 x 6 x 4 cells"}
    verification_record("adjoint sensitivity of a taxel", expected, difference, tolerance=AGREEMENT, **known)
    assert_kills(check, sign=(-expected,), even=(even,))
