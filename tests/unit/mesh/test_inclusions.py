"""Inclusions: exact surfaces, volumes and inside tests; everything that a block cannot hold refused with its reason."""

from __future__ import annotations

import numpy as np
import pytest
from lumps import ARTERY, CURVED, LUMP, SIZE, TURNED, enclosed_volume, irregular, points_about, write_cells
from pydantic import TypeAdapter, ValidationError
from solids import assert_close

from tactsim.errors import CaseError, InputError, InvalidQuantity, StorageError
from tactsim.mesh.any_inclusion import AnyInclusion, check_inclusions
from tactsim.mesh.inclusions.ellipsoid import Ellipsoid, nearest_on_ellipsoid
from tactsim.mesh.inclusions.sphere import Sphere
from tactsim.mesh.inclusions.surface import Surface
from tactsim.mesh.inclusions.tube import Tube

here = pytest.mark.usefixtures("reader_here")
BLOCK = np.array(SIZE)
GAP = 0.5e-3
SHAPES = {"sphere": LUMP, "ellipsoid": TURNED, "artery": ARTERY, "curved": CURVED}
ANYWHERE = np.random.default_rng(0).uniform(-0.1, 1.1, (4000, 3)) * BLOCK


def shape(name, tmp_path):
    if name != "surface":
        return SHAPES[name]
    vertices, faces = irregular()
    path = write_cells(tmp_path / "lump.stl", vertices, triangle=faces)
    return Surface(path=str(path), unit="mm", translation=(20e-3, 20e-3, 10e-3), rotation=(0.1, 0.2, 0.3))


@here
@pytest.mark.parametrize("name", [*SHAPES, "surface"])
def test_the_triangles_are_closed_outward_and_on_the_surface(name, tmp_path):
    for solid in shape(name, tmp_path).solids(BLOCK):
        vertices, triangles = solid.triangles(0.5e-3)
        assert np.abs(solid.signed_distance(vertices)).max() < 1e-12 * BLOCK.max()  # round-off
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 1).all()
        assert (np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1] == 2).all()
        assert enclosed_volume(vertices, triangles) > 0
        assert (np.ptp(vertices, axis=0) <= np.ptp(solid.bounds(), axis=0) + 1e-9).all()
        with pytest.raises(AssertionError):
            assert np.abs(solid.signed_distance(vertices + 1e-8)).max() < 1e-12 * BLOCK.max()


@here
@pytest.mark.parametrize("name", [*SHAPES, "surface"])
def test_projected_points_lie_on_the_surface_and_are_nearest(name, tmp_path):
    solid = shape(name, tmp_path).solids(BLOCK)[0]
    near, normal = solid.patches[0](ANYWHERE)
    distance = np.linalg.norm(ANYWHERE - near, axis=1)
    assert_close(np.linalg.norm(normal, axis=1), 1.0, 1e-12)
    assert np.abs(solid.patches[0](near)[0] - near).max() < 1e-12 * BLOCK.max()
    vertices, triangles = solid.triangles(0.4e-3)
    samples = np.vstack([vertices, vertices[triangles].mean(axis=1)])[::3]
    if name not in ("artery", "curved"):  # a tube's side goes on beyond its ends
        assert (np.linalg.norm(ANYWHERE[:300, None] - samples, axis=2).min(axis=1) > distance[:300] - 2e-5).all()
    moved = near + 1e-7 * normal
    assert_close(np.abs(solid.patches[0](moved)[0] - moved).max(), 0.0, 1.01e-7, scale=1.0)
    assert np.abs(solid.patches[0](moved)[0] - moved).max() > 3e-8  # twin: the distance off the surface is seen


@here
@pytest.mark.parametrize("name", [*SHAPES, "surface"])
def test_inside_is_where_the_distance_is_negative_and_has_the_exact_volume(name, tmp_path):
    solid = shape(name, tmp_path).solids(BLOCK)[0]
    points, volume = points_about(solid, 4000)
    inside = solid.inside(points)
    distance = solid.signed_distance(points)
    assert (inside == (distance < 0))[np.abs(distance) > 1e-12].all()
    share = solid.volume() / volume
    tolerance = 5 * np.sqrt(share * (1 - share) / len(points))  # five standard deviations of a count
    assert abs(inside.mean() - share) < tolerance
    assert abs(inside.mean() - 1.5 * share) > tolerance


