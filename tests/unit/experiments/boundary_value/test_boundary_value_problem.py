"""A boundary value problem in small: homogeneous states by every kind of load, moving rigid bodies, times, and refusals."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from pydantic import ValidationError

from tactsim.errors import InputError
from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.plotting import figures_for
from tactsim.refusals import refusals_of
from tactsim.results.result import Status
from tactsim.units import written

pytestmark = pytest.mark.usefixtures("one_thread")
C10, C01, SIDE = 1e3, 250.0, 0.01
RUBBER = {"kind": "mooney_rivlin_2", "c10": C10, "c01": C01}
CELLS = [{"length": SIDE, "cells": 2}]
BRICK = {"kind": "block", "x": CELLS, "y": CELLS, "z": CELLS}
SQUARE = {"kind": "block", "x": CELLS, "y": CELLS}
ROD = {"kind": "cylinder", "radial": CELLS, "axial": CELLS}
PLANES = [{"kind": "displacement", "face": face, axis: 0.0} for face, axis in (("left", "x"), ("front", "y"), ("bottom", "z"))]
STRETCH = 1.3
NOMINAL = 2 * (STRETCH - STRETCH**-2) * (C10 + C01 / STRETCH)
"""Of an incompressible bar in tension."""
TOP = (SIDE, SIDE, SIDE)


def result_of(**fields):
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "steps": 4} | fields
    result = BoundaryValueProblem.model_validate(fields).run()
    assert result.status is Status.CONVERGED, result.reason
    return result


def asked(kind, **fields):
    return {"number": {"kind": kind, **fields}}


def number(**fields):
    return float(result_of(**fields).quantities["number"].value)


EXTENSION = asked("displacement", at=TOP, component="z")


@pytest.mark.parametrize(
    "load",
    [
        {"kind": "traction", "face": "top", "z": NOMINAL},
        {"kind": "pressure", "face": "top", "pressure": -NOMINAL, "follows": False},
        {"kind": "force", "face": "top", "z": NOMINAL * SIDE**2},
        {"kind": "pressure", "face": "top", "pressure": -NOMINAL * STRETCH},
    ],
    ids=["traction", "dead pressure", "force", "pressure that follows"],
)
def test_every_kind_of_load_stretches_a_bar_as_it_should(load):
    extension = number(conditions=[*PLANES, load], asked=EXTENSION)
    assert extension == pytest.approx((STRETCH - 1) * SIDE, rel=1e-7)  # homogeneous: exact but for Newton's tolerance


def test_a_dead_pressure_is_no_pressure_that_follows():
    load = {"kind": "pressure", "face": "top", "pressure": -NOMINAL}
    follows = number(conditions=[*PLANES, load], asked=EXTENSION)
    assert follows < 0.9 * (STRETCH - 1) * SIDE


@pytest.mark.parametrize(
    ("question", "exact"),
    [
        (asked("force", face="top", component="z"), NOMINAL * SIDE**2),
        (asked("force", face="top", component="z", factor=4.0), 4 * NOMINAL * SIDE**2),
        (asked("stress", at=(SIDE / 3, SIDE / 2, SIDE / 5), component="zz"), NOMINAL * STRETCH),
        (asked("stress", at=TOP, component="von_mises"), NOMINAL * STRETCH),
        (asked("stress", at=TOP, component="mean"), NOMINAL * STRETCH / 3),
        (asked("volume"), SIDE**3),
        (
            asked("energy"),
            SIDE**3 * (C10 * (STRETCH**2 + 2 / STRETCH - 3) + C01 * (2 * STRETCH + STRETCH**-2 - 3)),
        ),
        (asked("displacement", at=(SIDE / 3, SIDE / 2, SIDE / 5), component="z"), (STRETCH - 1) * SIDE / 5),
        (asked("displacement", at=TOP, component="x"), (STRETCH**-0.5 - 1) * SIDE),
    ],
)
def test_what_is_asked_of_a_stretched_bar(question, exact):
    pulled = {"kind": "displacement", "face": "top", "z": (STRETCH - 1) * SIDE}
    assert number(conditions=[*PLANES, pulled], asked=question) == pytest.approx(exact, rel=1e-7)


def test_an_axisymmetric_bar_is_the_same_bar():
    pulled = [{"kind": "displacement", "face": "bottom", "z": 0.0}, {"kind": "traction", "face": "top", "z": NOMINAL}]
    question = asked("displacement", at=(0.0, SIDE), component="z") | {
        "force": {"kind": "force", "face": "bottom", "component": "z"},
        "side": {"kind": "displacement", "at": (SIDE, SIDE), "component": "r"},
        "hoop": {"kind": "stress", "at": (SIDE, SIDE), "component": "hoop"},
    }
    quantities = result_of(dimension="axisymmetric", geometry=ROD, conditions=pulled, asked=question).quantities
    assert quantities["number"].value == pytest.approx((STRETCH - 1) * SIDE, rel=1e-7)
    assert quantities["force"].value == pytest.approx(-NOMINAL * pi * SIDE**2, rel=1e-7)
    assert quantities["side"].value == pytest.approx((STRETCH**-0.5 - 1) * SIDE, rel=1e-7)
    assert abs(quantities["hoop"].value) < 1e-6 * NOMINAL


def test_plane_strain_is_stiffer_than_a_free_bar():
    sides = [{"kind": "displacement", "face": "left", "x": 0.0}, {"kind": "displacement", "face": "bottom", "y": 0.0}]
    pulled = {"kind": "displacement", "face": "top", "y": (STRETCH - 1) * SIDE}
    question = asked("force", face="top", component="y")
    force = number(dimension="plane_strain", geometry=SQUARE, conditions=[*sides, pulled], asked=question)
    assert force == pytest.approx(2 * (C10 + C01) * (STRETCH - STRETCH**-3) * SIDE, rel=1e-7)  # pure shear, per metre of depth


@pytest.mark.parametrize("side", ["left", "right", "bottom", "top", "front", "back"])
def test_a_plane_presses_from_every_side(side):
    opposite = {"left": "right", "right": "left", "bottom": "top", "top": "bottom", "front": "back", "back": "front"}
    axes = {"left": "x", "right": "x", "bottom": "z", "top": "z", "front": "y", "back": "y"}
    away = -1.0 if side in ("left", "bottom", "front") else 1.0
    others = {"x": "left", "y": "front", "z": "bottom"} | {axes[side]: opposite[side]}
    held = [{"kind": "displacement", "face": face, axis: 0.0} for axis, face in others.items()]
    plane = {"face": side, "side": side, "body": {"kind": "plane"}, axes[side]: -away * 0.2 * SIDE}
    force = number(conditions=held, contacts=[plane], asked=asked("contact_force", component=axes[side]), steps=2)
    squeezed = 2 * (0.8 - 0.8**-2) * (C10 + C01 / 0.8) * SIDE**2
    assert force == pytest.approx(away * squeezed, rel=1e-5)  # the penetration is a millionth of the block


def test_a_turned_face_stays_plane_and_its_torque_is_that_of_small_twists():
    geometry = {**ROD, "part": "whole", "around": 4}
    turned = [{"kind": "rotation", "face": face, "angle": angle} for face, angle in (("bottom", 0.0), ("top", 1e-3))]
    torque = number(geometry=geometry, conditions=turned, asked=asked("torque", face="top"), steps=1)
    assert torque == pytest.approx(pi / 2 * SIDE**4 * 2 * (C10 + C01) * 1e-3 / SIDE, rel=5e-3)  # two cells along the radius


def test_amplitudes_of_their_own_and_times():
    held = {"pieces": [{"kind": "hold", "duration": 1.0}, {"kind": "ramp", "to": 1.0, "duration": 1.0}]}
    pulled = {"kind": "displacement", "face": "top", "z": 0.1 * SIDE, "amplitude": held}
    pushed = {"kind": "displacement", "face": "right", "x": 0.1 * SIDE}
    question = {
        f"at_{time:g}".replace(".", "_"): {"kind": "displacement", "at": TOP, "component": axis, "time": time}
        for axis, time in (("x", 0.25), ("x", 1.0), ("z", 1.5), ("z", 2.0))
    }
    found = result_of(conditions=[*PLANES, pulled, pushed], asked=question).quantities
    computed = [found[name].value / SIDE for name in question]
    np.testing.assert_allclose(computed, [0.025, 0.1, 0.05, 0.1], rtol=1e-9)


def test_a_sudden_load_at_the_beginning_has_its_answer_at_time_zero():
    load = {"kind": "traction", "face": "top", "z": NOMINAL}
    jump = {"pieces": [{"kind": "jump", "to": 1.0, "duration": 1e3}]}
    material = {"kind": "neo_hookean", "c10": C10, "relaxation": {"fractions": [0.5], "times": [10.0]}}
    question = {
        name: {"kind": "displacement", "at": TOP, "component": "z"} | when
        for name, when in (("first", {"time": 0.0}), ("last", {}))
    }
    found = result_of(conditions=[*PLANES, load], material=material, amplitude=jump, asked=question).quantities
    for name, modulus in (("first", C10), ("last", C10 / 2)):
        stretch = 1 + found[name].value / SIDE
        assert 2 * modulus * (stretch - stretch**-2) == pytest.approx(NOMINAL, rel=1e-4)  # the tolerance in time


def test_the_course_is_recorded_and_drawn():
    pulled = {"kind": "displacement", "face": "top", "z": 0.1 * SIDE}
    result = result_of(conditions=[*PLANES, pulled], asked=EXTENSION)
    np.testing.assert_allclose(result.history_values("number"), np.array([0.25, 0.5, 0.75, 1.0]) * 0.1 * SIDE, rtol=1e-9)
    assert result.units["number"] == "m"
    assert "von_mises [Pa]" in result.frames[-1].cell_data
    (draw,) = figures_for(result).values()
    assert draw()[:4] == b"\x89PNG"


HALF = {"x": [0.0, SIDE / 2]}


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
            {"conditions": [{"kind": "clamped", "face": "top", "within": {"x": [2 * SIDE, 3 * SIDE]}}]},
            "conditions.0.within",
            "no facet of top lies within",
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
        ({"asked": asked("force", face="roof", component="x")}, "asked.number.face", "no face 'roof'"),
        ({"dimension": "axisymmetric", "asked": asked("volume")}, "geometry", "a block has no axis"),
        ({"contacts": [{"face": "roof", "side": "top", "body": {"kind": "plane"}}]}, "contacts.0.face", "no face 'roof'"),
    ],
)
def test_what_the_body_has_not_is_refused_with_its_key(fields, place, words):
    held = [{"kind": "clamped", "face": "bottom"}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION, "conditions": held} | fields
    with pytest.raises(ValidationError) as caught:
        BoundaryValueProblem.model_validate(fields)
    ((path, message),) = refusals_of(caught.value, written(fields), BoundaryValueProblem).items()
    assert ".".join(map(str, path)) == place
    assert words in message


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"asked": asked("stress", at=TOP, component="rz")}, "asked.number: there is no rz stress"),
        (
            {"contacts": [{"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 1e-3}, "at": [1.0, 0.0, 0.0]}]},
            "contacts.0: the sphere that comes from the top does not meet top",
        ),
    ],
)
def test_what_the_posed_problem_has_not_is_refused_before_the_first_step(fields, words):
    held = [{"kind": "clamped", "face": "bottom"}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION, "conditions": held} | fields
    with pytest.raises(InputError, match=words):
        BoundaryValueProblem.model_validate(fields).begin()


def test_a_load_within_a_part_that_ends_between_cells_is_that_of_the_part():
    load = {"kind": "pressure", "face": "top", "pressure": 10.0, "within": {"r": [0.0, SIDE / 2]}}
    held = {"kind": "clamped", "face": "bottom"}
    question = asked("force", face="bottom", component="z")
    force = number(dimension="axisymmetric", geometry=ROD, conditions=[held, load], asked=question)
    assert force == pytest.approx(10 * pi * (SIDE / 2) ** 2, rel=1e-3)  # the bulk of the rest bulges, the loaded part widens


def forces_of(faces="left right bottom top", axes="xy", **fields):
    """Force on each face along each axis, and the largest of them."""
    question = {f"{face}_{axis}": {"kind": "force", "face": face, "component": axis} for face in faces.split() for axis in axes}
    quantities = result_of(**fields, asked=question).quantities
    forces = {name: float(quantities[name].value) for name in question}
    return forces, max(map(abs, forces.values()))


@pytest.mark.parametrize("cells", [1, 2, 4])
def test_a_face_bears_its_own_load_and_the_clamp_beside_it_the_reaction(cells):
    load, spans = -100.0, [{"length": SIDE, "cells": cells}]
    conditions = [{"kind": "clamped", "face": "left"}, {"kind": "traction", "face": "top", "y": load}]
    common = {"dimension": "plane_strain", "geometry": {"kind": "block", "x": spans, "y": spans}}
    forces, largest = forces_of(**common, conditions=conditions)
    expected = dict.fromkeys(forces, 0.0) | {"top_y": load * SIDE, "left_y": -load * SIDE}
    assert forces == pytest.approx(expected, abs=1e-7 * largest)  # Newton's tolerance, on any mesh


@pytest.mark.parametrize(
    "conditions",
    [
        [{"kind": "clamped", "face": "left"}, {"kind": "clamped", "face": "bottom"}],
        [
            {"kind": "displacement", "face": "left", "x": 0.0},
            {"kind": "point", "at": [0.0, 0.0], "y": 0.0},
            {"kind": "point", "at": [SIDE / 2, 0.0], "y": 0.0},
        ],
    ],
    ids=["an edge of two clamped faces", "points"],
)
def test_the_forces_on_all_faces_balance(conditions):
    loads = [{"kind": "pressure", "face": "top", "pressure": 100.0}, {"kind": "traction", "face": "right", "x": 30.0, "y": 50.0}]
    forces, largest = forces_of(dimension="plane_strain", geometry=SQUARE, conditions=[*conditions, *loads])
    for axis in "xy":
        assert abs(sum(force for name, force in forces.items() if name[-1] == axis)) < 1e-7 * largest
        assert abs(forces[f"left_{axis}"] + forces[f"bottom_{axis}"]) > 0.1 * largest


def test_a_rigid_body_acts_on_the_face_that_it_touches():
    plane = {
        "face": "top",
        "side": "top",
        "body": {"kind": "plane"},
        "y": -0.1 * SIDE,
        "law": {"kind": "coulomb", "friction": 0.5},
    }
    common = {"dimension": "plane_strain", "geometry": SQUARE, "conditions": [{"kind": "clamped", "face": "bottom"}]}
    forces, _ = forces_of(**common, contacts=[plane], steps=2)
    pressed = number(**common, contacts=[plane], steps=2, asked=asked("contact_force", component="y"))
    assert forces["top_y"] == pytest.approx(pressed, rel=1e-9)
    assert pressed < 0
    assert forces["bottom_y"] == pytest.approx(-pressed, rel=1e-5)  # springs that hold what nothing touches, Newton's tolerance
    assert forces["left_x"] == forces["right_y"] == 0


def test_the_torque_on_a_face_is_that_of_its_own_load():
    conditions = [{"kind": "clamped", "face": "bottom"}, {"kind": "traction", "face": "right", "y": 10.0}]
    question = {face: {"kind": "torque", "face": face} for face in ("left", "right", "front", "back", "bottom", "top")}
    quantities = result_of(conditions=conditions, asked=question).quantities
    torques = {face: float(quantities[face].value) for face in question}
    assert torques["right"] == pytest.approx(10 * SIDE**3, rel=0.1)  # the arm grows as the face moves
    assert torques["bottom"] == pytest.approx(-torques["right"], rel=1e-6)
    assert torques["left"] == torques["front"] == torques["back"] == torques["top"] == 0


@pytest.mark.parametrize(
    ("moved", "words"), [({"at": [2e-3, SIDE]}, "r = 0, and not 2 mm away"), ({"r": 1e-3}, "along the axis only")]
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
        ({"dimension": "plane_strain", "asked": asked("torque", face="top")}, "in 3d only"),
        ({"dimension": "plane_strain", "conditions": [{"kind": "rotation", "face": "top", "angle": 1.0}]}, "in 3d only"),
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


def test_an_incompressible_body_confined_on_all_sides_fails_with_the_reason():
    walls = [{"kind": "displacement", "face": face, axis: 0.0} for face, axis in (("right", "x"), ("back", "y"))]
    pressed = {"kind": "displacement", "face": "top", "z": -0.01 * SIDE}
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": asked("volume")}
    result = BoundaryValueProblem.model_validate({**fields, "conditions": [*PLANES, *walls, pressed]}).run()
    assert result.status is Status.FAILED
    assert "held against moving as a whole" in result.reason
    assert "confined on all sides" in result.reason


@pytest.mark.parametrize(("away", "warned"), [(1e-3, True), (0.0, True), (-1e-3, False)])
def test_a_rigid_body_that_never_touches_is_warned_of(away, warned):
    sphere = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": SIDE}, "z": away}
    fields = {"dimension": "axisymmetric", "geometry": ROD, "conditions": [{"kind": "clamped", "face": "bottom"}], "steps": 2}
    warnings = result_of(**fields, contacts=[sphere], asked=asked("contact_force", component="z")).warnings
    assert [warning.startswith("rigid body 1 (sphere from the top) never touches the body at top") for warning in warnings] == (
        [True] if warned else []
    )


def test_a_sphere_rubs_deep_into_a_bonded_layer():
    layer = {"kind": "cylinder", "radial": [{"length": 12e-3, "cells": 20, "ratio": 4}], "axial": [{"length": 2e-3, "cells": 6}]}
    held = [{"kind": "clamped", "face": "bottom"}]

    def force(law):
        sphere = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 4e-3}, "law": law, "z": -0.8e-3}
        question = asked("contact_force", component="z", factor=-1.0)
        common = {"dimension": "axisymmetric", "geometry": layer, "conditions": held, "contacts": [sphere], "steps": 5}
        result = result_of(**common, asked=question)
        assert result.quantities["max_penetration"].value <= 12e-3 * 1e-5
        return float(result.quantities["number"].value)

    smooth, rough = force({"kind": "coulomb", "friction": 0.0}), force({"kind": "coulomb", "friction": 0.5})
    assert 1.2 * smooth < rough < force({"kind": "stick"}) * (1 + 1e-3)


def test_faces_that_meet_at_once_may_slip_and_stick():
    sides = [{"kind": "displacement", "face": "left", "x": 0.0}, {"kind": "displacement", "face": "bottom", "y": 0.0}]

    def force(friction):
        law = {"kind": "coulomb", "friction": friction}
        plane = {"face": "top", "side": "top", "body": {"kind": "plane"}, "law": law, "y": -0.1 * SIDE}
        question = asked("contact_force", component="y", factor=-1.0)
        common = {"dimension": "plane_strain", "geometry": SQUARE, "conditions": sides, "contacts": [plane]}
        return number(**common, asked=question, steps=2)

    forces = [force(friction) for friction in (0.0, 0.1, 0.5)]
    assert forces[0] == pytest.approx(2 * (C10 + C01) * (0.9**-3 - 0.9) * SIDE, rel=1e-5)
    assert forces[0] < forces[1] < forces[2]
