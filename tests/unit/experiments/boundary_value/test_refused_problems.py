"""Boundary value problems that are refused, with the key that is to blame, or doubted."""

from __future__ import annotations

from contextlib import nullcontext

import pytest
from pydantic import ValidationError
from small_problems import BRICK, CELLS, EXTENSION, PLANES, ROD, RUBBER, SIDE, SQUARE, TOP, asked

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.refusals import refusals_of
from tactsim.units import written

pytestmark = pytest.mark.usefixtures("one_thread")


BALL = {"kind": "ball", "radial": CELLS}
PLATE = {"kind": "plate_with_hole", "size": [SIDE, SIDE], "hole": [SIDE / 3, SIDE / 2], "outward": 2, "around": 2}
HALF = {"x": [0.0, SIDE / 2]}
TURNED = {"kind": "rotation", "face": "top", "angle": 1.0, "sliding": "in_plane"}


@pytest.mark.parametrize(
    ("fields", "place", "words"),
    [
        ({"conditions": [{"kind": "clamped", "face": "roof"}]}, "conditions.0.face", "no face 'roof'; it has left, right, front"),
        (
            {"conditions": [{"kind": "clamped", "face": "top", "within": {"r": [0.0, 1.0]}}]},
            "conditions.0.within",
            "no coordinate r; allowed: x, y, z",
        ),
        (
            {"geometry": BALL, "conditions": [{"kind": "clamped", "face": "outer", "within": {"q": [0.0, 1.0]}}]},
            "conditions.0.within",
            "no coordinate q; allowed: x, y, z, r",
        ),
        (
            {"conditions": [{"kind": "clamped", "face": "top", "within": {"x": [2 * SIDE, 3 * SIDE]}}]},
            "conditions.0.within",
            "no facet of top lies within x from 20 mm to 30 mm; let cells end there",
        ),
        (
            {"conditions": [{"kind": "pressure", "face": "top", "pressure": 1.0, "within": {**HALF, "y": [0.0, 0.7 * SIDE]}}]},
            "conditions.0.within.y",
            "from 5 mm to 10 mm, across the end at 7 mm; let cells end there",
        ),
        ({"conditions": [{"kind": "point", "at": [1e-3, 0.0, 0.0], "x": 0.0}]}, "conditions.0.at", "no node of the mesh lies at"),
        ({"conditions": [{"kind": "point", "at": [1e-3, 0.0], "x": 0.0}]}, "conditions.0.at", "2 coordinates; needed: x, y, z"),
        (
            {"conditions": [{"kind": "clamped", "face": "top"}, {"kind": "displacement", "face": "left", "x": 1e-3}]},
            "conditions",
            "condition 2 (displacement) and condition 1 (clamped) prescribe different displacements",
        ),
        (
            {"asked": asked("displacement", at=(1.0, 0.0, 0.0), component="x")},
            "asked.number.at",
            "lies outside the body, where x",
        ),
        (
            {"conditions": [{"kind": "force", "face": "top", "y": "10 N/m"}]},
            "conditions.0.y",
            "'10 N/m' is a force per length; needed: a force, in plane strain that of a metre of depth",
        ),
        ({"asked": asked("force", face="roof", component="x")}, "asked.number.face", "no face 'roof'"),
        (
            {"asked": {"2nd-force": {"kind": "volume"}}},
            "asked.2nd-force",
            "the key '2nd-force' is not allowed; expected a name: a letter and up to 60 further letters",
        ),
        (
            {"material": {"kind": "polynomial", "coefficients": {"c3": 1e3}}},
            "material.coefficients.c3",
            "the key 'c3' is not allowed; expected c and two digits",
        ),
        ({"dimension": "axisymmetric", "asked": asked("volume")}, "geometry", "a block has no axis"),
        ({"geometry": PLATE, "asked": asked("volume")}, "geometry", "geometry.z belongs to a plate in 3d"),
        (
            {"geometry": PLATE | {"hole": [SIDE, SIDE / 2]}, "dimension": "plane_strain", "asked": asked("volume")},
            "geometry",
            "the hole reaches 10 mm along x; allowed: less than the size there, 10 mm",
        ),
        ({"contacts": [{"face": "roof", "side": "top", "body": {"kind": "plane"}}]}, "contacts.0.face", "no face 'roof'"),
        (
            {"asked": asked("stress", at=TOP, component="rz")},
            "asked.number.component",
            "no rz stress at this point in 3d; allowed: xx",
        ),
        (
            {"asked": asked("stress", at=(0.0, 0.0, SIDE), component="hoop")},
            "asked.number.component",
            "allowed: xx, yy, zz, xy, yz, xz, von_mises, mean",
        ),
        (
            {"dimension": "axisymmetric", "geometry": BALL, "asked": asked("stress", at=(SIDE, SIDE), component="mean")},
            "asked.number.at",
            "the point at 10 mm, 10 mm lies outside the body",
        ),
        (
            {"contacts": [{"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 1e-3}, "at": [1.0, 0.0, 0.0]}]},
            "contacts.0.at",
            "the sphere that comes from the top does not meet top",
        ),
    ],
)
def test_what_the_body_has_not_is_refused_with_its_key(fields, place, words):
    held = [{"kind": "clamped", "face": "outer" if fields.get("geometry") == BALL else "bottom"}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION, "conditions": held} | fields
    with pytest.raises(ValidationError) as caught:
        BoundaryValueProblem.model_validate(fields)
    ((path, message),) = refusals_of(caught.value, written(fields), BoundaryValueProblem).items()
    assert ".".join(map(str, path)) == place
    assert words in message


@pytest.mark.parametrize(
    ("moved", "words"),
    [
        ({"at": [2e-3, SIDE]}, "r = 0, and not 2 mm away"),
        ({"r": 1e-3}, "contacts.0.r: a rigid body moves along the axis only"),
        ({"motions": [{"z": -1e-3}, {"r": 1e-3}]}, "contacts.0.motions.1.r: a rigid body moves along the axis only"),
        ({"z": -1e-3, "motions": [{}]}, "contacts.0.motions.0: no component is given; allowed: r, z"),
        ({"motions": [{"x": 1e-3}]}, "contacts.0.motions.0: there is no component x; allowed: r, z"),
    ],
)
def test_a_rigid_body_stays_on_the_axis_of_a_body_of_revolution(moved, words):
    sphere = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 3e-3}} | moved
    fields = {"conditions": [{"kind": "clamped", "face": "bottom"}], "contacts": [sphere], "asked": asked("volume")}
    with pytest.raises(ValidationError, match=words):
        BoundaryValueProblem.model_validate({"dimension": "axisymmetric", "geometry": ROD, "material": RUBBER} | fields)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"conditions": []}, "nothing acts on the body"),
        ({"conditions": [{"kind": "displacement", "face": "top", "r": 0.0}]}, "there is no component r; allowed: x, y, z"),
        ({"conditions": [{"kind": "traction", "face": "top"}]}, "no component is given"),
        ({"asked": asked("displacement", at=TOP, component="r")}, "asked.number: there is no component r"),
        ({"asked": {"time": {"kind": "volume"}}}, "asked.time: every step records this already"),
        ({"asked": asked("contact_force", component="x")}, "there are 0 contacts"),
        ({"asked": asked("volume", time=2.0)}, "after the end at 1 s"),
        ({"asked": asked("volume", time=0.0), "conditions": PLANES}, "nothing acts at the time 0"),
        ({"contacts": [{"face": "top", "side": "top", "body": {"kind": "plane"}, "at": [0.0]}]}, "at of a contact needs 3"),
        (
            {"dimension": "plane_strain", "contacts": [{"face": "top", "side": "front", "body": {"kind": "plane"}}]},
            "no body comes from the front in plane_strain; allowed: left",
        ),
        (
            {"dimension": "plane_strain", "contacts": [{"face": "top", "side": "top", "body": {"kind": "jaw"}}]},
            "a jaw is not defined in plane_strain",
        ),
        ({"dimension": "axisymmetric", "asked": asked("torque", face="top")}, "in 3d or in plane_strain"),
        (
            {"dimension": "axisymmetric", "conditions": [{"kind": "rotation", "face": "top", "angle": 1.0, "axial": "free"}]},
            "conditions.0.axial: no face of a body in axisymmetric moves along the circle",
        ),
        (
            {"conditions": [{"kind": "displacement", "face": "top", "x": 0.0, "slopes": {"y": {"x": 0.5}}}]},
            "conditions.0.slopes.y: the component y is not given",
        ),
        (
            {"conditions": [{"kind": "displacement", "face": "top", "x": 0.0, "slopes": {"x": {"r": 0.5}}}]},
            "conditions.0.slopes.x: there is no coordinate r; allowed: x, y, z",
        ),
        (
            {"regions": [{"within": {"x": [2 * SIDE, 3 * SIDE]}, "material": RUBBER}]},
            r"regions.0.within: .* holds no cell; let cells end",
        ),
        (
            {"regions": [{"within": {"x": [0.0, 0.7 * SIDE]}, "material": RUBBER}]},
            "regions.0.within: the part within x from 0 m to 7 mm ends within cells; let cells end there",
        ),
        ({"regions": [{"within": {"r": [0.0, SIDE]}, "material": RUBBER}]}, "within: there is no coordinate r; allowed: x, y, z"),
        ({"geometry": ROD, "conditions": [TURNED | {"face": "outer"}]}, "conditions.0.sliding: the face outer is not flat"),
        ({"geometry": BRICK, "conditions": [TURNED]}, "conditions.0.sliding: the plane of top stands across the axis"),
        (
            {"geometry": BRICK, "conditions": [TURNED | {"face": "left"}, {"kind": "displacement", "face": "bottom", "x": 0.0}]},
            r"condition 1 \(rotation\) and another condition, or the symmetry of the body, hold one node; let one",
        ),
        (
            {
                "dimension": "plane_strain",
                "geometry": SQUARE,
                "conditions": [TURNED | {"face": "left"}, TURNED | {"face": "top"}],
            },
            r"condition 2 \(rotation\) and condition 1 \(rotation\) hold one node",
        ),
        (
            {"dimension": "plane_strain", "conditions": [{"kind": "rotation", "face": "top", "angle": 1.0, "axial": "free"}]},
            "conditions.0.axial: no face of a body in plane_strain moves along z",
        ),
        ({"conditions": [{"kind": "body_force", "r": 1.0}]}, "no component r; allowed: x, y, z"),
        ({"geometry": BALL, "conditions": [{"kind": "body_force", "z": 1.0}]}, "conditions.0.z: equator is a plane of symmetry"),
    ],
)
def test_a_contradiction_is_refused_when_the_case_is_read(fields, words):
    held = [{"kind": "clamped", "face": "bottom"}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION, "conditions": held} | fields
    if fields["dimension"] == "plane_strain":
        fields = {"asked": asked("volume")} | {**fields, "geometry": SQUARE}
        fields["asked"] = fields["asked"] if "torque" in str(fields["asked"]) else asked("volume")
    with pytest.raises(ValidationError, match=words):
        BoundaryValueProblem.model_validate(fields)


