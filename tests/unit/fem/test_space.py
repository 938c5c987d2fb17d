"""The Taylor-Hood space: shape functions, volumes, surfaces, and meshes that do not fit."""

from __future__ import annotations

import numpy as np
import pytest
from solids import assert_close, box, facets_where, on_plane

from tactsim.errors import InputError
from tactsim.fem.assembly.body import Body
from tactsim.fem.assembly.space import TaylorHood
from tactsim.materials.mooney_rivlin_2 import MooneyRivlin2

MEASURES = {"axisymmetric": 2 * np.pi * 0.5, "plane_strain": 1.0, "solid": 1.0}
"""Volume of the unit box: a cylinder of radius one for an axisymmetric body."""


def space_of(measure: str) -> TaylorHood:
    mesh = box([1.0] * (3 if measure == "solid" else 2), [3] * (3 if measure == "solid" else 2), jitter=0.2)
    return TaylorHood(mesh.nodes, mesh.elements, measure)


@pytest.mark.parametrize("measure", MEASURES)
def test_weights_add_up_to_the_volume(measure):
    assert_close(space_of(measure).volume_points().weights.sum(), MEASURES[measure], 1e-13)


def test_an_axisymmetric_volume_without_its_circumference_is_seen():
    with pytest.raises(AssertionError):
        assert_close(space_of("plane_strain").volume_points().weights.sum(), MEASURES["axisymmetric"], 1e-13)


@pytest.mark.parametrize("measure", MEASURES)
def test_quadratic_fields_have_exact_gradients(measure):
    space = space_of(measure)
    points, x = space.volume_points(), space.nodes
    field = (x**2 + x[:, :1] * x[:, 1:2])[:, 0]
    place = np.einsum("qa,ead->deq", points.values, x[space.elements])
    expected = np.zeros((space.dim, *points.weights.shape))
    expected[0], expected[1] = 2 * place[0] + place[1], place[0]
    assert_close(np.einsum("ea,eqaj->jeq", field[space.elements], points.gradients), expected, 1e-13)
    if measure == "axisymmetric":
        assert_close(np.einsum("ea,eqa->eq", field[space.elements], points.hoop), place[0] + place[1], 1e-13)
    else:
        assert not points.hoop.any()


@pytest.mark.parametrize(("measure", "area"), [("axisymmetric", 2 * np.pi), ("plane_strain", 1.0), ("solid", 1.0)])
def test_surface_weights_add_up_to_the_area_of_the_outer_side(measure, area):
    space = space_of(measure)
    mesh = box([1.0] * space.dim, [3] * space.dim, jitter=0.2)
    points = space.surface_points(facets_where(mesh, on_plane(0, 1.0)))
    assert_close(points.weights.sum(), area, 1e-13)
    assert_close(points.normals, np.eye(space.dim)[0][:, None], 1e-13)


@pytest.mark.parametrize("measure", MEASURES)
def test_unknowns_split_into_views(measure):
    space = space_of(measure)
    unknowns = np.arange(space.size, dtype=float)
    u, p = space.split(unknowns)
    assert u.shape == space.nodes.shape
    assert len(p) == space.corner_count
    p[0] = -1.0
    assert unknowns[space.displacement_size] == -1.0


def test_meshes_of_the_wrong_dimension_are_refused():
    mesh = box([1.0, 1.0], [2, 2])
    with pytest.raises(InputError, match=r"a solid body needs nodes \(n, 3\)"):
        TaylorHood(mesh.nodes, mesh.elements, "solid")
    with pytest.raises(InputError, match=r"elements \(E, 6\)"):
        TaylorHood(mesh.nodes, mesh.elements[:, :3], "plane_strain")


def test_an_axisymmetric_mesh_across_the_axis_is_refused():
    mesh = box([1.0, 1.0], [2, 2])
    with pytest.raises(InputError, match="r >= 0"):
        TaylorHood(mesh.nodes - 0.5, mesh.elements, "axisymmetric")


@pytest.mark.parametrize("regions", [np.zeros(3, int), np.full(8, 1), np.full(8, -1)])
def test_regions_without_a_material_are_refused(regions):
    mesh = box([1.0, 1.0], [2, 2])
    with pytest.raises(InputError, match="one of 1 materials for each of 8 elements"):
        Body(TaylorHood(mesh.nodes, mesh.elements, "plane_strain"), [MooneyRivlin2.example()], regions)
