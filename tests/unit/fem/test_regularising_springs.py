"""Springs against rigid-body motion: as weak beside the body at every size, in every measure."""

from __future__ import annotations

import numpy as np
import pytest
from solids import body_of, box

from tactsim.fem.assembly.regularising_springs import WEAKNESS, RegularisingSprings
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

RUBBER = MooneyRivlin2(c10=400.0, c01=100.0)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("measure", "dim"), [("plane_strain", 2), ("axisymmetric", 2), ("solid", 3)])
def test_they_are_as_weak_beside_the_body_at_every_size(measure, dim, size):
    body = body_of(box([size] * dim, [2] * dim), measure, RUBBER)
    moved = np.zeros(body.space.size)
    u, _ = body.space.split(moved)
    u[:, -1] = 0.1 * size
    pulled = -body.space.split(RegularisingSprings(body).force(u))[0][:, -1].sum()
    # A shear modulus times an area per length: the depth of plane strain is one metre, whatever the size.
    area = size if measure == "plane_strain" else size**2
    assert pulled == pytest.approx(WEAKNESS * RUBBER.shear_modulus * area * 0.1, rel=1e-12)
