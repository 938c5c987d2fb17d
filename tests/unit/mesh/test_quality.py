"""Measures of shape, the smoothing that improves them, and the sizes that the mesher is asked for."""

from __future__ import annotations

import numpy as np
import pytest
from lumps import LUMP, SIZE
from solids import assert_close, box

from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.fitting.constrained import Constraints, block_patches
from tactsim.mesh.fitting.smoothing import _energy, smoothed
from tactsim.mesh.quality import determinants, jacobian_ratio, mean_ratio, region_volumes
from tactsim.mesh.sizing import edge_lengths, jaw_edge_distance

REGULAR = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, np.sqrt(3) / 2, 0], [0.5, np.sqrt(3) / 6, np.sqrt(2 / 3)]])
BLOCK = np.array(SIZE)


def test_the_mean_ratio_is_one_for_regular_tetrahedra_and_changes_sign_with_orientation():
    one = np.arange(4)[None]
    assert_close(mean_ratio(3e-3 * REGULAR, one), 1.0, 1e-14)
    assert_close(mean_ratio(REGULAR, one[:, [1, 0, 2, 3]]), -1.0, 1e-14)
    flat = REGULAR * [1, 1, 0]
    assert_close(mean_ratio(flat, one), 0.0, 1e-9, scale=1.0)
    corner = np.vstack([np.zeros(3), np.eye(3)])  # edges 1 and sqrt(2): 12 (3 V)^(2/3) / sum of squared edges
    assert_close(mean_ratio(corner, one), 12 * (3 / 6) ** (2 / 3) / 9, 1e-14)


def test_jacobians_are_those_of_the_solver():
    mesh = box([1.0, 1.0, 1.0], [2, 2, 2], jitter=0.1)
    nodes = mesh.nodes + 0.02 * np.sin(3 * mesh.nodes[:, [1, 2, 0]])
    curved = mesh.moved(nodes)
    weights = TaylorHood(nodes, mesh.elements, "solid").volume_points(3).weights.sum()
    assert_close(region_volumes(curved, 1), weights, 1e-13)
    assert_close(jacobian_ratio(mesh.nodes, mesh.elements), 1.0, 1e-12)
    assert (jacobian_ratio(nodes, mesh.elements) < 1 - 1e-6).any()
    nodes[mesh.elements[0, 4]] = nodes[mesh.elements[0, 2]]
    assert jacobian_ratio(nodes, mesh.elements)[0] < 0
    assert determinants(nodes, mesh.elements, np.eye(4)).shape == (len(mesh.elements), 4)


@pytest.mark.parametrize("inverted", [False, True])
def test_the_gradient_of_the_smoothing_energy_is_its_derivative(inverted):
    rng = np.random.default_rng(0)
    corners = REGULAR + 0.1 * rng.normal(size=(4, 3))
    simplices = np.array([[0, 1, 2, 3] if not inverted else [1, 0, 2, 3]])
    barrier = np.array([0.3])
    _, gradient = _energy(corners, simplices, barrier)
    direction, step = rng.normal(size=(4, 3)), 1e-6
    values = [_energy(corners + sign * step * direction, simplices, barrier)[0] for sign in (1, -1)]
    assert_close((values[0] - values[1]) / (2 * step), (gradient * direction).sum(), 1e-6)
    with pytest.raises(AssertionError):
        assert_close((values[0] - values[1]) / (2 * step), 1.00001 * (gradient * direction).sum(), 1e-6)


def test_smoothing_improves_the_worst_tetrahedron_and_leaves_the_faces_flat():
    mesh = box(SIZE, [4, 4, 3], jitter=0.3, seed=3)
    corners, simplices = mesh.nodes[: mesh.corner_count], mesh.elements[:, :4]
    faces = [(axis, end) for axis in range(3) for end in (0, 1)]
    on = np.stack([np.isclose(corners[:, axis], end * BLOCK[axis], rtol=0, atol=1e-12) for axis, end in faces], axis=1)
    fixed = Constraints(block_patches(BLOCK), on, BLOCK)
    better = smoothed(corners, simplices, fixed.directions, fixed.restored)
    assert mean_ratio(better, simplices).min() > 1.2 * mean_ratio(corners, simplices).min()
    for column, (axis, end) in enumerate(faces):
        assert (better[on[:, column], axis] == end * BLOCK[axis]).all()
    assert_close(np.abs(better - corners)[on.sum(axis=1) == 3], 0.0, 1e-15, scale=1.0)


def test_sizes_are_the_wanted_ones_at_inclusions_and_jaw_edges():
    settings = BlockMeshSettings(size=5e-3, inclusion_size=1e-3, edge_size=2e-3, growth=0.5)
    points = np.array(
        [[25e-3, 20e-3, 10e-3], [27e-3, 20e-3, 10e-3], [0.0, 10e-3, 20e-3], [10e-3, 1e-3, 0.0], [6e-3, 8e-3, 10e-3]]
    )
    expected = [1e-3, 2e-3, 2e-3, 2.5e-3, 5e-3]
    assert_close(edge_lengths(points, BLOCK, [LUMP], settings), expected, 1e-12)


def test_the_distance_from_smaller_jaws_is_that_from_their_edges():
    points = np.array([[10e-3, 20e-3, 0.0], [20e-3, 20e-3, 20e-3], [5e-3, 20e-3, 0.0], [10e-3, 20e-3, 10e-3]])
    assert_close(jaw_edge_distance(points, BLOCK, (20e-3, 20e-3)), [0.0, 10e-3, 5e-3, 10e-3], 1e-12)