def test_volumes_have_their_closed_forms():
    assert_close(LUMP.solids(BLOCK)[0].volume(), 4 / 3 * np.pi * 125e-9, 1e-14)
    outer, lumen = ARTERY.solids(BLOCK)
    assert_close(outer.volume(), np.pi * 4.6e-3**2 * 40e-3, 1e-12)
    assert_close(lumen.volume(), np.pi * 4e-3**2 * 40e-3, 1e-12)
    oblique = Tube(centre_line=((0.0, 10e-3, 10e-3), (40e-3, 30e-3, 10e-3)), inner_radius=2e-3, wall=1e-3)
    length = np.hypot(40e-3, 20e-3)  # a cylinder between parallel planes
    assert_close(oblique.solids(BLOCK)[0].volume(), np.pi * 9e-6 * length, 1e-5)  # where fibres end is interpolated
    with pytest.raises(AssertionError):
        assert_close(1.00003 * oblique.solids(BLOCK)[0].volume(), np.pi * 9e-6 * length, 1e-5)


def test_a_bent_tube_has_the_volume_of_its_length():
    """Pappus: the section's area times the length of the line of its centres."""
    bent = Tube(centre_line=((8e-3, 8e-3, 8e-3), (15e-3, 20e-3, 10e-3), (30e-3, 28e-3, 11e-3)), inner_radius=2e-3, wall=1e-3)
    solid = bent.solids(BLOCK)[0]
    line = solid.line.derivatives(np.linspace(*solid.line.limits, 20_001))[0]
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert_close(solid.volume(), np.pi * 9e-6 * length, 1e-5)


@pytest.mark.parametrize("axes", [(1.0, 1.0, 1.0), (3.0, 2.0, 1.0), (1.0, 1.0, 0.01), (10.0, 0.1, 0.1)])
def test_the_way_to_the_nearest_point_of_an_ellipsoid_is_along_its_normal(axes):
    axes = np.array(axes)
    points = np.vstack([np.random.default_rng(2).normal(size=(500, 3)) * axes, np.eye(3) * axes / 3, np.zeros((1, 3))])
    near = nearest_on_ellipsoid(points, axes)
    assert_close(((near / axes) ** 2).sum(axis=1), 1.0, 1e-12)
    distance = np.linalg.norm(points - near, axis=1)
    directions = np.random.default_rng(3).normal(size=(3000, 3))
    samples = directions / np.linalg.norm(directions, axis=1, keepdims=True) * axes
    assert (np.linalg.norm(points[:, None] - samples, axis=2).min(axis=1) >= distance - 1e-9 * axes.max()).all()


def sphere(x, y, z, radius=5e-3):
    return Sphere(center=(x, y, z), radius=radius)


def tube(*points, inner=2e-3, wall=0.6e-3):
    return Tube(centre_line=points, inner_radius=inner, wall=wall)


REFUSED = {
    "overlap": ([sphere(0.02, 0.02, 0.01), sphere(0.02, 0.026, 0.01)], "sphere 1 and sphere 2 overlap"),
    "touching": ([sphere(0.015, 0.02, 0.01), sphere(0.025, 0.02, 0.01)], "sphere 1 and sphere 2"),
    "near": ([sphere(0.0148, 0.02, 0.01), sphere(0.025, 0.02, 0.01)], "are .* apart; allowed"),
    "equal": ([sphere(0.02, 0.02, 0.01), sphere(0.02, 0.02, 0.01)], "sphere 1 and sphere 2|inside"),
    "nested": ([sphere(0.02, 0.02, 0.01), sphere(0.02, 0.02, 0.01, 2e-3)], "sphere 2 lies inside sphere 1"),
    "lump in artery": ([sphere(0.02, 0.02, 0.01, 2e-3), ARTERY], "sphere 1 lies inside tube 2"),
    "lump in wall": ([sphere(0.02, 0.024, 0.01, 2e-3), ARTERY], "overlap"),
    "protruding": ([sphere(0.02, 0.02, 0.004)], "sphere 1 protrudes by 1 mm through the lower face"),
    "near a face": ([sphere(0.02, 0.0052, 0.01)], "sphere 1 is 200 µm from the front face"),
    "outside": ([sphere(0.2, 0.02, 0.01)], "right face"),
    "metres": ([sphere(0.02, 0.02, 0.01, 5e-6)], "unit"),
    "large": ([sphere(0.02, 0.02, 0.01, 5.0)], "unit"),
    "tube through the top": ([tube((0, 0.02, 0.002), (0.04, 0.02, 0.01))], "lower face"),
    "tube along a face": ([tube((0, 0.02, 0.01), (0.04, 0.02, 0.0215))], "upper face"),
    "tube beside the block": ([tube((0, 0.06, 0.01), (0.04, 0.06, 0.01))], "does not pass|back face"),
    "tube through an edge": ([tube((0.0, 0.02, 0.01), (0.04, 0.02, 0.02))], "tube 1"),
    "tube near its end inside": ([tube((0.0003, 0.02, 0.01), (0.03, 0.02, 0.01))], "left face"),
    "tight bend": ([tube((0.005, 0.01, 0.01), (0.02, 0.01, 0.01), (0.02, 0.012, 0.01), (0.005, 0.012, 0.01))], "bends|itself"),
    "membrane": ([tube((0, 0.02, 0.01), (0.04, 0.02, 0.01), wall=1e-6)], "too thin"),
    "points coincide": ([tube((0.01, 0.02, 0.01), (0.01, 0.02, 0.01))], "coincide"),
    "crossing tubes": ([tube((0, 0.02, 0.01), (0.04, 0.02, 0.01)), tube((0.02, 0, 0.01), (0.02, 0.04, 0.01))], "overlap"),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name == "crossing tubes" else ()) for name in REFUSED]
)  # which cross in `APART`, too
def test_what_the_block_cannot_hold_is_refused_with_its_reason(name):
    inclusions, reason = REFUSED[name]
    with pytest.raises(InvalidQuantity, match=reason):
        check_inclusions(BLOCK, inclusions, GAP)


