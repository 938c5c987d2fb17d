"""Graded cells around one lump: conforming, thin at the faces, sound wherever the lump lies, and the same every time."""

from __future__ import annotations

import re

import numpy as np
import pytest
from lumps import assert_sound, irregular, same_mirrored, write_cells
from scipy.spatial import KDTree

from tactsim.errors import ConvergenceError, InputError, InvalidQuantity
from tactsim.mechanics.models.block_source import GradedSource
from tactsim.mesh.block import VOLUME_TOLERANCE, BlockMeshSettings
from tactsim.mesh.fitting.layers import Layers
from tactsim.mesh.graded import block as graded_module
from tactsim.mesh.graded import bricks
from tactsim.mesh.graded.block import graded_block, graded_misfit
from tactsim.mesh.graded.cells import LAYER_GROWTH, LEAST_LAYERS, Filling
from tactsim.mesh.inclusions.ellipsoid import Ellipsoid
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.surface import Surface
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.mesh_store import content_hash

SIZE = (40e-3, 40e-3, 20e-3)
CENTRED = Sphere(center=(20e-3, 20e-3, 10e-3), radius=5e-3)
COARSE = BlockMeshSettings(size=6e-3, inclusion_size=5e-3, edge_size=1.6e-3, growth=1.0)


def random_lumps(count):
    generator = np.random.default_rng(5)
    for _ in range(count):
        radius = generator.uniform(2e-3, 7e-3)
        room = np.array(SIZE) - 2 * (radius + 0.6e-3)
        yield Sphere(center=tuple(radius + 0.6e-3 + generator.random(3) * room), radius=radius)


SOME = pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.slow)])


@SOME
def test_lumps_anywhere_are_meshed_soundly(count):
    for lump in random_lumps(count):
        block = graded_block(SIZE, [lump], COARSE)
        assert_sound(block)
        assert 8_000 < block.unknowns < 52_000


