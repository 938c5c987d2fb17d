"""Sections swept around their axis: volume, conformity, true circles, shape, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from solids import facets_where, on_plane

from tactsim.errors import InputError
from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.axisymmetric import edge_graded, section_mesh
from tactsim.mesh.quality import checked_points, determinants, jacobian_ratio, mean_ratio, region_volumes
from tactsim.mesh.revolved import LARGEST_SQUEEZE, largest_offset, shifted_outside, swept

RADIUS, LAYERS, RING = 10e-3, np.array([1e-3, 5e-3]), 3e-3
SIZE = edge_graded(np.array([[RING, 0.0]]), finest=0.5e-3, growth=0.8, coarsest=2e-3)
SECTION = section_mesh(RADIUS, (0.0, -LAYERS[0], -LAYERS.sum()), SIZE, rings=(RING,))
QUARTER, HALF, WHOLE = (2, np.pi / 2), (4, np.pi), (8, 2 * np.pi)
PARTS = [QUARTER, (3, np.pi / 2), (5, np.pi / 2), HALF, WHOLE, (12, 2 * np.pi)]


def parabolic_share(angle):
    """Area under the parabola through the ends and the middle of an arc, over that of the circle's sector of this angle."""
    half = angle / 2
    triangle, rise = np.sin(half) * np.cos(half), 1 - np.cos(half)
    return (triangle + 4 / 3 * rise * np.sin(half)) / half


@pytest.mark.parametrize(("sectors", "turn"), PARTS)
def test_volume_of_each_layer_is_that_within_parabolas_through_the_circle(sectors, turn):
    volumes = region_volumes(swept(SECTION, sectors, turn).mesh, 2)
    circle = turn / 2 * RADIUS**2 * LAYERS
    np.testing.assert_allclose(volumes, circle * parabolic_share(turn / sectors), rtol=1e-12)  # round-off


@pytest.mark.parametrize(("sectors", "turn"), PARTS)
def test_every_inner_face_has_two_elements_and_the_boundary_is_closed(sectors, turn):
    sweep = swept(SECTION, sectors, turn)
    elements = sweep.mesh.elements
    faces = np.sort(elements[:, [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]].reshape(-1, 3), axis=1)
    _, counts = np.unique(faces, axis=0, return_counts=True)
    assert set(counts) == {1, 2}
    facets, _ = sweep.mesh.boundary_facets()
    points = TaylorHood(sweep.mesh.nodes, elements, "solid").surface_points(facets)
    area = points.weights.sum()
    np.testing.assert_allclose(points.normals @ points.weights / area, 0.0, atol=1e-12)  # round-off
    assert not np.allclose(points.normals[:, 6:] @ points.weights[6:] / area, 0.0, atol=3e-12), "one facet is missing"


@pytest.mark.parametrize(("sectors", "turn"), PARTS)
def test_every_node_lies_on_the_circle_of_its_section_node(sectors, turn):
    sweep = swept(SECTION, sectors, turn)
    nodes, origin = sweep.mesh.nodes, SECTION.nodes[sweep.section_nodes]
    np.testing.assert_allclose(np.hypot(nodes[:, 0], nodes[:, 1]), origin[:, 0], rtol=1e-12, atol=1e-18)
    np.testing.assert_array_equal(nodes[:, 2], origin[:, 1])
    angle = np.arctan2(nodes[:, 1], nodes[:, 0])[origin[:, 0] > 0] % (2 * np.pi)
    halves = angle / (turn / sectors) * 2
    assert np.abs(halves - np.round(halves)).max() < 1e-9
    flat = sweep.mesh.nodes[sweep.mesh.elements[:, [0, 1]]].mean(axis=1)
    assert not np.isclose(np.hypot(*flat.T[:2])[:, None], SECTION.nodes[:, 0], rtol=1e-12).any(axis=1).all()


@pytest.mark.parametrize(("sectors", "turn"), PARTS)
def test_no_element_is_inverted_or_a_sliver(sectors, turn):
    mesh = swept(SECTION, sectors, turn).mesh
    assert jacobian_ratio(mesh.nodes, mesh.elements).min() > 0.35
    assert mean_ratio(mesh.nodes, mesh.elements[:, :4]).min() > 0.02
    assert len(np.unique(mesh.elements)) == len(mesh.nodes)


def test_mirror_planes_cut_the_whole_into_the_half_and_the_quarter():
    whole, half, quarter = (swept(SECTION, *part).mesh for part in (WHOLE, HALF, QUARTER))
    for part, factors in ((half, [[1, 1, 1], [1, -1, 1]]), (quarter, [[1, 1, 1], [-1, 1, 1], [1, -1, 1], [-1, -1, 1]])):
        centres = np.vstack([part.nodes[part.elements[:, :4]].mean(axis=1) * np.array(signs) for signs in factors])
        expected = whole.nodes[whole.elements[:, :4]].mean(axis=1)
        np.testing.assert_allclose(_sorted(centres), _sorted(expected), atol=1e-12)


def test_planes_of_symmetry_are_exact():
    nodes = swept(SECTION, *QUARTER).mesh.nodes
    for axis in (0, 1):
        near = np.abs(nodes[:, axis]) < 1e-9
        assert (nodes[near, axis] == 0.0).all()
        assert near.sum() == len(SECTION.nodes)


def test_facets_of_the_top_come_from_its_edges():
    edges = facets_where(SECTION, on_plane(1, 0.0))
    sweep = swept(SECTION, *HALF)
    facets = sweep.facets_from(edges)
    assert {tuple(facet) for facet in np.sort(facets, axis=1)} == {
        tuple(facet) for facet in np.sort(facets_where(sweep.mesh, on_plane(2, 0.0)), axis=1)
    }


def test_same_section_same_mesh():
    first, second = (swept(SECTION, *WHOLE).mesh for _ in range(2))
    np.testing.assert_array_equal(first.nodes, second.nodes)
    np.testing.assert_array_equal(first.elements, second.elements)


def test_shifted_side_is_a_circle_around_another_axis_and_the_middle_stays():
    mesh, rest = swept(SECTION, 16, 2 * np.pi).mesh, 3.5e-3
    offset = largest_offset(RADIUS, rest)
    nodes = shifted_outside(mesh.nodes, -offset, radius=RADIUS, rest=rest)
    side = np.hypot(*mesh.nodes.T[:2]) > RADIUS * (1 - 1e-12)
    np.testing.assert_allclose(np.hypot(nodes[side, 0] + offset, nodes[side, 1]), RADIUS, rtol=1e-12)
    middle = np.hypot(*mesh.nodes.T[:2]) <= rest
    np.testing.assert_array_equal(nodes[middle], mesh.nodes[middle])
    assert determinants(nodes, mesh.elements, checked_points()).min() > 0
    assert offset == pytest.approx(LARGEST_SQUEEZE * (RADIUS - rest) / 1.5)
    too_far = shifted_outside(mesh.nodes, -2.5 * offset, radius=RADIUS, rest=rest)
    assert determinants(too_far, mesh.elements, checked_points()).min() < 0


@pytest.mark.parametrize(
    ("sectors", "turn", "words"),
    [(1, np.pi / 2, "at least 2"), (3, np.pi, "at least 4"), (9, 2 * np.pi, "even"), (8, 7.0, "401"), (2, 0.0, "0 degrees")],
)
def test_impossible_sweeps_are_refused(sectors, turn, words):
    with pytest.raises(InputError, match=words):
        swept(SECTION, sectors, turn)


def _sorted(points):
    rounded = np.round(points / RADIUS, 9)
    return points[np.lexsort(rounded.T)]
