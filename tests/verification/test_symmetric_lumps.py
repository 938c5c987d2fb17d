"""Two equal balls on a diagonal of the block press equal taxels equally: the mesh does not tell them apart.

The quick part of this, that the mesh is its own image, stands with the tests of the mesh.
"""

from __future__ import annotations

import numpy as np
import pytest
from hard_balls import pressed_balls

from tactsim.mesh.graded import bricks

SHARE, LEANING = 1e-4, 5e-4
"""Difference allowed of taxels that are images of each other, over the largest taxel, and what leaning planes show at least."""


def difference():
    """Of taxels from their images in the diagonal plane, and of upper ones from lower ones turned about the middle."""
    cells = {"size": 4e-3, "inclusion_size": 1.6e-3, "edge_size": 3.6e-3, "growth": 1.0}
    upper, lower = pressed_balls([(10e-3, 10e-3, 10e-3), (30e-3, 30e-3, 10e-3)], 4e-3, "icf_stable", cells)
    differences = np.stack([upper - lower[::-1, ::-1], upper - upper.T])
    return float(np.abs(differences).max() / upper.max())


@pytest.mark.slow
def test_taxels_over_balls_that_mirror_each_other_are_equal(verification_record):
    found = difference()
    assert found < SHARE
    known = {
        "reference": "taxels that are images of each other",
        "kind": "invariance",
        "mesh": "graded, 4 and 1.6 mm",
        "tolerance": SHARE,
    }
    verification_record("equal taxels over two balls, difference", found, 0.0, scale=1.0, **known)


@pytest.mark.slow
def test_planes_that_lean_from_one_ball_to_the_other_would_tell_them_apart(monkeypatch):
    monkeypatch.setattr(bricks, "LEAN", np.inf)
    assert difference() > LEANING
