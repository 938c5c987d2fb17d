"""Grids of cells: their volumes, their faces and where their nodes lie."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import InputError
from tactsim.experiments.boundary_value.geometry import (
    BallGeometry,
    BlockGeometry,
    CylinderGeometry,
    QuadrilateralGeometry,
    Span,
)
from tactsim.fem.assembly.space import TaylorHood
from tactsim.mesh.graded.mapped import grid_domain, spaced

MEASURES = {"3d": "solid", "plane_strain": "plane_strain", "axisymmetric": "axisymmetric"}


def spans(length: float, cells: int, ratio: float = 1.0) -> tuple[Span, ...]:
    return (Span(length=length, cells=cells, ratio=ratio),)


BLOCK = BlockGeometry(x=spans(2.0, 2), y=spans(3.0, 2, 2.0))
BRICK = BlockGeometry(x=spans(2.0, 2), y=spans(3.0, 2, 2.0), z=spans(0.5, 1))
ROD = {"radial": spans(1.0, 4), "around": 6}
QUADRILATERAL = QuadrilateralGeometry(corners=((0, 0), (48, 44), (48, 60), (0, 44)), cells=(3, 2))
BODIES = {
    "block": (BLOCK, "plane_strain", 6.0, 0.0),
    "brick": (BRICK, "3d", 3.0, 0.0),
    "quadrilateral": (QUADRILATERAL, "plane_strain", 48 * (44 + 16) / 2, 0.0),
    "cylinder, axisymmetric": (CylinderGeometry(**ROD, axial=spans(2.0, 2)), "axisymmetric", 2 * np.pi, 0.0),
    "cylinder, quarter": (CylinderGeometry(**ROD, axial=spans(2.0, 2)), "3d", np.pi / 2, 1e-4),
    "cylinder, half": (CylinderGeometry(**ROD, axial=spans(2.0, 2), part="half"), "3d", np.pi, 1e-4),
    "cylinder, whole": (CylinderGeometry(**ROD, axial=spans(2.0, 2), part="whole"), "3d", 2 * np.pi, 1e-4),
    "disc": (CylinderGeometry(**ROD), "plane_strain", np.pi / 4, 1e-4),
    "disc, half": (CylinderGeometry(**ROD, part="half"), "plane_strain", np.pi / 2, 1e-4),
    "disc, whole": (CylinderGeometry(**ROD, part="whole"), "plane_strain", np.pi, 1e-4),
    "tube": (CylinderGeometry(**ROD, inner_radius=1.0), "plane_strain", 3 * np.pi / 4, 1e-4),
    "tube, half": (CylinderGeometry(**ROD, inner_radius=1.0, part="half"), "plane_strain", 3 * np.pi / 2, 1e-4),
    "tube, whole": (CylinderGeometry(**ROD, inner_radius=1.0, part="whole"), "plane_strain", 3 * np.pi, 1e-4),
    "ball, axisymmetric": (BallGeometry(**ROD), "axisymmetric", 2 * np.pi / 3, 1e-4),
    "ball, quarter": (BallGeometry(**ROD), "3d", np.pi / 6, 3e-4),
    "hollow sphere": (BallGeometry(**ROD, inner_radius=1.0), "axisymmetric", 14 * np.pi / 3, 1e-4),
}
"""Name -> geometry, dimension, exact volume, and the part by which parabolas miss it."""


@pytest.mark.parametrize("name", BODIES)
def test_the_volume_is_that_of_the_body(name):
    geometry, dimension, volume, tolerance = BODIES[name]
    mesh = geometry.domain(dimension).mesh
    weights = TaylorHood(mesh.nodes, mesh.elements, MEASURES[dimension]).volume_points().weights
    assert weights.sum() == pytest.approx(volume, rel=max(tolerance, 1e-12))


@pytest.mark.parametrize("name", BODIES)
def test_named_faces_close_the_surface(name):
    geometry, dimension, _, _ = BODIES[name]
    domain = geometry.domain(dimension)
    boundary, _ = domain.mesh.boundary_facets()
    named = {tuple(sorted(facet)) for facets in domain.faces.values() for facet in facets}
    count = sum(len(facets) for facets in domain.faces.values())
    assert count == len(named)  # no facet has two names
    assert named <= {tuple(sorted(facet)) for facet in boundary}
    if dimension != "axisymmetric" or "axis" in domain.faces or geometry.inner_radius:
        assert count == len(boundary)
    for face, axis in domain.mirrors.items():
        assert np.abs(domain.mesh.nodes[np.unique(domain.faces[face]), axis]).max() == 0.0


@pytest.mark.parametrize("name", ["tube", "tube, half", "tube, whole"])
def test_round_faces_lie_on_their_circles(name):
    domain = BODIES[name][0].domain("plane_strain")
    for face, radius in (("inner", 1.0), ("outer", 2.0)):
        places = domain.mesh.nodes[np.unique(domain.faces[face])]
        np.testing.assert_allclose(np.hypot(*places.T), radius, rtol=1e-12)


def test_no_element_has_all_its_corners_on_the_boundary():
    for name in ("block", "brick", "tube", "tube, whole", "disc, whole"):
        geometry, dimension, _, _ = BODIES[name]
        mesh = geometry.domain(dimension).mesh
        outside = np.unique(mesh.boundary_facets()[0])
        corners = mesh.elements[:, : mesh.dim + 1]
        assert not np.isin(corners, outside).all(axis=1).any()


def test_a_whole_ring_is_closed_where_it_begins():
    """Every corner of the mesh is one node, on whichever side of the beginning the elements lie."""
    mesh = BODIES["tube, whole"][0].domain("plane_strain").mesh
    assert len(np.unique(mesh.nodes.round(9), axis=0)) == len(mesh.nodes)
    assert np.array_equal(np.unique(mesh.elements), np.arange(len(mesh.nodes)))


def test_cells_grow_evenly_to_the_ratio():
    steps = np.diff(spaced(3.0, 5, 16.0))
    assert steps.sum() == pytest.approx(3.0, rel=1e-14)
    np.testing.assert_allclose(steps[1:] / steps[:-1], 2.0, rtol=1e-12)


def test_too_many_cells_are_refused():
    line = np.linspace(0, 1, 1000)
    with pytest.raises(InputError, match=r"cells \[999, 999, 999\]"):
        grid_domain((line, line, line), (("a", "b"), ("c", "d"), ("e", "f")))


def test_too_many_sectors_are_refused():
    rod = CylinderGeometry(radial=spans(1.0, 100), axial=spans(1.0, 100), around=100, part="whole")
    with pytest.raises(InputError, match=r"around it: about 2\.1e"):
        rod.domain("3d")


@pytest.mark.parametrize(
    ("geometry", "dimension", "words"),
    [
        (BLOCK, "axisymmetric", "a block has no axis"),
        (BLOCK, "3d", "geometry.z"),
        (BRICK, "plane_strain", "geometry.z"),
        (CylinderGeometry(**ROD), "axisymmetric", "geometry.axial"),
        (BallGeometry(**ROD), "plane_strain", "a ball has no section"),
        (QUADRILATERAL, "3d", "plane_strain only"),
        (QUADRILATERAL.model_copy(update={"corners": QUADRILATERAL.corners[::-1]}), "plane_strain", "counterclockwise"),
    ],
)
def test_a_geometry_without_this_dimension_says_so(geometry, dimension, words):
    with pytest.raises(ValueError, match=words):
        geometry.domain(dimension)
