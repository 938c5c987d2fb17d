"""Rings of graded cells around tubes: sound for every form that is served, mirrored where the block is, the same every time."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from lumps import CURVED, SIZE, same_mirrored

from tactsim.errors import InputError
from tactsim.mechanics.models.any_block_source import AutomaticSource
from tactsim.mechanics.models.block_source import GradedSource
from tactsim.mesh.block import BlockMeshSettings
from tactsim.mesh.fitting.labelling import Surfaces, interfaces
from tactsim.mesh.fitting.wedges import side_patches
from tactsim.mesh.graded import block as graded_module
from tactsim.mesh.graded.block import graded_block, graded_misfit
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.tube import Tube
from tactsim.mesh.mesh_store import content_hash

VOLUMES = 1.2e-3
"""Largest error of a volume: 5e-5 for tubes, whose sections are sixteen quadratic arcs, 1e-3 for a small ball of four cells."""


def tube(*line, bore=4.0, wall=0.6):
    """A tube by points, bore and wall in mm."""
    points = tuple(tuple(1e-3 * value for value in point) for point in line)
    return Tube(centre_line=points, inner_radius=1e-3 * bore, wall=1e-3 * wall)


CENTRED = tube((0, 20, 10), (40, 20, 10))
BALL = Sphere(center=(22e-3, 30e-3, 8e-3), radius=3e-3)
FORMS = {
    "centred": [CENTRED],
    "leaning": [tube((0, 9, 8), (40, 31, 12), bore=3, wall=1)],
    "given from right to left": [tube((40, 12, 8), (0, 16, 10), bore=3)],
    "along y": [tube((20, 0, 10), (22, 40, 11), bore=3, wall=1)],
    "from jaw to jaw": [tube((20, 20, 0), (22, 25, 20), bore=3, wall=1)],
    "thick": [tube((0, 15, 14), (40, 15, 14), bore=1.5, wall=2.5)],
    "one end inside": [tube((20, 10, 12), (40, 10, 12))],
    "both ends inside": [tube((8, 20, 10), (30, 20, 10), bore=3, wall=1)],
    "leaning ends inside": [tube((32, 12, 8), (8, 28, 12), bore=3, wall=1)],
    "bent": [tube((0, 12, 8), (20, 24, 11), (40, 16, 10), bore=3, wall=1)],
    "two": [tube((0, 28, 8), (40, 31, 8)), tube((0, 10, 12), (40, 10, 12))],
    "lump beside": [BALL, tube((0, 12, 10), (40, 18, 9), bore=3)],
    "lump between two": [
        tube((0, 32, 8), (40, 33, 8), bore=2),
        Sphere(center=(20e-3, 20e-3, 9e-3), radius=3e-3),
        tube((0, 8, 10), (40, 9, 9), bore=2),
    ],
}


def wedges(mesh, inclusions):
    """Number of tetrahedra with a side under a jaw and one in a free face."""
    extent = np.array(SIZE)
    surfaces = Surfaces(extent, [inclusion.solids(extent) for inclusion in inclusions])
    walls = interfaces(mesh.nodes[: mesh.corner_count], mesh.elements[:, :4], mesh.regions, surfaces)
    patches = side_patches(mesh.elements[:, :4], walls)
    return int((np.isin(patches, [4, 5]).any(axis=1) & np.isin(patches, [0, 1, 2, 3]).any(axis=1)).sum())


QUICK = ("centred", "leaning", "bent", "both ends inside", "lump between two")
"""Forms that between them have all that the others have."""


@functools.cache
def meshed(name):
    """The block around a form, shared by the tests that look at it."""
    return GradedSource().sourced(SIZE, FORMS[name]).block


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in FORMS])
def test_each_form_is_meshed_soundly(name):
    block = meshed(name)
    assert np.abs(block.volume_errors).max() < VOLUMES
    assert block.quality.minimum > 0.05
    assert block.quality.curvature > 0.2
    assert block.quality.straightened == 0
    assert wedges(block.mesh, FORMS[name]) == 0
    extent = np.array(SIZE)
    surfaces = Surfaces(extent, [inclusion.solids(extent) for inclusion in FORMS[name]])
    places = block.mesh.nodes[block.mesh.elements[:, :4]].mean(axis=1)
    np.testing.assert_array_equal(surfaces.labels(places), block.mesh.regions)
    for number, inclusion in enumerate(FORMS[name], 1):
        assert (f"lumen:{number}" in block.facets) == inclusion.hollow


def test_cells_split_in_any_order_would_make_wedges(monkeypatch):
    generator = np.random.default_rng(1)
    monkeypatch.setattr(graded_module, "_order", lambda places: generator.permutation(len(places)))
    assert wedges(graded_block(SIZE, [CENTRED]).mesh, [CENTRED]) > 0


def test_a_centred_tube_has_a_mirrored_mesh_and_another_has_none():
    mesh = meshed("centred").mesh
    assert all(same_mirrored(mesh, axis) for axis in range(3))
    aside = graded_block(SIZE, [tube((0, 20, 10.5), (40, 20, 10.5))]).mesh
    assert [same_mirrored(aside, axis) for axis in range(3)] == [True, True, False]


@pytest.mark.slow
def test_a_tube_that_ends_as_far_from_either_face_has_a_mirrored_mesh():
    mesh = graded_block(SIZE, [tube((10, 20, 10), (30, 20, 10), bore=2)]).mesh
    assert all(same_mirrored(mesh, axis) for axis in range(3))


def test_the_same_tube_has_the_same_mesh():
    first, again = meshed("leaning"), GradedSource().sourced(SIZE, FORMS["leaning"]).block
    assert content_hash(first.mesh) == content_hash(again.mesh)


def test_the_bore_is_as_exact_as_its_arcs_are():
    errors, around = [], (16, 24)
    for size in (2.6e-3, 1.3e-3):
        block = GradedSource(inclusion_size=size).sourced(SIZE, [CENTRED]).block
        errors.append(abs(block.volume_errors[1]))
    order = np.log(errors[0] / errors[1]) / np.log(around[1] / around[0])
    assert order == pytest.approx(4, abs=0.1)  # of the area of a circle of quadratic arcs


@pytest.mark.parametrize(
    ("inclusions", "words"),
    [
        ([tube((0, 10, 10), (20, 20, 10), (32, 40, 10), bore=2)], "tubes that lead along x, y or z"),
        ([tube((0, 20, 10), (40, 20, 10), bore=2), Sphere(center=(20e-3, 23.5e-3, 13.5e-3), radius=2e-3)], "side by side"),
        ([tube((20, 10, 12), (40, 10, 12)), Sphere(center=(20e-3, 25e-3, 10e-3), radius=3e-3)], "not beside the end of one"),
        ([CENTRED, *(Sphere(center=(x, 33e-3, 10e-3), radius=2e-3) for x in (10e-3, 30e-3))], "one lump beside tubes"),
    ],
)
def test_what_rings_cannot_follow_is_told_and_gets_tetrahedra(inclusions, words):
    misfit = graded_misfit(SIZE, inclusions, [], BlockMeshSettings())
    assert misfit is not None
    assert words in misfit
    with pytest.raises(InputError, match=words):
        graded_block(SIZE, inclusions)
    assert AutomaticSource().chosen(SIZE, inclusions).kind == "tetrahedra"


@pytest.mark.parametrize("inclusions", [[CENTRED], [CURVED], FORMS["lump beside"]])
def test_tubes_get_rings_by_themselves(inclusions):
    assert AutomaticSource().chosen(SIZE, inclusions).kind == "graded"
    beside = np.array([[2e-3, 2e-3], [38e-3, 4e-3]])
    assert AutomaticSource().chosen(SIZE, inclusions, [beside]).kind == "tetrahedra"