HALF = sphere(0.02, 0.02, 0.01, 4e-3)
APART = {
    "spheres that share a cap": ([HALF, sphere(0.027, 0.02, 0.01, 4e-3)], "overlap by 1 mm;"),
    "centres within each other": ([HALF, sphere(0.021, 0.02, 0.01, 4e-3)], "overlap by 7 mm;"),
    "unequal spheres": ([HALF, sphere(0.02, 0.022, 0.01, 3e-3)], "overlap by 5 mm;"),
    "one in place of the other": ([HALF, sphere(0.02, 0.02, 0.01 + 1e-9, 4e-3)], "overlap by 8 mm;"),
    "touching": ([sphere(0.016, 0.02, 0.01, 4e-3), sphere(0.024, 0.02, 0.01, 4e-3)], "are 0 m apart;"),
    "a tenth": ([sphere(0.016, 0.02, 0.01, 4e-3), sphere(0.0241, 0.02, 0.01, 4e-3)], "are 100 µm apart;"),
    "crossed tubes": (
        [tube((0, 0.02, 0.009), (0.04, 0.02, 0.009)), tube((0.02, 0, 0.0105), (0.02, 0.04, 0.0105))],
        "overlap by 3.7 mm;",  # two radii of 2.6 mm less 1.5 mm between the axes
    ),
}


@pytest.mark.parametrize("name", APART)
def test_how_far_inclusions_are_apart_or_overlap_is_what_they_must_move(name):
    inclusions, words = APART[name]
    with pytest.raises(InvalidQuantity, match=words):
        check_inclusions(BLOCK, inclusions, GAP)


@pytest.mark.parametrize(
    "inclusions",
    [
        [LUMP],
        [ARTERY],
        [CURVED],
        [sphere(0.0145, 0.02, 0.01), sphere(0.0256, 0.02, 0.01)],
        [sphere(0.02, 0.0056, 0.01)],
        [tube((0.01, 0.02, 0.01), (0.04, 0.02, 0.01))],
        [tube((0.0, 0.01, 0.01), (0.04, 0.035, 0.01)), sphere(0.03, 0.01, 0.01)],
        [tube((0.02, 0.02, 0.0), (0.02, 0.02, 0.02))],
        [tube((0.0, 0.005, 0.01), (0.035, 0.04, 0.01), wall=1e-3)],
    ],
)
def test_what_fits_is_accepted(inclusions):
    check_inclusions(BLOCK, inclusions, GAP)


