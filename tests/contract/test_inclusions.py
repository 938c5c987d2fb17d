"""Every registered inclusion, from its example: distance, inside, volume, bounds, measures, identity, round trip."""

from __future__ import annotations

import numpy as np
import pytest
from lumps import points_about
from pydantic import TypeAdapter
from scipy.spatial import cKDTree

from tactsim.interfaces import Inclusion
from tactsim.mesh.any_inclusion import AnyInclusion, check_inclusions
from tactsim.registry import kinds

BLOCK = np.array([40e-3, 40e-3, 20e-3])
KINDS = kinds(Inclusion)
EDGE = 0.4e-3
ADAPTER: TypeAdapter[Inclusion] = TypeAdapter(AnyInclusion)
every_kind = pytest.mark.parametrize("kind", sorted(KINDS))


@every_kind
def test_the_signed_distance_is_that_from_the_triangles(kind):
    """From samples no further apart than h, the distance d of the surface is seen as between d and the root of d^2 + h^2."""
    points = np.random.default_rng(2).uniform(-0.1, 1.1, (1500, 3)) * BLOCK
    for solid in KINDS[kind].example().solids(BLOCK):
        vertices, triangles = solid.triangles(EDGE)
        corners = vertices[triangles]
        samples = np.vstack([vertices, corners.mean(axis=1), corners[:, [0, 1, 2]].mean(axis=1)])
        spread = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max()
        seen, distance = cKDTree(samples).query(points)[0], solid.signed_distance(points)
        sagitta = 0.02 * EDGE + np.abs(solid.signed_distance(corners.mean(axis=1))).max()  # triangles are flat
        assert (np.abs(distance) <= seen + sagitta).all()
        assert (seen <= np.hypot(np.abs(distance) + sagitta, spread)).all()
        assert not (seen <= np.hypot(np.abs(distance / 2), spread)).all()  # half the distance is seen as wrong


@every_kind
def test_inside_has_the_volume(kind):
    for solid in KINDS[kind].example().solids(BLOCK):
        points, volume = points_about(solid, 4000)
        inside, distance = solid.inside(points), solid.signed_distance(points)
        assert (inside == (distance < 0))[np.abs(distance) > 1e-12].all()
        share = solid.volume() / volume
        tolerance = 5 * np.sqrt(share * (1 - share) / len(points))  # five standard deviations of a count
        assert abs(inside.mean() - share) < tolerance < abs(inside.mean() - 1.5 * share)


@every_kind
def test_the_bounds_hold_the_surface_tightly(kind):
    solid = KINDS[kind].example().solids(BLOCK)[0]
    vertices = solid.triangles(EDGE)[0]
    lowest, highest = solid.bounds()
    within = np.clip(vertices, lowest, highest)
    assert np.abs(vertices - within)[solid.bounds()[0][None].repeat(len(vertices), 0) > 0].max() < 1e-9
    assert ((lowest < highest) & (np.ptp(vertices, axis=0) > 0.9 * (np.minimum(highest, BLOCK) - np.maximum(lowest, 0)))).all()


@every_kind
def test_it_fits_the_block_and_is_measured(kind):
    shape = KINDS[kind].example()
    check_inclusions(BLOCK, [shape], 0.5e-3)
    measured, places = shape.measures(BLOCK), shape.places(BLOCK)
    assert measured.center.shape == (3,)
    assert (measured.center > 0).all()
    assert (measured.center < BLOCK).all()
    assert 0 < measured.radius < BLOCK.max() / 2
    assert measured.center[2] < measured.top <= BLOCK[2]
    assert shape.hollow == (len(shape.solids(BLOCK)) == 2) == (measured.wall is not None)
    assert measured.direction is None or np.linalg.norm(measured.direction) == pytest.approx(1.0, rel=1e-12)
    assert places.ndim == 2
    assert ((places >= 0) & (places <= BLOCK)).all()
    assert 0 < shape.refine(1e-3) <= 1e-3


@every_kind
def test_a_stretched_ball_has_its_surface_where_it_says(kind):
    solid = KINDS[kind].example().solids(BLOCK)[0]
    image = solid.ball_image()
    if image is None:
        return
    unit = np.random.default_rng(3).normal(size=(200, 3))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    assert np.abs(solid.signed_distance(image.center + unit @ image.stretch)).max() < 1e-12 * BLOCK.max()
    assert image.longest == pytest.approx(np.linalg.eigvalsh(image.stretch).max(), rel=1e-12)
    assert np.abs(solid.signed_distance(image.center + 1.01 * unit @ image.stretch)).min() > 1e-5


@every_kind
def test_a_case_file_gives_it_back(kind):
    shape = KINDS[kind].example()
    written = shape.model_dump(mode="json")
    again = ADAPTER.validate_python(written)
    assert again == shape
    assert again.identity() == shape.identity()
    assert ADAPTER.validate_json(ADAPTER.dump_json(shape)) == shape


@every_kind
def test_the_identity_follows_the_geometry(kind):
    shape = KINDS[kind].example()
    moved = {
        name: tuple(value[axis] + 1e-3 for axis in range(3))
        for name in type(shape).model_fields
        if isinstance(value := getattr(shape, name), tuple) and len(value) == 3 and isinstance(value[0], float)
    }
    if not moved:
        moved = {"centre_line": tuple(tuple(x + 1e-3 for x in point) for point in shape.centre_line)}
    assert shape.model_copy(update=moved).identity() != shape.identity()


def test_numbers_in_data_sets_belong_to_one_kind():
    numbers = [cls.data_set_number for cls in KINDS.values() if cls.data_set_number is not None]
    assert len(numbers) == len(set(numbers))
    assert min(numbers) == 1