@pytest.mark.parametrize(("inner_radius", "possible"), [(0.0, False), (SIDE, True)], ids=["solid", "tube"])
def test_a_core_in_a_section_without_a_hole_is_refused_with_what_holds_it(inner_radius, possible):
    """In plane strain cells end on circles around a hole only; there is such a core in a disc whose ends are held."""
    core = {"within": {"r": [inner_radius, inner_radius + SIDE]}, "material": RUBBER}
    common = {"material": RUBBER, "regions": [core], "asked": asked("volume")}
    common["conditions"] = [{"kind": "pressure", "face": "outer", "pressure": 1.0}]
    section = {"kind": "cylinder", "inner_radius": inner_radius, "radial": CELLS * 2}
    refused = nullcontext() if possible else pytest.raises(ValidationError, match="end on no circle: take dimension")
    with refused:
        BoundaryValueProblem.model_validate({"dimension": "plane_strain", "geometry": section, **common})
    common["conditions"] += [{"kind": "displacement", "face": face, "z": 0.0} for face in ("bottom", "top")]
    for dimension in ("axisymmetric", "3d"):
        BoundaryValueProblem.model_validate({"dimension": dimension, "geometry": section | {"axial": CELLS}, **common})


def point(*at, **prescribed):
    return {"kind": "point", "at": at, **prescribed}


