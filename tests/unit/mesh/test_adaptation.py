"""Nested refinement keeps quadratic fields, volume, regions and orientation."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.mesh.adaptation import refined
from tactsim.mesh.axisymmetric import edge_graded, section_mesh


@pytest.fixture
def coarse():
    size = edge_graded(np.array([[1.0, 0.0]]), finest=0.3, growth=0.5, coarsest=1.0)
    return section_mesh(3.0, [0.0, -0.5, -2.0], size, rings=(1.0,))


def stretched(nodes):
    return nodes * np.array([1.0, 3.0]) + np.array([0.2, 0.0]) * np.sin(nodes[:, 1:])


def test_quadratic_fields_are_transferred_exactly(coarse):
    split = refined(coarse, np.arange(0, len(coarse.elements), 3), stretched(coarse.nodes))

    def field(x):
        return np.stack([1 + x[:, 0] - x[:, 1] ** 2, x[:, 0] * x[:, 1]], axis=1)

    np.testing.assert_allclose(split.nodal @ field(coarse.nodes), field(split.mesh.nodes), atol=1e-13)
    linear = coarse.nodes[coarse.elements[split.parents, :3]].sum(axis=2)
    at_corners = np.einsum("ecv,ev->ec", split.barycentric, linear)
    np.testing.assert_allclose(at_corners, split.mesh.nodes[split.mesh.elements[:, :3]].sum(axis=2), atol=1e-13)


def test_marked_elements_shrink_and_cover_the_same_area(coarse):
    def areas(mesh):
        x = mesh.nodes[mesh.elements[:, :3]]
        return np.linalg.det(np.moveaxis(x[:, 1:] - x[:, :1], 1, 2)) / 2

    split = refined(coarse, np.array([0, 5]), stretched(coarse.nodes))
    before, after = areas(coarse), areas(split.mesh)
    assert (after > 0).all()
    np.testing.assert_allclose(np.bincount(split.parents, after), before, rtol=1e-13)
    assert np.isin([0, 5], split.parents[after < 0.6 * before[split.parents]]).all()
    np.testing.assert_array_equal(split.mesh.regions, coarse.regions[split.parents])


def test_children_of_curved_parents_stay_on_the_curve(coarse):
    curved = coarse.nodes + 0.05 * np.stack([np.zeros(len(coarse.nodes)), coarse.nodes[:, 0] ** 2], axis=1)
    mesh = coarse.moved(curved)
    facets, _ = mesh.boundary_facets()
    flat = coarse.nodes[facets]
    top = facets[(flat[:, :, 1] > -1e-9).all(axis=1)]
    split = refined(mesh, np.arange(len(mesh.elements)), curved)
    children = split.facets_on(mesh, top)
    nodes = split.mesh.nodes[np.unique(children)]
    assert len(children) > len(top)
    assert np.ptp(nodes[:, 0]) == 3.0
    np.testing.assert_allclose(nodes[:, 1], 0.05 * nodes[:, 0] ** 2, atol=1e-13)
