"""Columns and rings that buckle: unstable from the load of Euler or Levy on; the column then bends as the elastica."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.optimize import brentq
from scipy.special import ellipk
from small_problems import CUBE, PLANES, asked, result_of

from tactsim.experiments.boundary_value.boundary_value_problem import BoundaryValueProblem

HEIGHT, WIDTH, C10 = 60e-3, 3e-3, 20e3
"""Twenty times as tall as wide."""
UNSTABLE = "the equilibrium at the end is unstable"
ABOUT_EULER = 0.03
"""How far Euler's load may be off: twenty times as tall a column shortens by 0.8 % before it buckles between clamps, which
lowers and raises the load by about that, and shear lowers it by four times that over 1.2."""


FROM_BOTH_SIDES = {"kind": "exact", "mesh": "2 x 24 cells", "reference": "Euler 1744", "tolerance": ABOUT_EULER}
"""Of a record: stable at the one share of the buckling load and unstable at the other, so that the error is at most theirs."""


def euler(stiffness, length):
    """Buckling force pi^2 E I / l^2 of the column with the bending stiffness E I and the effective length l (Euler 1744)."""
    return np.pi**2 * stiffness / length**2


def column(dimension, c10=C10, **conditions):
    across, along = ([{"length": length, "cells": cells}] for length, cells in ((WIDTH, 2), (HEIGHT, 24)))
    section = {"x": across, "y": along} if dimension == "plane_strain" else {"x": across, "y": across, "z": along}
    problem = {"dimension": dimension, "geometry": {"kind": "block", **section}, "material": {"kind": "neo_hookean", "c10": c10}}
    top = {"face": "top", **conditions}
    held = {"kind": "clamped", "face": "bottom"}
    corner = (0.0, HEIGHT) if dimension == "plane_strain" else (0.0, 0.0, HEIGHT)
    aside = {"aside": {"kind": "displacement", "at": corner, "component": "x"}}
    return BoundaryValueProblem.model_validate(problem | {"conditions": [held, top], "asked": aside}).run()


def warned(result):
    return [warning for warning in result.warnings if UNSTABLE in warning]


@pytest.mark.parametrize(("share", "unstable"), [(1 - ABOUT_EULER, False), (1 + ABOUT_EULER, True)])
def test_a_wide_column_under_a_dead_load(share, unstable, one_thread, verification_record):
    plane = 6 * C10 / 0.75 * WIDTH**3 / 12
    load = {"kind": "traction", "y": -share * euler(plane, 2 * HEIGHT) / WIDTH}
    assert bool(warned(column("plane_strain", **load))) is unstable
    verification_record("buckling load of a wide column, from both sides", share, 1.0, **FROM_BOTH_SIDES)
    assert not warned(column("plane_strain", c10=2 * C10, **load)), "a column of twice the modulus does not buckle"


def test_a_small_load_across_leads_to_the_buckled_column(one_thread, verification_record):
    """Mutants: a column that is a twentieth stiffer, and one with nothing that leads it aside."""
    share, plane = 1.1, 6 * C10 / 0.75 * WIDTH**3 / 12
    traction = share * euler(plane, 2 * HEIGHT) / WIDTH
    m = brentq(lambda m: (ellipk(m) / (np.pi / 2)) ** 2 - share, 0.0, 0.9)
    elastica = 2 * np.sqrt(m) / ellipk(m) * HEIGHT

    def pressed(across=0.01, **material):
        return column("plane_strain", kind="traction", y=-traction, x=across * traction, **material)

    def check(buckled):
        assert not warned(buckled)
        aside = float(buckled["aside"].value)
        assert aside == pytest.approx(elastica, rel=4 * ABOUT_EULER), "a load 1 % larger moves it 4 % more"

    buckled = pressed()
    check(buckled)
    record = {"reference": "elastica, Euler 1744", "kind": "exact", "mesh": "2 x 24 cells", "tolerance": 4 * ABOUT_EULER}
    words = "deflection of a column pressed to 1.1 of its buckling load"
    verification_record(words, float(buckled["aside"].value), elastica, **record)
    assert_kills(check, stiffer=(pressed(c10=1.05 * C10),), straight=(pressed(across=0.0),))


@pytest.mark.parametrize(
    ("share", "motions"),
    [pytest.param(1 - ABOUT_EULER, "", marks=pytest.mark.slow), (1 + ABOUT_EULER, "2 motions of the body lower")],
)
def test_a_square_column_buckles_either_way(share, motions, one_thread, verification_record):
    load = {"kind": "traction", "z": -share * euler(6 * C10 * WIDTH**4 / 12, 2 * HEIGHT) / WIDTH**2}
    assert [motions in warning for warning in warned(column("3d", **load))] == [True] * bool(motions)
    known = FROM_BOTH_SIDES | {"mesh": "2 x 2 x 24 cells"}
    verification_record("buckling load of a square column, from both sides", share, 1.0, **known)


@pytest.mark.parametrize(("share", "unstable"), [(1 - ABOUT_EULER, False), (1 + ABOUT_EULER, True)])
def test_a_column_between_clamps_that_come_closer(share, unstable, one_thread, verification_record):
    plane = 6 * C10 / 0.75
    shortening = share * euler(plane * WIDTH**3 / 12, HEIGHT / 2) / (plane * WIDTH) * HEIGHT
    assert bool(warned(column("plane_strain", kind="displacement", x=0.0, y=-shortening))) is unstable
    verification_record("shortening at which a clamped column buckles, from both sides", share, 1.0, **FROM_BOTH_SIDES)
    assert not warned(column("plane_strain", kind="displacement", x=0.0, y=shortening)), "in tension it stays straight"


@pytest.mark.parametrize(("share", "unstable"), [(1 - ABOUT_EULER, False), (1 + ABOUT_EULER, True)])
def test_a_ring_under_outer_pressure_is_flattened(share, unstable, one_thread, verification_record):
    """Of a pressure p that follows, 3 E I / r^3 for each length of the middle line (Levy 1884); the thickness is a twentieth."""
    middle, outer = 20e-3, 20.5e-3
    thickness = 2 * (outer - middle)
    pressure = share * 3 * (6 * C10 / 0.75 * thickness**3 / 12) / middle**3 * middle / outer
    ring = {"kind": "cylinder", "inner_radius": outer - thickness, "radial": [{"length": thickness, "cells": 2}], "around": 30}
    load = {"kind": "pressure", "face": "outer", "pressure": pressure}
    problem = {"dimension": "plane_strain", "geometry": ring, "material": {"kind": "neo_hookean", "c10": C10}}
    result = BoundaryValueProblem.model_validate(problem | {"conditions": [load], "asked": asked("volume")}).run()
    assert bool(warned(result)) is unstable
    known = FROM_BOTH_SIDES | {"mesh": "2 cells x 30 around a quarter", "reference": "Levy 1884"}
    verification_record("pressure that flattens a ring, from both sides", share, 1.0, **known)


@pytest.mark.parametrize(("share", "unstable"), [(0.999, False), (1.001, True)])
def test_a_cube_pulled_alike_on_all_sides(share, unstable, one_thread, verification_record):
    """Rivlin's cube of neo-Hookean material, pulled by dead tractions T, is unstable from T = 2 G on (Rivlin 1974): exact."""
    pulled = [
        {"kind": "traction", "face": face, axis: share * 4 * C10}
        for face, axis in zip(("right", "back", "top"), "xyz", strict=True)
    ]
    problem = {"geometry": CUBE, "material": {"kind": "neo_hookean", "c10": C10}, "conditions": [*PLANES, *pulled]}
    assert bool(warned(result_of(**problem, asked=asked("volume")))) is unstable
    known = {"reference": "Rivlin 1974", "kind": "exact", "mesh": "one cell", "tolerance": 1e-3}
    verification_record("traction from which on Rivlin's cube is unstable, from both sides", share, 1.0, **known)