CORNER = point(0.0, 0.0, 0.0, x=0.0, y=0.0, z=0.0)


@pytest.mark.parametrize(
    ("dimension", "geometry", "conditions", "motions"),
    [
        ("3d", BRICK, PLANES[::2], "moving along y;"),
        ("3d", BRICK, PLANES[:1], "moving along y, moving along z and turning about x;"),
        ("3d", BRICK, [CORNER], "turning about x, turning about y and turning about z;"),
        ("3d", BRICK, [CORNER, point(SIDE, 0.0, 0.0, y=0.0, z=0.0)], "turning about x;"),
        ("3d", BRICK, [CORNER, point(SIDE, SIDE, SIDE, x=0.0, y=0.0, z=0.0)], "turning about an axis through what is held;"),
        ("3d", {**ROD, "part": "half"}, PLANES[2:], "moving along x;"),
        ("plane_strain", SQUARE, [{"kind": "displacement", "face": "bottom", "y": 0.0}], "moving along x;"),
        ("plane_strain", SQUARE, [point(0.0, 0.0, x=0.0, y=0.0)], "turning about z;"),
        ("axisymmetric", ROD, [{"kind": "displacement", "face": "bottom", "r": 0.0}], "moving along z;"),
    ],
)
def test_a_body_that_is_free_to_move_is_refused_with_the_motion(dimension, geometry, conditions, motions):
    load = {"kind": "pressure", "face": "top", "pressure": 1.0}
    fields = {"material": RUBBER, "asked": asked("volume"), "dimension": dimension, "geometry": geometry}
    with pytest.raises(ValidationError, match=f"conditions: nothing holds the body against {motions}"):
        BoundaryValueProblem.model_validate({**fields, "conditions": [*conditions, load]})