@pytest.mark.parametrize("size", [(0.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (np.nan, 1.0, 1.0)])
def test_a_block_without_size_is_refused(size):
    with pytest.raises(InvalidQuantity, match="block"):
        check_inclusions(np.array(size), [], GAP)


def test_case_files_name_the_kind_and_the_units():
    adapter = TypeAdapter(AnyInclusion)
    text = {"kind": "sphere", "center": ["20 mm", "2 cm", "10 mm"], "radius": "5 mm"}
    assert adapter.validate_python(text, context={"units": "required"}) == LUMP
    for change in ({"radius": "0 mm"}, {"radius": 5}, {"radius": "-1 mm"}, {"center": ["1 mm", "2 mm"]}, {"kind": "cube"}):
        with pytest.raises(ValidationError):
            adapter.validate_python(text | change, context={"units": "required"})
    with pytest.raises(CaseError):
        Tube(centre_line=((0, 0, 0),), inner_radius=1e-3, wall=1e-3)
    with pytest.raises(CaseError):
        Tube(centre_line=ARTERY.centre_line, inner_radius=4e-3, wall=0.0)
    with pytest.raises(CaseError):
        Ellipsoid(center=(0, 0, 0), semi_axes=(1, 1, 0))


def surface_of(tmp_path, vertices, faces, ending="ply"):
    return Surface(
        path=str(write_cells(tmp_path / f"bad.{ending}", vertices, triangle=faces)), unit="mm", translation=(0.02, 0.02, 0.01)
    )


def two_pieces(vertices, faces):
    return np.vstack([vertices, vertices + 30]), np.vstack([faces, faces + len(vertices)])


DAMAGED = {
    "open": (lambda v, f: (v, f[1:]), "not closed"),
    "turned": (lambda v, f: (v, np.vstack([f[:1, ::-1], f[1:]])), "opposite orientation"),
    "doubled": (lambda v, f: (v, np.vstack([f, f[:1]])), "not closed"),
    "pieces": (two_pieces, "2 pieces"),
    "pierced": (lambda v, f: (np.where(np.arange(len(v))[:, None] == 0, -1.5 * v, v), f), "crosses itself"),
    "flat": (lambda v, f: (v * [1, 1, 0], f), "no volume|crosses|coincide"),
    "point": (lambda v, f: (v * 0, f), "coincide"),
    "not finite": (lambda v, f: (np.where(np.arange(len(v))[:, None] == 0, np.nan, v), f), "finite"),
    "index": (lambda v, f: (v, np.where(f == 5, 9999, f)), "run from"),
}


@here
@pytest.mark.parametrize("name", DAMAGED)
def test_a_surface_that_bounds_no_body_is_refused(name, tmp_path):
    change, reason = DAMAGED[name]
    with pytest.raises(InputError, match=reason):
        surface_of(tmp_path, *change(*irregular())).solids(BLOCK)


@here
def test_a_surface_turned_inside_out_as_a_whole_is_put_right(tmp_path):
    vertices, faces = irregular()
    solid = surface_of(tmp_path, vertices, faces[:, ::-1]).solids(BLOCK)[0]
    assert_close(solid.volume(), enclosed_volume(vertices, faces) * 1e-9, 1e-12)
    assert solid.inside(np.array([[0.02, 0.02, 0.01]])).all()


@here
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.4, -0.7, 1.1)])
def test_the_centre_of_a_surface_is_that_of_its_volume_however_it_is_turned(turn, tmp_path):
    """It was the middle of its bounds, which wanders as a lump turns: in a tetrahedron by a quarter of its sides."""
    corners = 8 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    body = surface_of(tmp_path, corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    placed = body.model_copy(update={"translation": (15e-3, 16e-3, 6e-3), "rotation": turn})
    (solid,) = placed.solids(SIZE)
    np.testing.assert_allclose(placed.measures(SIZE).center, solid.vertices.mean(axis=0), atol=1e-12)
    assert np.abs(solid.bounds().mean(axis=0) - solid.vertices.mean(axis=0)).max() > 0.5e-3


def read_whole_and_refuse_truncated(ending, tmp_path, *, shares=(0.6, 0.0)):
    vertices, faces = irregular()
    whole = surface_of(tmp_path, vertices, faces, ending)
    assert_close(whole.solids(BLOCK)[0].volume(), enclosed_volume(vertices, faces) * 1e-9, 1e-6)  # single precision
    path = tmp_path / f"bad.{ending}"
    content = path.read_bytes()
    for share in shares:
        path.write_bytes(content[: int(share * len(content))])
        with pytest.raises((StorageError, InputError)):
            whole.solids(BLOCK)


def test_a_child_reads_the_file_of_a_surface_and_refuses_a_truncated_one(tmp_path):
    read_whole_and_refuse_truncated("stl", tmp_path, shares=(0.6,))


@here
@pytest.mark.parametrize("ending", ["ply", "obj", "stl"])
def test_files_of_surfaces_are_read_and_truncated_ones_refused(ending, tmp_path):
    read_whole_and_refuse_truncated(ending, tmp_path)


@here
def test_the_identity_of_a_surface_follows_the_file_and_not_its_name(tmp_path):
    vertices, faces = irregular()
    first = surface_of(tmp_path, vertices, faces)
    identity = first.identity()
    (tmp_path / "other.ply").write_bytes((tmp_path / "bad.ply").read_bytes())
    assert first.model_copy(update={"path": str(tmp_path / "other.ply")}).identity() == identity
    assert surface_of(tmp_path, vertices * 1.01, faces).identity() != identity


@here
def test_files_that_are_no_surfaces_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"\.stl"):
        Surface(path=str(write_cells(tmp_path / "a.vtk", *[irregular()[0]], triangle=irregular()[1])), unit="mm").solids(BLOCK)
    with pytest.raises(StorageError, match="cannot read"):
        Surface(path=str(tmp_path / "absent.stl"), unit="mm").solids(BLOCK)
