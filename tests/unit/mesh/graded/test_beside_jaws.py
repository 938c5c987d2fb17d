"""Graded cells between jaws that are smaller than the block: thin on both sides of the edges of their flats."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from lumps import assert_sound, same_mirrored

from tactsim.errors import InputError
from tactsim.mechanics.models.block_source import GradedSource, TetrahedraSource
from tactsim.mesh.block import VOLUME_TOLERANCE, BlockMeshSettings
from tactsim.mesh.graded.beside_jaws import THINNER, footprint_of
from tactsim.mesh.graded.block import graded_block, graded_misfit
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.mesh_store import content_hash

SIZE = (40e-3, 40e-3, 20e-3)
COARSE = BlockMeshSettings(size=6e-3, inclusion_size=5e-3, edge_size=1.6e-3, growth=1.0)
THIN = THINNER * 1.6e-3
CENTRED = Sphere(center=(20e-3, 20e-3, 10e-3), radius=5e-3)


def flat(x, y):
    """A flat from x[0] to x[1] mm and from y[0] to y[1] mm."""
    return np.array([x, y]).T * 1e-3


def tube(*points):
    return Tube(centre_line=tuple(tuple(1e-3 * c for c in point) for point in points), inner_radius=2e-3, wall=0.6e-3)


NARROW, OFFSET, WIDER, WIDE = flat((10, 30), (8, 32)), flat((12, 33), (9, 30)), flat((5, 35), (4, 36)), flat((-5, 45), (-5, 45))
INCLUSIONS = {
    "plain": [],
    "ball": [CENTRED],
    "balls": [Sphere(center=(15e-3, 20e-3, 10e-3), radius=3e-3), Sphere(center=(25e-3, 20e-3, 10e-3), radius=3e-3)],
    "artery": [tube((0, 20, 10), (40, 20, 10))],
    "ending": [tube((16, 20, 10), (40, 20, 10))],
    "across": [tube((20, 0, 10), (20, 40, 10))],
    "upright": [tube((20, 20, 0), (20, 20, 20))],
    "leaning": [tube((0, 18, 10), (40, 22, 12))],
    "beside": [tube((0, 15, 10), (40, 15, 10)), Sphere(center=(20e-3, 24e-3, 10e-3), radius=3e-3)],
}


QUICK = ("plain", "ball", "artery", "ending", "leaning", "beside")
"""With and without a lump, with tubes of each kind: ``balls`` are meshed as ``ball``, the other tubes as ``artery``."""


def planes(block, axis):
    """Ascending places in m of the planes across an axis that hold many nodes of the free faces."""
    on_faces = np.unique(np.concatenate([block.facets["upper"], block.facets["lower"]]))
    return np.unique(block.mesh.nodes[on_faces, axis].round(9))


@cache
def narrow(name):
    """The block between two small jaws, shared by the tests that look at it."""
    return graded_block(SIZE, INCLUSIONS[name], COARSE, [NARROW, NARROW])


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in INCLUSIONS])
def test_cells_are_thin_at_the_edges_of_a_flat(name):
    block = narrow(name)
    assert_sound(block)
    for axis, ends in enumerate(((10e-3, 30e-3), (8e-3, 32e-3))):
        places = planes(block, axis)
        for end in ends:
            assert np.abs(places - end).min() < 1e-9
            for outside in (end - 2 * THIN, end + 2 * THIN):
                between = places[(places > min(end, outside) + 1e-9) & (places < max(end, outside) - 1e-9)]
                assert len(between) >= 2, "an edge and its middle, at least"


@pytest.mark.parametrize(
    "name", ["plain", "ball", "artery", *(pytest.param(name, marks=pytest.mark.slow) for name in ("across", "upright"))]
)
def test_what_mirrors_itself_has_a_mesh_that_does(name):
    mesh = narrow(name).mesh
    assert same_mirrored(mesh, 0)
    assert same_mirrored(mesh, 1)


def test_flats_that_cover_the_block_change_nothing():
    without, covered = (graded_block(SIZE, [CENTRED], COARSE, flats) for flats in ((), [WIDE, WIDE]))
    assert content_hash(covered.mesh) == content_hash(without.mesh)
    assert covered.key == without.key
    half = graded_block(SIZE, [CENTRED], COARSE, [WIDE, NARROW])
    assert half.key != without.key


def test_two_jaws_give_edges_each():
    footprint = footprint_of([NARROW, WIDER], np.array(SIZE), COARSE)
    np.testing.assert_allclose(footprint.thin[0], [5e-3, 10e-3, 30e-3, 35e-3])
    np.testing.assert_allclose(footprint.thin[1], [4e-3, 8e-3, 32e-3, 36e-3])
    below, above = footprint.beside[0]
    assert np.abs(below - 5e-3).min() < 1e-12
    np.testing.assert_allclose(above, SIZE[0] - below)
    assert below[-1] == 0
    pressed = footprint_of([NARROW, WIDE], np.array(SIZE), COARSE)
    np.testing.assert_allclose(pressed.thin[0], [0, 10e-3, 30e-3, 40e-3])
    steps = -np.diff(np.append(10e-3, pressed.beside[0][0]))
    np.testing.assert_allclose(steps, steps[::-1])
    assert steps[0] == pytest.approx(THIN)


def test_edges_close_to_each_other_or_to_a_face_are_one():
    nearly = flat((10.3, 29.7), (0.3, 39.7))
    footprint = footprint_of([flat((10, 30), (0.3, 39.7)), nearly], np.array(SIZE), COARSE)
    np.testing.assert_allclose(footprint.thin[0], [10.3e-3, 29.7e-3])
    np.testing.assert_allclose(footprint.thin[1], [0, 40e-3])


def test_the_part_between_offset_jaws_is_that_between_both():
    footprint = footprint_of([NARROW, OFFSET], np.array(SIZE), COARSE)
    np.testing.assert_allclose(footprint.low, [12e-3, 9e-3, 0])
    np.testing.assert_allclose(footprint.high, [30e-3, 30e-3, 20e-3])
    block = graded_block(SIZE, [CENTRED], COARSE, [NARROW, OFFSET])
    assert np.abs(block.volume_errors).max() <= VOLUME_TOLERANCE


@pytest.mark.parametrize(
    ("inclusions", "flats", "reason"),
    [
        ([], [flat((0, 15), (0, 40)), flat((25, 40), (0, 40))], "along x the flats"),
        ([Sphere(center=(30e-3, 20e-3, 10e-3), radius=4e-3)], [NARROW, NARROW], "between the flats of both jaws"),
        ([tube((0, 9, 10), (40, 9, 10))], [NARROW, NARROW], "between the flats of both jaws"),
        ([tube((0, 15, 10), (40, 15, 10)), Sphere(center=(30e-3, 25e-3, 10e-3), radius=3e-3)], [NARROW] * 2, "edge of a jaw"),
    ],
)
def test_what_no_cells_serve_is_refused(inclusions, flats, reason):
    assert reason in graded_misfit(SIZE, inclusions, flats, COARSE)
    with pytest.raises(InputError, match=reason):
        graded_block(SIZE, inclusions, COARSE, flats)


@pytest.mark.parametrize("name", ["plain", "ball", pytest.param("artery", marks=pytest.mark.slow)])
@pytest.mark.parametrize("flats", [[], [NARROW, OFFSET]], ids=["jaws that cover it", "narrow jaws"])
def test_a_small_block_has_the_cells_of_a_large_one(name, flats):
    """Sizes that nobody gives are in proportion to a block that is thinner than 20 mm."""
    tenth = [_tenth(body) for body in INCLUSIONS[name]]
    large = GradedSource().sourced(SIZE, INCLUSIONS[name], flats).block.mesh
    small = GradedSource().sourced(tuple(0.1 * np.array(SIZE)), tenth, [0.1 * flat for flat in flats]).block.mesh
    np.testing.assert_array_equal(small.elements, large.elements)
    np.testing.assert_allclose(small.nodes, 0.1 * large.nodes, rtol=0, atol=1e-9)


def test_cells_at_the_edges_of_narrow_flats_follow_these_and_not_what_a_case_gives():
    usual, narrow = GradedSource().settings(SIZE, [NARROW]), GradedSource().settings(SIZE, [NARROW, flat((16, 24), (10, 30))])
    assert (usual.edge_size, usual.size) == (1.6e-3, 6e-3)
    assert (narrow.edge_size, narrow.size) == (pytest.approx(0.64e-3), 6e-3)
    assert GradedSource(edge_size="1.2 mm").settings(SIZE, [flat((16, 24), (10, 30))]).edge_size == 1.2e-3
    tetrahedra = TetrahedraSource(size="5 mm").settings(SIZE, [flat((16, 24), (10, 30))])
    assert tetrahedra.edge_size == pytest.approx(0.4 * 2 / 3 * 5e-3)


def _tenth(body):
    """The same body at a tenth of its place and size."""
    lengths = body.model_dump(exclude={"kind"})
    return type(body).model_validate({name: (0.1 * np.array(length)).tolist() for name, length in lengths.items()})