def squeezed(stretch, cells):
    """How many motions lower the energy of a block squeezed between smooth walls, its top free, and the warning."""
    result = BoundaryValueProblem.model_validate(
        {
            "dimension": "plane_strain",
            "geometry": {"kind": "block", "x": [{"length": 10e-3, "cells": cells}], "y": [{"length": 20e-3, "cells": 2 * cells}]},
            "material": {"kind": "neo_hookean", "c10": C10},
            "conditions": [
                {"kind": "displacement", "face": "left", "x": 0.0},
                {"kind": "displacement", "face": "right", "x": (stretch - 1) * 10e-3},
                {"kind": "displacement", "face": "bottom", "y": 0.0},
            ],
            "asked": asked("volume"),
        }
    ).run()
    (words,) = warned(result) or [""]
    return int(words.split(": ")[1].split()[0].replace("a", "1")) if words else 0, words


def test_wrinkles_of_elements_are_no_wrinkles_of_the_body(one_thread):
    """A half-space of neo-Hookean material, and so every wave on this block, is stable down to the stretch l of
    l^6 + l^4 + 3 l^2 = 1 (Biot 1963); the elements are not. Mutant: a column that buckles long before, of which this is not said.
    """
    exact = brentq(lambda stretch: stretch**6 + stretch**4 + 3 * stretch**2 - 1, 0.1, 1.0)
    assert exact == pytest.approx(0.5437, abs=1e-4)
    assert squeezed(0.75, 8) == (0, "")
    (coarse, words), (fine, _) = squeezed(0.65, 4), squeezed(0.65, 8)
    assert 0 < coarse < fine
    assert "Or it is the mesh: parts are squeezed to 0.65 of their length" in words
    plane = 6 * C10 / 0.75 * WIDTH**3 / 12
    (buckles,) = warned(column("plane_strain", kind="traction", y=-1.1 * euler(plane, 2 * HEIGHT) / WIDTH))
    assert "the mesh" not in buckles