@pytest.mark.parametrize(
    ("dimension", "geometry", "conditions"),
    [
        ("3d", BRICK, PLANES),
        ("3d", BRICK, [CORNER, point(SIDE, 0.0, 0.0, y=0.0, z=0.0), point(0.0, SIDE, 0.0, z=0.0)]),
        ("3d", ROD, PLANES[2:]),
        ("3d", {**ROD, "part": "whole"}, [{"kind": "rotation", "face": "bottom", "angle": 0.0}]),
        ("3d", {"kind": "ball", "radial": CELLS}, []),
        ("plane_strain", SQUARE, [point(0.0, 0.0, x=0.0, y=0.0), point(SIDE, 0.0, y=0.0)]),
        ("axisymmetric", ROD, PLANES[2:]),
    ],
)
def test_a_body_that_is_just_held_is_accepted(dimension, geometry, conditions):
    load = {"kind": "pressure", "face": "outer" if geometry.get("kind") == "ball" else "top", "pressure": 1.0}
    fields = {"material": RUBBER, "asked": asked("volume"), "dimension": dimension, "geometry": geometry}
    assert BoundaryValueProblem.model_validate({**fields, "conditions": [*conditions, load]}).doubts() == []


def test_a_body_that_only_a_rigid_one_holds_is_doubted():
    plane = {"face": "top", "side": "top", "body": {"kind": "plane"}, "law": {"kind": "stick"}, "y": -1e-3}
    fields = {"dimension": "plane_strain", "geometry": SQUARE, "material": RUBBER, "asked": asked("volume"), "contacts": [plane]}
    held = [{"kind": "displacement", "face": "bottom", "y": 0.0}]
    (doubt,) = BoundaryValueProblem.model_validate(fields | {"conditions": held}).doubts()
    assert "nothing but rigid bodies holds the body against moving along x:" in doubt


WALLS = [*PLANES, {"kind": "displacement", "face": "right", "x": 0.0}, {"kind": "displacement", "face": "back", "y": 0.0}]
PRESSED = {"kind": "displacement", "face": "top", "z": -0.01 * SIDE}


@pytest.mark.parametrize(
    ("dimension", "geometry", "conditions"),
    [
        ("3d", BRICK, [*WALLS, PRESSED]),
        ("axisymmetric", ROD, [{"kind": "clamped", "face": face} for face in ("bottom", "top", "outer")]),
        ("plane_strain", SQUARE, [{"kind": "clamped", "face": face} for face in ("bottom", "top", "left", "right")]),
        ("axisymmetric", BALL, [{"kind": "clamped", "face": "outer"}]),
    ],
)
def test_an_incompressible_body_confined_on_all_sides_is_refused_before_it_is_solved(dimension, geometry, conditions):
    fields = {"dimension": dimension, "geometry": geometry, "conditions": conditions, "asked": asked("volume")}
    with pytest.raises(ValidationError, match="confined on all sides and its material incompressible"):
        BoundaryValueProblem.model_validate(fields | {"material": RUBBER})
    assert BoundaryValueProblem.model_validate(fields | {"material": RUBBER | {"bulk_modulus": 1e6}}).begin()


@pytest.mark.parametrize("conditions", [WALLS, [*WALLS, {"kind": "pressure", "face": "top", "pressure": 10.0}]])
def test_an_incompressible_body_with_a_face_that_may_move_is_accepted(conditions):
    fields = {"dimension": "3d", "geometry": BRICK, "conditions": conditions, "asked": asked("volume"), "material": RUBBER}
    assert BoundaryValueProblem.model_validate(fields)