def test_cells_are_thin_at_the_faces_and_thicker_inside():
    block = graded_block(SIZE, (), COARSE)
    for axis in range(3):
        steps = np.diff(np.unique(block.mesh.nodes[:, axis].round(12)))[::2] * 2
        assert steps[0] == pytest.approx(COARSE.edge_size)
        assert steps[len(steps) // 2] > 1.5 * steps[0]
        np.testing.assert_allclose(steps, steps[::-1], rtol=1e-6)
    assert block.region_names == ("tissue",)


def first_corner(points, x):
    """Height of the lowest corner or middle above the bottom at ``x`` m on the face ``y = 0``, and that of the next."""
    column = points[(np.abs(points[:, 0] - x) < 1e-9) & (points[:, 1] == 0), 2]
    return np.unique(column.round(9))[1:3]


@pytest.mark.parametrize("gap", [0.7e-3, 1.2e-3, 1.4e-3, 1.9e-3])
def test_no_layer_of_cells_at_the_edge_of_a_pressed_face_is_thinner_than_elsewhere(gap):
    lump = Sphere(center=(20e-3, 20e-3, 5e-3 + gap), radius=5e-3)
    nodes = graded_block(SIZE, [lump], COARSE).mesh.nodes
    _, top = first_corner(nodes, 0.0)
    assert top > COARSE.edge_size - 1e-9


@pytest.mark.parametrize(("gap", "cells"), [(1.2e-3, 3), (1.4e-3, 4), (1.9e-3, 4)])
def test_the_gap_between_a_jaw_and_a_lump_has_a_cell_more_than_layers_unless_it_is_thin(gap, cells):
    lump = Sphere(center=(20e-3, 20e-3, 5e-3 + gap), radius=5e-3)
    even = COARSE.model_copy(update={"inclusion_size": 1.3e-3})  # six across, so that a corner lies on the pole
    nodes = graded_block(SIZE, [lump], even).mesh.nodes
    above = np.unique(nodes[(np.abs(nodes[:, :2] - 20e-3) < 1e-9).all(axis=1), 2].round(9))
    assert (above <= gap + 1e-9).sum() == 1 + 2 * cells  # corners and middles


def test_a_centred_lump_has_a_mirrored_mesh_if_the_number_across_is_even():
    even = graded_block(SIZE, [CENTRED], COARSE.model_copy(update={"inclusion_size": 2e-3})).mesh
    assert all(same_mirrored(even, axis) for axis in range(3))
    odd = graded_block(SIZE, [CENTRED], COARSE.model_copy(update={"inclusion_size": 1.6e-3})).mesh
    assert not all(same_mirrored(odd, axis) for axis in range(3))


def test_the_same_lump_has_the_same_mesh_and_another_has_another():
    first, again = (graded_block(SIZE, [CENTRED], COARSE) for _ in range(2))
    other = graded_block(SIZE, [Sphere(center=(20e-3, 20.1e-3, 10e-3), radius=5e-3)], COARSE)
    assert content_hash(first.mesh) == content_hash(again.mesh) != content_hash(other.mesh)
    assert first.key == again.key != other.key


def test_layers_around_a_lump_bulge_with_it_so_that_none_of_its_edges_stays_straight(monkeypatch):
    close = Sphere(center=(20e-3, 20e-3, 13.5e-3), radius=5e-3)
    bulging = graded_block(SIZE, [close], COARSE)
    assert bulging.quality.straightened == 0
    monkeypatch.setattr(Layers, "bulges", lambda self, nodes, edges, constraints: NO_BULGES)
    flat = graded_block(SIZE, [close], COARSE)
    assert flat.quality.straightened > 0
    assert flat.quality.curvature < bulging.quality.curvature


NO_BULGES = np.zeros(0, np.int64), np.zeros((0, 2), np.int64), np.zeros((0, 3))


def test_smaller_cells_make_more_layers():
    wall, box = np.zeros((4, 3)), np.full((4, 3), [0.0, 0.0, 4e-3])
    assert len(Filling(COARSE).ends(wall, box)) == LEAST_LAYERS - 1
    ends = Filling(COARSE.model_copy(update={"inclusion_size": 0.5e-3})).ends(wall, box)
    assert len(ends) == LEAST_LAYERS  # 0.5 + 0.63 + 0.78 + 0.98 mm
    steps = np.diff([0.0, *ends, 1.0])
    np.testing.assert_allclose(steps[1:] / steps[:-1], LAYER_GROWTH)
    assert len(Filling(COARSE, fewer=2).ends(wall, box)) == 0


def test_a_turned_ellipsoid_is_followed():
    turned = Ellipsoid(center=(18e-3, 21e-3, 9e-3), semi_axes=(6e-3, 4e-3, 3e-3), rotation=(0.3, 0.2, 0.7))
    block = graded_block(SIZE, [turned], COARSE)
    assert abs(block.volume_errors[1]) < VOLUME_TOLERANCE


def test_what_cannot_be_meshed_is_refused_by_name(tmp_path, monkeypatch):
    for number in ("ATTEMPTS", "LEAST_LAYERS"):  # all of them are tried below
        monkeypatch.setattr(graded_module, number, 1)
    vertices, faces = irregular()
    path = write_cells(tmp_path / "free.stl", vertices, triangle=faces)
    free = Surface(path=str(path), unit="mm", translation=(20e-3, 20e-3, 10e-3))
    with pytest.raises(
        InputError, match="surface cannot be meshed in graded cells; allowed: a ball, stretched or not, or a tube"
    ):
        graded_block(SIZE, [free], COARSE)
    needle = Ellipsoid(center=(20e-3, 20e-3, 10e-3), semi_axes=(15e-3, 0.2e-3, 0.2e-3))
    words = (
        r"no graded cells suit ellipsoid 1: .*; take a larger mesh\.inclusion_size for the thin ellipsoid 1, or mesh\.kind: tetra"
    )
    with pytest.raises(ConvergenceError, match=words):
        graded_block(SIZE, [needle], COARSE)
    askew = [CENTRED, Sphere(center=(27e-3, 27e-3, 14e-3), radius=3e-3), Sphere(center=(27e-3, 13e-3, 6e-3), radius=3e-3)]
    with pytest.raises(InputError, match="along x, y or z one of each two must end before the other begins"):
        GradedSource(kind="graded").sourced(SIZE, askew)
    with pytest.raises(InvalidQuantity, match="protrudes"):
        graded_block(SIZE, [Sphere(center=(20e-3, 20e-3, 3e-3), radius=5e-3)], COARSE)


BENT = Tube(centre_line=((17e-3, 0.0, 10e-3), (24e-3, 20e-3, 12e-3), (17e-3, 40e-3, 8e-3)), inner_radius=2.4e-3, wall=0.6e-3)
LONG = Ellipsoid(center=(20e-3, 20e-3, 10e-3), semi_axes=(12e-3, 1e-3, 1e-3))


@pytest.mark.parametrize(
    ("inclusions", "words", "better"),
    [
        (
            [LONG],
            "; take a larger mesh.inclusion_size for the thin ellipsoid 1, or mesh.kind: tetrahedra",
            {"inclusion_size": 4e-3},
        ),
        ([BENT], "allowed: 0.5 %; take a smaller mesh.size for the bends of tube 1, or mesh.kind: tetrahedra", {"size": 3e-3}),
        ([Sphere(center=(20e-3, 20e-3, 10e-3), radius=6e-3), Sphere(center=(27e-3, 20e-3, 10e-3), radius=0.5e-3)], None, {}),
    ],
    ids=["long", "bent", "large and small"],
)
@pytest.mark.parametrize("once", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_refusal_names_the_size_of_cells_that_would_suit(inclusions, words, better, once, monkeypatch):
    """Sizes half or twice as large do suit; where none of those that were tried did, tetrahedra alone are named."""
    for number in ("ATTEMPTS", "LEAST_LAYERS") if once else ():
        monkeypatch.setattr(graded_module, number, 1)
    usual = GradedSource().settings(SIZE)
    with pytest.raises(ConvergenceError, match=re.escape(words or "allowed: 0.02; take mesh.kind: tetrahedra")):
        graded_block(SIZE, inclusions, usual)
    if better:
        graded_block(SIZE, inclusions, usual.model_copy(update=better))


def random_pairs(count):
    generator = np.random.default_rng(3)
    while count:
        centers = generator.uniform((9e-3, 9e-3, 7e-3), (16e-3, 31e-3, 13e-3), (2, 3)) + np.outer([0, 1], [15e-3, 0, 0])
        radii = generator.uniform(3e-3, 6e-3, 2)
        if np.linalg.norm(centers[1] - centers[0]) - radii.sum() > 1.2e-3:
            count -= 1
            yield [Sphere(center=tuple(center), radius=radius) for center, radius in zip(centers, radii, strict=True)]


SWEPT = BlockMeshSettings(size=8e-3, inclusion_size=4e-3, edge_size=2.2e-3, growth=1.0)


@SOME
def test_two_lumps_as_sweeps_draw_them_are_meshed_soundly(count):
    for pair in random_pairs(count):
        block = graded_block(SIZE, pair, SWEPT)
        assert_sound(block)


def test_bodies_too_close_for_all_layers_have_fewer_and_the_mesh_says_so():
    near = [
        Sphere(center=(14.6e-3, 25.4e-3, 12.7e-3), radius=4.35e-3),
        Sphere(center=(24.6e-3, 28.8e-3, 10e-3), radius=5.06e-3),
    ]
    sourced = GradedSource(**SWEPT.model_dump(include={"size", "inclusion_size", "edge_size", "growth"})).sourced(SIZE, near)
    assert sourced.block.fewer_layers > 0
    assert "fewer than usual around inclusions close to each other" in sourced.origin
    alone = GradedSource().sourced(SIZE, [CENTRED])
    assert (alone.block.fewer_layers, alone.origin) == (0, "graded cells")


@pytest.mark.parametrize("axis", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_lumps_in_a_row_keep_their_numbers_and_places(axis):
    places = np.full((3, 3), [20e-3, 20e-3, 10e-3])
    places[:, axis] = np.array([0.75, 0.2, 0.45]) * SIZE[axis]
    lumps = [Sphere(center=tuple(place), radius=(1.5e-3, 2e-3, 1.8e-3)[k]) for k, place in enumerate(places)]
    block = graded_block(SIZE, lumps, COARSE)
    centres = block.mesh.nodes[block.mesh.elements[:, 4:]].mean(axis=1)  # of curved elements
    for number, lump in enumerate(lumps, 1):
        inside = np.linalg.norm(centres - lump.center, axis=1) < lump.radius
        np.testing.assert_array_equal(block.mesh.regions == number, inside)


LUMPS = {
    "corner": [(10, 10, 10), (30, 10, 10), (30, 30, 10)],
    "askew corner": [(10, 12, 9), (30, 9, 12), (27, 30, 10)],
    "square": [(10, 10, 10), (30, 10, 10), (30, 30, 10), (10, 30, 10)],
    "one above, one beside": [(12, 20, 14.5), (12, 20, 5.5), (30, 20, 14.5)],
    "cube": [(x, y, z) for x in (10, 30) for y in (10, 30) for z in (5, 15)],
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in ("square", "cube") else ()) for name in LUMPS]
)
def test_lumps_in_no_row_fill_bricks(name):
    lumps = [Sphere(center=tuple(1e-3 * np.array(place)), radius=3e-3) for place in LUMPS[name]]
    assert graded_misfit(SIZE, lumps, [], COARSE) is None
    block = graded_block(SIZE, lumps, COARSE)
    assert np.abs(block.volume_errors).max() < VOLUME_TOLERANCE
    assert block.quality.minimum > 0.1
    centres = block.mesh.nodes[block.mesh.elements[:, 4:]].mean(axis=1)
    for number, lump in enumerate(lumps, 1):
        np.testing.assert_array_equal(block.mesh.regions == number, np.linalg.norm(centres - lump.center, axis=1) < lump.radius)


def strayed(image, nodes):
    """Part of the nodes (n, 3) whose images are no nodes."""
    return (KDTree(nodes).query(image)[0] > 1e-9).mean()


def test_two_lumps_on_a_diagonal_have_a_mesh_that_is_its_own_image_unless_planes_lean(monkeypatch):
    pair = [Sphere(center=(10e-3, 10e-3, 10e-3), radius=4e-3), Sphere(center=(30e-3, 30e-3, 10e-3), radius=4e-3)]
    settings = BlockMeshSettings(size=4e-3, inclusion_size=1.6e-3, edge_size=3.6e-3, growth=1.0)
    nodes = graded_block(SIZE, pair, settings).mesh.nodes
    assert strayed(SIZE - nodes, nodes) == 0
    assert strayed(nodes[:, [1, 0, 2]], nodes) < 5e-3, "in the diagonal plane, but for the middles of some cut sides"
    monkeypatch.setattr(bricks, "LEAN", np.inf)
    nodes = graded_block(SIZE, pair, settings).mesh.nodes
    assert strayed(nodes[:, [1, 0, 2]], nodes) > 0.5


def test_a_row_that_leans_much_has_level_planes_and_one_that_leans_little_has_not():
    def heights(lean):
        pair = [
            Sphere(center=(10e-3, 20e-3 - lean, 10e-3), radius=3e-3),
            Sphere(center=(30e-3, 20e-3 + lean, 10e-3), radius=3e-3),
        ]
        nodes = graded_block(SIZE, pair, COARSE).mesh.nodes
        return [np.unique(nodes[(nodes[:, 0] == end) & (nodes[:, 2] == 0), 1].round(9)) for end in (0.0, SIZE[0])]

    np.testing.assert_allclose(*heights(10e-3), atol=1e-9)
    left, right = heights(4e-3)
    assert np.abs(left - right).max() > 1e-3


@pytest.mark.parametrize("lean", [0.0, 6e-3])
def test_a_row_across_which_a_plane_mirrors_has_a_mesh_that_it_mirrors(lean):
    pair = [Sphere(center=(20e-3 + side * 9e-3, 20e-3 + side * lean, 10e-3), radius=4e-3) for side in (-1, 1)]
    mesh = graded_block(SIZE, pair, COARSE.model_copy(update={"inclusion_size": 1.6e-3})).mesh
    assert same_mirrored(mesh, 2)
    assert same_mirrored(mesh, 1) == (lean == 0)
