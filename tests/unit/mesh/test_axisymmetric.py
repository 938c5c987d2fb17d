"""Sections of axisymmetric specimens: sizes, layers and rings where they were asked for."""

from __future__ import annotations

import numpy as np
import pytest
from solids import assert_close

from tactsim.errors import InputError
from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh import axisymmetric
from tactsim.mesh.axisymmetric import edge_graded, section_mesh

RADIUS, HEIGHTS = 15e-3, (0.0, -1e-3, -10e-3)
EDGES = np.array([[1.5e-3, 0.0], [3e-3, 0.0]])
GRADED = edge_graded(EDGES, finest=1e-4, growth=0.35, coarsest=2e-3)


def longest_edges(mesh):
    corners = mesh.nodes[mesh.elements[:, :3]]
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1), corners


def volumes(mesh):
    """Volume of the whole and of each region in m^3, by the axisymmetric quadrature."""
    weights = TaylorHood(mesh.nodes, mesh.elements, "axisymmetric").volume_points().weights.sum(axis=1)
    return weights.sum(), np.bincount(mesh.regions, weights)


def test_elements_are_as_small_as_wanted():
    mesh = section_mesh(RADIUS, HEIGHTS, GRADED)
    longest, corners = longest_edges(mesh)
    wanted = np.min([GRADED(corners[:, i]) for i in range(3)], axis=0)
    assert (longest <= wanted * (1 + 1e-12)).all()
    assert longest.min() < 1e-4 < 5e-4 < longest.max()  # and not everywhere as small as at the edges


def test_smaller_sizes_make_smaller_elements():
    finer = edge_graded(EDGES, finest=5e-5, growth=0.175, coarsest=1e-3)
    coarse, fine = (section_mesh(RADIUS, HEIGHTS, size) for size in (GRADED, finer))
    longest, corners = longest_edges(coarse)
    assert 3 < len(fine.elements) / len(coarse.elements) < 5
    assert not (
        longest <= np.min([finer(corners[:, i]) for i in range(3)], axis=0)
    ).all()  # twin: the coarse mesh fails the check


def test_regions_are_the_layers_from_the_top_down():
    mesh = section_mesh(RADIUS, HEIGHTS, GRADED)
    total, by_region = volumes(mesh)
    exact = np.pi * RADIUS**2 * np.array([1e-3, 9e-3])
    assert_close(by_region, exact, 1e-12)  # round-off
    assert_close(total, exact.sum(), 1e-12)
    with pytest.raises(AssertionError):
        assert_close(by_region[::-1], exact, 1e-12)


def test_no_element_crosses_an_interface():
    mesh = section_mesh(RADIUS, HEIGHTS, GRADED)
    heights = mesh.nodes[mesh.elements[:, :3], 1]
    assert (heights[mesh.regions == 0].min() >= -1e-3 - 1e-15) & (heights[mesh.regions == 1].max() <= -1e-3 + 1e-15)


@pytest.mark.parametrize("rings", [(1.5e-3,), (1.5e-3, 3e-3), (1.23e-3, 2.71e-3)])
def test_rings_are_nodes_of_the_top(rings):
    edges = np.array([[ring, 0.0] for ring in rings])
    mesh = section_mesh(RADIUS, HEIGHTS, edge_graded(edges, finest=1e-4, growth=0.35, coarsest=2e-3), rings=rings)
    corners = mesh.nodes[: mesh.corner_count]
    top = corners[corners[:, 1] == 0.0, 0]
    for ring in rings:
        assert np.abs(top - ring).min() <= 1e-15
    assert_close(volumes(mesh)[0], np.pi * RADIUS**2 * 10e-3, 1e-12)  # the shift leaves the outline alone


def test_the_order_of_the_interfaces_does_not_matter():
    first, second = section_mesh(RADIUS, HEIGHTS, GRADED), section_mesh(RADIUS, HEIGHTS[::-1], GRADED)
    assert (first.nodes == second.nodes).all()
    assert (first.regions == second.regions).all()


def test_the_mesh_repeats_bit_by_bit():
    first, second = (section_mesh(RADIUS, HEIGHTS, GRADED, rings=(1.5e-3, 3e-3)) for _ in range(2))
    assert (first.nodes == second.nodes).all()
    assert (first.elements == second.elements).all()


def test_the_axis_lies_at_zero_exactly():
    mesh = section_mesh(RADIUS, HEIGHTS, GRADED)
    near = mesh.nodes[:, 0] < 1e-9
    assert near.sum() > 3
    assert (mesh.nodes[near, 0] == 0.0).all()


@pytest.mark.parametrize("finest", [1e-4, 2e-6])
def test_elements_keep_the_shape_of_the_coarse_grid_however_fine_the_grading(finest):
    mesh = section_mesh(RADIUS, HEIGHTS, edge_graded(EDGES, finest=finest, growth=0.35, coarsest=2e-3))
    longest, corners = longest_edges(mesh)
    a, b = (corners[:, k] - corners[:, 0] for k in (1, 2))
    altitude = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / longest
    assert (altitude / longest).min() > 0.09


@pytest.mark.parametrize("size", [lambda points: np.zeros(len(points)), lambda points: np.full(len(points), -1.0)])
def test_a_size_that_is_not_positive_is_refused(size):
    with pytest.raises(InputError, match="size"):
        section_mesh(RADIUS, HEIGHTS, size)


def test_rings_that_the_elements_cannot_distinguish_are_refused():
    with pytest.raises(InputError, match="too coarse"):
        section_mesh(RADIUS, HEIGHTS, lambda points: np.full(len(points), 5e-3), rings=(1.5e-3, 1.51e-3))


def test_the_size_grows_from_the_edges_to_its_bound():
    assert_close(GRADED(EDGES), 1e-4, 1e-15)
    assert_close(GRADED(np.array([[3e-3 + 1e-3, 0.0]])), 1e-4 + 0.35e-3, 1e-12)
    assert_close(GRADED(np.array([[1.0, 0.0]])), 2e-3, 1e-15)
    reaching = edge_graded(EDGES, finest=1e-4, growth=0.35, coarsest=2e-3, reach=2e-3)
    assert_close(reaching(np.array([[3e-3 + 1.9e-3, 0.0]])), 1e-4, 1e-15)


@pytest.mark.parametrize(
    "sizes", [(1.0, 1.0, 1.0), (1.0, 1.0, 2.0), (3.0, 1.0, 3.0), (0.05, 1.0, 4.0), (1.0, 1.0 + 1e-5, 1.0), (1.0, 1.0003, 1.0006)]
)
def test_elements_of_a_linear_size_are_counted_exactly(sizes):
    points, weights = np.polynomial.legendre.leggauss(200)
    u, w = (points + 1) / 2, weights / 2
    first, second = u[:, None] * np.ones_like(u), (1 - u[:, None]) * u  # a triangle as a square that is drawn together
    inside = sizes[0] * (1 - first - second) + sizes[1] * first + sizes[2] * second
    mean = 2 * float(w @ ((1 - u[:, None]) * inside**-2.0) @ w)
    assert_close(axisymmetric._inverse_square(np.array(sizes)), mean, 1e-7)
