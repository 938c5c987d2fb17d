"""The parts of a tangent against slices of it."""

from __future__ import annotations

import numpy as np
import pytest
from solids import body_of, box, held, on_plane

from tactsim.fem.equilibrium.constraints import Constraints
from tactsim.fem.solvers.block_preconditioner import dilatation
from tactsim.fem.solvers.tangent_blocks import TangentBlocks
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

MEASURES = {2: "plane_strain", 3: "solid"}


@pytest.mark.parametrize("dim", MEASURES)
def test_the_parts_are_slices_of_the_tangent(dim):
    mesh = box([1.0] * dim, [3] * dim, jitter=0.2)
    body = body_of(mesh, MEASURES[dim], MooneyRivlin2(c10=80.0, c01=20.0, bulk_modulus=1e5))
    unknowns = 1e-3 * np.random.default_rng(2).normal(size=body.space.size)
    data = body.tangent(unknowns)
    fixed = np.concatenate([held(mesh, 0, on_plane(dim - 1, 0.0)), held(mesh, dim - 1, on_plane(dim - 1, 0.0))])
    matrix = body.pattern.matrix(Constraints(fixed, body.pattern).apply(data))
    split, added = body.space.displacement_size, dilatation(body)
    blocks = TangentBlocks(matrix, split, dim)
    assert (blocks.gradient(matrix) != matrix[:split, split:]).nnz == 0
    assert (blocks.compliance(matrix) != -matrix[split:, split:]).nnz == 0
    stiffness, free = blocks.stiffness(matrix, added.data, 2.0)
    expected = np.ones(split, bool)
    expected[fixed] = False
    np.testing.assert_array_equal(free.ravel(), expected)
    whole, more = matrix[:split, :split].toarray(), np.where(expected[:, None] & expected, 2.0 * added.toarray(), 0.0)
    np.testing.assert_allclose(stiffness.toarray(), whole + more, rtol=0, atol=1e-6 * np.abs(whole).max())
