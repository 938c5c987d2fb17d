"""Loads and rigid bodies at planes of symmetry: what is not its own mirror image there is refused."""

from __future__ import annotations

import pytest
from pydantic import ValidationError
from small_problems import CELLS, RUBBER, SIDE, asked, number

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem

pytestmark = pytest.mark.usefixtures("one_thread")


HELD = {"kind": "clamped", "face": "bottom"}
ROUND = {"kind": "cylinder", "radial": CELLS, "axial": CELLS, "around": 2}
LONG = {"kind": "cylinder", "radial": CELLS}
BALL = {"kind": "ball", "radial": CELLS}
PIERCED = {"kind": "plate_with_hole", "size": [3 * SIDE, 3 * SIDE], "hole": [SIDE, SIDE], "outward": 2, "around": 2}
PLANE, SPHERE = {"kind": "plane"}, {"kind": "sphere", "radius": SIDE / 2}


def problem(dimension, geometry, **fields):
    given = {"dimension": dimension, "geometry": geometry, "material": RUBBER, "asked": asked("volume")}
    return BoundaryValueProblem.model_validate(given | fields)


def pressed(dimension, geometry, face, side, body, **moved):
    conditions = [HELD] if geometry is ROUND else []
    return problem(dimension, geometry, conditions=conditions, contacts=[{"face": face, "side": side, "body": body, **moved}])


@pytest.mark.parametrize("axis", ["x", "y"])
@pytest.mark.parametrize("load", [{"kind": "traction"}, {"kind": "force"}])
def test_a_quarter_of_a_cylinder_is_not_sheared(load, axis):
    sheared = [HELD, {**load, "face": "top", axis: 1.0}]
    with pytest.raises(ValidationError, match=rf"conditions\.1\.{axis}: top meets {axis}_plane.*part: whole"):
        problem("3d", ROUND, conditions=sheared)
    problem("3d", ROUND | {"part": "whole"}, conditions=sheared)
    problem("3d", ROUND, conditions=[HELD, {**load, "face": "top", "z": 1.0}])


@pytest.mark.parametrize(
    "load",
    [{"kind": "traction", "face": "right", "x": 1e3}, {"kind": "pressure", "face": "hole", "pressure": 1e3, "follows": False}],
)
def test_a_plate_is_pulled_and_its_hole_pressed(load):
    problem("plane_strain", PIERCED, conditions=[load])


def test_nothing_acts_on_a_plane_of_symmetry_from_outside():
    with pytest.raises(ValidationError, match=r"conditions\.0\.face: x_plane is a plane of symmetry inside the body"):
        problem("plane_strain", LONG, conditions=[{"kind": "pressure", "face": "x_plane", "pressure": 1.0}])
    with pytest.raises(ValidationError, match=r"contacts\.0\.face: equator is a plane of symmetry inside the body"):
        pressed("axisymmetric", BALL, "equator", "bottom", PLANE, z=1e-3)


@pytest.mark.parametrize(
    ("contact", "words"),
    [
        (("3d", ROUND, "top", "top", PLANE, {"z": -1e-3, "motions": [{"x": 1e-3}]}), r"motions\.0\.x: x_plane"),
        (("plane_strain", LONG, "outer", "left", PLANE, {"x": 1e-3}), "x: x_plane is a plane of symmetry"),
        (("axisymmetric", BALL, "outer", "bottom", PLANE, {"z": 1e-3}), "z: equator is a plane of symmetry"),
        (("axisymmetric", BALL, "outer", "top", PLANE, {"z": -1.1 * SIDE}), "z: equator is a plane of symmetry"),
        (
            ("3d", ROUND, "top", "top", SPHERE, {"at": [SIDE / 5, 0, SIDE], "z": -1e-3}),
            "body: sphere is not its own mirror image",
        ),
    ],
)
def test_a_rigid_body_does_not_meet_its_own_mirror_image(contact, words):
    *given, moved = contact
    with pytest.raises(ValidationError, match=rf"contacts\.0\.{words}"):
        pressed(*given, **moved)


@pytest.mark.parametrize(
    ("contact", "moved"),
    [
        (("3d", ROUND, "top", "top", SPHERE), {"z": -1e-3}),
        (("3d", ROUND, "top", "top", PLANE), {"at": [SIDE / 5, 0, SIDE], "z": -1e-3}),
        (("3d", ROUND, "outer", "right", PLANE), {"x": -1e-3}),
        (("3d", ROUND, "top", "top", {"kind": "sphere", "radius": SIDE / 8}), {"at": [SIDE / 2, SIDE / 2, SIDE], "z": -1e-4}),
        (("plane_strain", LONG, "outer", "top", PLANE), {"y": -SIDE / 2}),
        (("plane_strain", PIERCED, "hole", "left", SPHERE), {"at": [0.0, 0.0], "x": 1e-3}),
    ],
)
def test_one_body_astride_a_plane_and_two_that_stay_apart_are_accepted(contact, moved):
    pressed(*contact, **moved)


def test_a_quarter_gives_a_quarter_of_the_force_of_the_whole():
    contact = {"face": "top", "side": "top", "body": PLANE, "at": [SIDE / 5, 0, SIDE], "z": -SIDE / 10}
    fields = {"conditions": [HELD], "contacts": [contact], "asked": asked("contact_force", component="z")}
    quarter, whole = (number(geometry=ROUND | {"part": part}, **fields) for part in ("quarter", "whole"))
    assert 4 * quarter == pytest.approx(whole, rel=1e-5), "penetration, a millionth of the size, over the displacement"


def test_a_quarter_of_a_cylinder_is_not_twisted():
    twisted = [HELD, {"kind": "rotation", "face": "top", "angle": 0.5}]
    with pytest.raises(ValidationError, match=r"\(rotation\) and the symmetry about x_plane prescribe.*part: whole"):
        problem("3d", ROUND, conditions=twisted)
    problem("3d", ROUND | {"part": "whole"}, conditions=twisted)


def test_a_face_is_twisted_and_pulled_once_its_heights_are_free():
    """The message about both names the key that holds the heights."""
    turned, pulled = {"kind": "rotation", "face": "top", "angle": 0.5}, {"kind": "displacement", "face": "top", "z": 1e-3}
    whole = ROUND | {"part": "whole"}
    with pytest.raises(ValidationError, match=r"\(displacement\) and condition 2 \(rotation\) along z, axial: held, prescribe"):
        problem("3d", whole, conditions=[HELD, turned, pulled])
    problem("3d", whole, conditions=[HELD, turned | {"axial": "free"}, pulled])
