"""Quadratic meshes: orientation, boundary facets, and every mesh that cannot be used refused with its place."""

from __future__ import annotations

import numpy as np
import pytest
from solids import assert_close, box

from tactsim.errors import InputError
from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.quadratic import quadratic_mesh

MEASURE = {2: "plane_strain", 3: "solid"}
UNIT = {2: np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), 3: np.vstack([np.zeros(3), np.eye(3)])}
MIDDLES = {2: [(0, 1), (1, 2), (0, 2)], 3: [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]}


def simplex(dim: int) -> np.ndarray:
    """One element in the right order."""
    return np.arange(dim + 1)[None]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(6))
def test_elements_are_turned_right_side_out_whatever_their_order(dim, seed):
    order = np.random.default_rng(seed).permutation(dim + 1)
    mesh = quadratic_mesh(UNIT[dim], order[None])
    points = TaylorHood(mesh.nodes, mesh.elements, MEASURE[dim]).volume_points()
    assert_close(points.weights.sum(), 1 / 2 if dim == 2 else 1 / 6, 1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_middle_nodes_stand_between_their_corners_in_the_order_of_vtk(dim):
    mesh = box([1.0] * dim, [3] * dim, jitter=0.2)
    for slot, (a, b) in enumerate(MIDDLES[dim]):
        middle = (mesh.nodes[mesh.elements[:, a]] + mesh.nodes[mesh.elements[:, b]]) / 2
        assert_close(mesh.nodes[mesh.elements[:, dim + 1 + slot]], middle, 1e-15)


@pytest.mark.parametrize("dim", [2, 3])
def test_corners_are_numbered_before_middles_and_no_node_stands_twice(dim):
    mesh = box([1.0] * dim, [3] * dim)
    assert set(np.unique(mesh.elements[:, : dim + 1])) == set(range(mesh.corner_count))
    assert set(np.unique(mesh.elements)) == set(range(len(mesh.nodes)))
    assert len(np.unique(mesh.nodes.round(9), axis=0)) == len(mesh.nodes) == 7**dim


@pytest.mark.parametrize("dim", [2, 3])
def test_boundary_facets_close_around_the_body_and_point_outward(dim):
    mesh = box([1.0] * dim, [3] * dim, jitter=0.2)
    facets, owner = mesh.boundary_facets()
    points = TaylorHood(mesh.nodes, mesh.elements, MEASURE[dim]).surface_points(facets)
    assert_close(points.weights.sum(), 4.0 if dim == 2 else 6.0, 1e-13)
    assert_close(points.normals @ points.weights, 0.0, 1e-13, scale=1.0)
    volume = (points.interpolate(mesh.nodes) * points.normals).sum(axis=0) @ points.weights / dim
    assert_close(volume, 1.0, 1e-13)  # the divergence theorem: an inward facet would take from it
    for face, element in zip(facets, owner, strict=True):
        assert set(face) <= set(mesh.elements[element])


@pytest.mark.parametrize("dim", [2, 3])
def test_a_facet_turned_inward_is_seen(dim):
    mesh = box([1.0] * dim, [2] * dim)
    facets, _ = mesh.boundary_facets()
    facets[0, [0, 1]] = facets[0, [1, 0]]
    points = TaylorHood(mesh.nodes, mesh.elements, MEASURE[dim]).surface_points(facets)
    with pytest.raises(AssertionError):
        assert_close(points.normals @ points.weights, 0.0, 1e-13, scale=1.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_boundary_facets_carry_their_middle_nodes(dim):
    mesh = box([1.0] * dim, [2] * dim, jitter=0.1)
    facets, _ = mesh.boundary_facets()
    for slot, (a, b) in enumerate([(0, 1)] if dim == 2 else [(0, 1), (1, 2), (0, 2)]):
        between = (mesh.nodes[facets[:, a]] + mesh.nodes[facets[:, b]]) / 2
        assert_close(mesh.nodes[facets[:, dim + slot]], between, 1e-15)


@pytest.mark.parametrize("dim", [2, 3])
def test_nodes_that_no_element_uses_are_left_out(dim):
    corners = np.vstack([np.full(dim, 9.0), UNIT[dim]])
    mesh = quadratic_mesh(corners, simplex(dim) + 1)
    assert mesh.nodes.max() == 1.0
    assert len(mesh.nodes) == {2: 6, 3: 10}[dim]


@pytest.mark.parametrize("dim", [2, 3])
def test_a_flat_element_is_refused_with_its_number(dim):
    corners = np.vstack([UNIT[dim], 2 * UNIT[dim][1]])
    flat = np.array([[0, 1, dim + 1, 2][: dim + 1]])
    with pytest.raises(InputError, match="element 1 of the mesh is flat"):
        quadratic_mesh(corners, np.vstack([simplex(dim), flat]))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("length", [1e-6, 1.0, 1e3])
def test_an_element_flat_to_round_off_is_refused_whatever_its_size(dim, length):
    corners = UNIT[dim].copy()
    corners[-1] = corners[1:-1].mean(axis=0) + np.eye(dim)[-1] * 1e-14
    with pytest.raises(InputError, match="element 0 of the mesh is flat"):
        quadratic_mesh(corners * length, simplex(dim))
    corners[-1, -1] = 1e-6
    assert len(quadratic_mesh(corners * length, simplex(dim)).elements) == 1


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("index", [-1, 4, 10**9])
def test_an_index_without_coordinates_is_refused_with_the_range(dim, index):
    simplices = simplex(dim)
    simplices[0, 0] = index
    with pytest.raises(InputError, match=rf"allowed: 0 to {dim}"):
        quadratic_mesh(UNIT[dim], simplices)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_coordinates_that_are_not_finite_are_refused(dim, bad):
    corners = UNIT[dim].copy()
    corners[1, 0] = bad
    with pytest.raises(InputError, match="not finite"):
        quadratic_mesh(corners, simplex(dim))


@pytest.mark.parametrize("dim", [2, 3])
def test_a_mesh_without_elements_is_refused(dim):
    with pytest.raises(InputError, match="no elements"):
        quadratic_mesh(UNIT[dim], np.zeros((0, dim + 1), int))


@pytest.mark.parametrize("dim", [2, 3])
def test_an_element_turned_inside_out_by_its_middle_nodes_is_refused(dim):
    mesh = box([1.0] * dim, [2] * dim)
    nodes = mesh.nodes.copy()
    nodes[mesh.elements[2, dim + 1]] = nodes[mesh.elements[2, 2]]
    space = TaylorHood(nodes, mesh.elements, MEASURE[dim])
    with pytest.raises(InputError, match=r"element \d+ of the mesh is inverted or flat"):
        space.volume_points()


@pytest.mark.parametrize("dim", [2, 3])
def test_regions_are_kept_and_moving_changes_the_nodes_only(dim):
    mesh = quadratic_mesh(UNIT[dim], simplex(dim), np.array([3]))
    moved = mesh.moved(mesh.nodes + 1)
    assert moved.regions.tolist() == [3]
    assert (moved.elements == mesh.elements).all()
    assert_close(moved.nodes, mesh.nodes + 1, 0.0)
