"""What acts on each face of a body: loads, rigid bodies and reactions, which balance."""

from __future__ import annotations

from math import pi

import pytest
from scipy.integrate import quad
from small_problems import C01, C10, NOMINAL, PLANES, ROD, SIDE, SQUARE, STRETCH, asked, number, result_of

pytestmark = pytest.mark.usefixtures("one_thread")


def test_a_load_within_a_part_that_ends_between_cells_is_that_of_the_part():
    load = {"kind": "pressure", "face": "top", "pressure": 10.0, "within": {"r": [0.0, SIDE / 2]}}
    held = {"kind": "clamped", "face": "bottom"}
    question = asked("force", face="bottom", component="z")
    force = number(dimension="axisymmetric", geometry=ROD, conditions=[held, load], asked=question)
    assert force == pytest.approx(10 * pi * (SIDE / 2) ** 2, rel=1e-3)  # the bulk of the rest bulges, the loaded part widens


@pytest.mark.parametrize(("part", "of_the_whole"), [("whole", 1), ("quarter", 4)])
def test_a_round_body_in_space_has_a_radius_to_load_within(part, of_the_whole):
    spans = [{"length": SIDE, "cells": 2}]
    rod = {"kind": "cylinder", "radial": spans, "axial": [{"length": SIDE, "cells": 1}], "around": 2, "part": part}
    load = {"kind": "traction", "face": "top", "z": 10.0, "within": {"r": [0.0, SIDE / 2]}}
    held = {"kind": "clamped", "face": "bottom"}
    question = asked("force", face="bottom", component="z", factor=-of_the_whole)
    force = number(dimension="3d", geometry=rod, conditions=[held, load], asked=question)
    assert force == pytest.approx(10 * pi * (SIDE / 2) ** 2, rel=2e-3)  # quarter circles of two parabolas


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


@pytest.mark.parametrize("cells", [1, 4])
def test_a_face_among_prescribed_ones_misses_the_share_of_its_edges(cells):
    """Each corner, which bears a sixth of the traction of its cell, is shared by two faces: as the guide of problems says."""
    spans, shear, modulus = [{"length": SIDE, "cells": cells}], 1e-3, 1e3
    faces = ("left", "right", "bottom", "top")
    asked = {
        "force": {"kind": "force", "face": "top", "component": "x"},
        "stress": {"kind": "stress", "at": (SIDE / 2, SIDE), "component": "xy"},
    }
    result = result_of(
        dimension="plane_strain",
        geometry={"kind": "block", "x": spans, "y": spans},
        material={"kind": "neo_hookean", "c10": modulus / 2, "bulk_modulus": 1e3 * modulus},
        conditions=[{"kind": "displacement", "face": face, "x": 0.0, "y": 0.0, "slopes": {"x": {"y": shear}}} for face in faces],
        steps=1,
        asked=asked,
    )
    assert result["stress"].value == pytest.approx(modulus * shear, rel=1e-6)
    assert result["force"].value / (modulus * shear * SIDE) == pytest.approx(1 - 1 / (6 * cells), rel=1e-6)
    assert [f"force: {100 / (6 * cells - 1):.1f} % of the force on top is at edges" in one for one in result.warnings] == [True]


def widened(radial, by=1.5):
    """Force along z on the bore of half a hollow ball of rubber that is widened, over the exact one, and the warnings."""
    inner, thickness = SIDE, SIDE / 8
    slopes = {axis: {axis: by - 1} for axis in "rz"}
    result = result_of(
        dimension="axisymmetric",
        geometry={"kind": "ball", "inner_radius": inner, "radial": [{"length": thickness, "cells": radial}], "around": 8},
        conditions=[{"kind": "displacement", "face": "inner", "r": 0.0, "z": 0.0, "slopes": slopes}],
        asked=asked("force", face="inner", component="z"),
    )
    outside = (1 + (by**3 - 1) * (inner / (inner + thickness)) ** 3) ** (1 / 3)

    def difference(stretch):
        hoop_over_radial = 2 * C10 * (stretch**2 - stretch**-4) + 2 * C01 * (stretch**4 - stretch**-2)
        return 2 * hoop_over_radial / (stretch * (stretch**3 - 1))

    pressure = quad(difference, outside, by)[0]
    return float(result["number"].value) / (pressure * pi * (by * inner) ** 2), result.warnings


def test_the_force_on_a_face_beside_a_plane_of_symmetry_is_doubted_by_what_it_misses():
    """The hoop stress pulls at the equator of a ball, whose edge the widened bore has in common with it."""
    missed = {}
    for radial in (2, 4):
        ratio, warnings = widened(radial)
        missed[radial] = 1 - ratio
        doubted = [float(one.split("%")[0].split()[-1]) for one in warnings if "at edges" in one]
        assert doubted == [pytest.approx(100 * missed[radial], rel=0.1)]
    assert missed[2] / missed[4] == pytest.approx(2, rel=0.05)


def test_a_force_along_a_component_that_one_face_alone_prescribes_is_not_doubted():
    conditions = [*PLANES, {"kind": "displacement", "face": "top", "z": (STRETCH - 1) * SIDE}]
    result = result_of(conditions=conditions, asked=asked("force", face="top", component="z"))
    assert result["number"].value == pytest.approx(NOMINAL * SIDE**2, rel=1e-7)
    assert not result.warnings
