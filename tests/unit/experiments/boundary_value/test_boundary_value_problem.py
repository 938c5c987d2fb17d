"""A boundary value problem in small: homogeneous states by every kind of load, moving rigid bodies, and times."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from small_problems import (
    BRICK,
    C01,
    C10,
    EXTENSION,
    NOMINAL,
    PLANES,
    ROD,
    RUBBER,
    SIDE,
    SQUARE,
    STRETCH,
    TOP,
    asked,
    number,
    result_of,
)

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem
from tactsim.experiments.boundary_value.scene import BoundaryValueScene
from tactsim.plotting import figures_for

pytestmark = pytest.mark.usefixtures("one_thread")


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


def test_what_a_whole_body_has_is_per_metre_of_depth_in_plane_strain():
    """Forces said N, with a metre of depth in their words only."""
    sides = [{"kind": "clamped", "face": "bottom"}, {"kind": "displacement", "face": "top", "x": 0.1 * SIDE, "y": 0.0}]
    question = {
        "force": {"kind": "force", "face": "top", "component": "x", "time": 1.0},
        "torque": {"kind": "torque", "face": "top"},
        "energy": {"kind": "energy"},
        "volume": {"kind": "volume"},
        "stress": {"kind": "stress", "at": (0.0, 0.0), "component": "xy"},
    }
    result = result_of(dimension="plane_strain", geometry=SQUARE, conditions=sides, asked=question, steps=1)
    units = {"force": "N/m", "torque": "N*m/m", "energy": "J/m", "volume": "m^2", "stress": "Pa"}
    assert {name: result.quantities[name].unit for name in question} == units
    assert {name: result.experiment.history_units[name] for name in question} == units
    assert result.scene_as(BoundaryValueScene).asked == units
    assert result["volume"].value == pytest.approx(SIDE**2, rel=1e-6)
    assert [name for name in question if "per metre of depth" in result[name].description] == list(question)[:4]
    solid = result_of(geometry=BRICK, conditions=PLANES, asked=asked("force", face="top", component="z"), steps=1)
    assert solid.quantities["number"].unit == "N"


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


def test_a_body_of_several_materials_is_meshed_and_divided_once():
    """Checking, asking for doubts, drawing and solving each ask for its parts."""
    layers = [{"within": {"z": [0.0, SIDE / 2]}, "material": RUBBER}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "regions": layers, "conditions": PLANES}
    problem = BoundaryValueProblem.model_validate(fields | {"asked": asked("volume")})
    assert problem.parts is problem.parts
    assert set(problem.parts.domain.mesh.regions) == {0, 1}


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


@pytest.mark.parametrize(("away", "warned"), [(1e-3, True), (0.0, True), (-1e-3, False)])
def test_a_rigid_body_that_never_touches_is_warned_of(away, warned):
    sphere = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": SIDE}, "z": away}
    fields = {"dimension": "axisymmetric", "geometry": ROD, "conditions": [{"kind": "clamped", "face": "bottom"}], "steps": 2}
    warnings = result_of(**fields, contacts=[sphere], asked=asked("contact_force", component="z")).warnings
    never = [warning for warning in warnings if "never touches" in warning]
    assert [warning.startswith("rigid body 1 (sphere from the top) never touches the body at top") for warning in never] == (
        [True] if warned else []
    )


def test_a_sphere_rubs_deep_into_a_bonded_layer():
    layer = {"kind": "cylinder", "radial": [{"length": 12e-3, "cells": 12, "ratio": 4}], "axial": [{"length": 2e-3, "cells": 4}]}
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


def test_a_body_that_presses_and_then_slides_is_a_base_that_moves_below_it():
    pressed = {"pieces": [{"kind": "ramp", "to": 1.0, "duration": 1.0}, {"kind": "hold", "duration": 3.0}]}
    there = {"kind": "ramp", "to": 1.0, "duration": 1.0}
    slid = {"pieces": [{"kind": "hold", "duration": 1.0}, there, {"kind": "ramp", "to": -1.0, "duration": 2.0}]}
    block = {"kind": "block", "x": [{"length": SIDE, "cells": 4}], "y": [{"length": SIDE / 2, "cells": 2}]}
    question = {
        f"{axis}_{time}": {"kind": "contact_force", "component": axis, "time": float(time)} for axis in "xy" for time in (1, 2, 4)
    }

    def forces(*, base: float, motions: list[dict[str, object]]) -> dict[str, float]:
        bottom = {"kind": "displacement", "face": "bottom", "x": base, "y": 0.0, "amplitude": slid}
        ball = {"face": "top", "side": "top", "at": (SIDE / 2, 0.0), "body": {"kind": "sphere", "radius": 2 * SIDE}}
        pressing = {"law": {"kind": "coulomb", "friction": 0.3}, "y": -0.02 * SIDE, "amplitude": pressed, "motions": motions}
        shape = {"dimension": "plane_strain", "geometry": block, "steps": 4}
        quantities = result_of(**shape, conditions=[bottom], contacts=[ball | pressing], asked=question).quantities
        return {name: quantities[name].value for name in question}

    ball_slides = forces(base=0.0, motions=[{"x": 0.1 * SIDE, "amplitude": slid}])
    base_slides = forces(base=-0.1 * SIDE, motions=[])
    slack = 1e-4 * abs(base_slides["y_1"])  # the penetration allowed, over that of the ball
    assert ball_slides == pytest.approx(base_slides, abs=slack)
    assert abs(ball_slides["x_1"]) < slack
    assert ball_slides["x_2"] == pytest.approx(-ball_slides["x_4"], abs=slack)  # it slips there and back
    assert ball_slides["x_2"] > 0.2 * abs(ball_slides["y_2"])


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


@pytest.mark.parametrize(("stretch", "warned"), [(1.0, True), (0.02, False)])
def test_a_linear_law_at_large_strains_is_warned_of(stretch, warned):
    pulled = {"kind": "displacement", "face": "top", "z": stretch * SIDE}
    material = {"kind": "linear_elastic", "youngs_modulus": 1e3, "poisson_ratio": 0.3}
    warnings = result_of(material=material, conditions=[*PLANES, pulled], asked=EXTENSION).warnings
    # du/dx of a bar: 1 along it and -0.3 across it, the root of 1 + 2 * 0.09 together.
    assert [("displacement gradients are 1.1 in the mean" in warning) for warning in warnings] == ([True] if warned else [])


def test_a_singular_corner_of_a_linear_body_is_no_large_strain():
    cells = [{"length": SIDE, "cells": 24, "ratio": 0.002}]
    body = {"kind": "block", "x": cells, "y": cells}
    held = [{"kind": "clamped", "face": "bottom"}, {"kind": "displacement", "face": "top", "y": -0.02 * SIDE, "x": 0.0}]
    material = {"kind": "linear_elastic", "youngs_modulus": 1e3, "poisson_ratio": 0.45}
    result = result_of(
        dimension="plane_strain", geometry=body, material=material, conditions=held, asked=asked("energy"), steps=1
    )
    assert not result.warnings


RELAXING = RUBBER | {"relaxation": {"fractions": [0.8], "times": [0.2]}}
BRIEFLY = {"pieces": [{"kind": "jump", "to": 1.0, "duration": 0.1}]}
PULL = {"kind": "displacement", "face": "top", "z": (STRETCH - 1) * SIDE}


@pytest.mark.parametrize("rest", [{}, {"amplitude": BRIEFLY}], ids=["by default", "written"])
def test_a_problem_ends_with_the_last_amplitude_that_anything_follows(rest):
    """What holds faces at zero follows the default amplitude of 1 s, after which the rod would bear 0.205 of its force."""
    left = 1 - 0.8 * (1 - np.exp(-0.1 / 0.2))  # the stretch is held from the start
    fields = {"dimension": "axisymmetric", "geometry": ROD, "material": RELAXING}
    held = [{"kind": "displacement", "face": "bottom", "z": 0.0}, PULL | {"amplitude": BRIEFLY}]
    reached = number(**fields, conditions=held, asked=asked("force", face="top", component="z"), **rest)
    assert reached == pytest.approx(left * NOMINAL * pi * SIDE**2, rel=1e-6)


@pytest.mark.parametrize(
    ("condition", "duration"),
    [
        ({"kind": "clamped", "face": "bottom"}, 0.1),
        ({"kind": "displacement", "face": "bottom", "x": 0.0, "slopes": {"x": {"y": 0.0}}}, 0.1),
        ({"kind": "displacement", "face": "bottom", "z": 0.0, "slopes": {"z": {"x": 0.1}}}, 1.0),
        ({"kind": "rotation", "face": "bottom", "angle": 0.1}, 1.0),
        ({"kind": "pressure", "face": "bottom", "pressure": 1.0}, 1.0),
        ({"kind": "body_force", "z": -1.0}, 1.0),
    ],
    ids=lambda one: one["kind"] if isinstance(one, dict) else "",
)
def test_the_default_amplitude_lasts_for_what_it_moves_or_loads(condition, duration):
    pulled = [{"kind": "clamped", "face": "top"}, {"kind": "traction", "face": "left", "x": -10.0, "amplitude": BRIEFLY}]
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION}
    problem = BoundaryValueProblem.model_validate(fields | {"conditions": [*pulled, condition]})
    assert problem.duration == duration


def test_an_amplitude_of_the_problem_that_is_written_lasts_as_written():
    longer = {"pieces": [{"kind": "ramp", "to": 1.0, "duration": 3.0}]}
    fields = {"dimension": "3d", "geometry": BRICK, "material": RUBBER, "asked": EXTENSION, "amplitude": longer}
    held = {"kind": "clamped", "face": "bottom"}
    assert BoundaryValueProblem.model_validate(fields | {"conditions": [held, PULL | {"amplitude": BRIEFLY}]}).duration == 3.0
