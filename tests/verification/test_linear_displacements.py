"""Faces that are displaced linearly: simple shear with its normal stresses, an even stretch, a bore that widens."""

from __future__ import annotations

import pytest
from mutants import assert_kills
from small_problems import C01, C10, SIDE, numbers

SHEAR = 0.8
ACROSS = ("left", "right", "front", "back")
AT = [SIDE / 4, SIDE / 2, SIDE / 3]


def moved(slopes, x=0.0):
    """Displacements of the four faces along z that are the same linear ones, the other two free to come closer or not."""
    faces = [{"kind": "displacement", "face": face, "x": x, "y": 0.0, "slopes": slopes} for face in ACROSS]
    return [*faces, {"kind": "displacement", "face": "bottom", "z": 0.0}]


def sheared(c10=C10, c01=C01):
    """Stresses xx, yy and xy in Pa where zz is none, at the amount of shear k: 2 c10 k^2, -2 c01 k^2, 2 (c10 + c01) k."""
    return 2 * c10 * SHEAR**2, -2 * c01 * SHEAR**2, 2 * (c10 + c01) * SHEAR


def test_simple_shear_needs_normal_stresses(one_thread, verification_record):
    """Mutants: energies without c01 and without c10, and shear alone."""
    asked = {name: {"kind": "stress", "at": AT, "component": name} for name in ("xx", "yy", "xy", "zz")}
    found = numbers(conditions=moved({"x": {"y": SHEAR}}), asked=asked)

    def check(xx, yy, xy):
        assert [found[name] for name in ("xx", "yy", "xy")] == pytest.approx([xx, yy, xy], rel=1e-8), "Newton's error"

    check(*sheared())
    assert abs(found["zz"]) < 1e-8 * found["xy"]
    known = {"reference": "Rivlin 1948", "kind": "exact", "mesh": "2 x 2 x 2 cells", "tolerance": 1e-8}
    verification_record("normal stress of simple shear", found["yy"], sheared()[1], **known)
    linear = 0.0, 0.0, sheared()[2]
    assert_kills(check, without_c01=sheared(c01=0.0), without_c10=sheared(c10=0.0), shear_alone=linear)


def test_a_block_is_moved_and_stretched_evenly(one_thread, verification_record):
    """The component is that of a point at the origin. Mutants: a stretch about the middle, and none across."""
    conditions = moved({"x": {"x": 0.2}, "y": {"y": -0.1}}, x=1e-3)
    places = {"near": [0.0, SIDE, 0.0], "far": [SIDE, SIDE, SIDE]}
    asked = {
        f"{name}_{axis}": {"kind": "displacement", "at": at, "component": axis} for name, at in places.items() for axis in "xyz"
    }
    found = numbers(conditions=conditions, asked=asked)

    def check(near, far):
        assert [found[f"near_{axis}"] for axis in "xyz"] == pytest.approx(near, rel=1e-9, abs=1e-9 * SIDE)
        assert [found[f"far_{axis}"] for axis in "xyz"] == pytest.approx(far, rel=1e-9, abs=1e-9 * SIDE)

    thicker = (1 / (1.2 * 0.9) - 1) * SIDE
    expected = (1e-3 + 0.2 * SIDE, -0.1 * SIDE, thicker)
    check((1e-3, -0.1 * SIDE, 0.0), expected)
    known = {"reference": "volume that is kept", "kind": "exact", "mesh": "2 x 2 x 2 cells", "tolerance": 1e-9}
    verification_record("displacement under an even stretch", [found[f"far_{axis}"] for axis in "xyz"], expected, **known)
    assert_kills(
        check,
        about_the_middle=((1e-3 - 0.1 * SIDE, -0.05 * SIDE, 0.0), (1e-3 + 0.1 * SIDE, -0.05 * SIDE, thicker)),
        none_across=((1e-3, 0.0, 0.0), (1e-3 + 0.2 * SIDE, 0.0, thicker)),
    )


def test_a_bore_that_is_widened_pushes_the_outer_face_away(one_thread, verification_record):
    """A displacement in proportion to the place is radial; r^3 grows everywhere by as much. Mutants: a tube, whose r^2 does, and
    an outer face that moves as far as the inner one."""
    inner, outer, wider = 2e-3, 5e-3, 0.4

    def widened(cells):
        radial = {"r": {"r": wider}, "z": {"z": wider}}
        found = numbers(
            dimension="axisymmetric",
            geometry={
                "kind": "ball",
                "inner_radius": inner,
                "radial": [{"length": outer - inner, "cells": cells}],
                "around": 2 * cells,
            },
            conditions=[{"kind": "displacement", "face": "inner", "r": 0.0, "z": 0.0, "slopes": radial}],
            asked={"away": {"kind": "displacement", "at": [outer, 0.0], "component": "r"}},
        )
        return found["away"]

    def grown(power):
        return (outer**power + inner**power * ((1 + wider) ** power - 1)) ** (1 / power) - outer

    coarse, fine = widened(3), widened(6)

    def check(away):
        assert fine == pytest.approx(away, rel=1e-4), "third order: an eighth of the error of cells twice as large"

    check(grown(3))
    assert abs(coarse / grown(3) - 1) > 6 * abs(fine / grown(3) - 1)
    known = {"reference": "kept volume", "kind": "exact", "mesh": "6 x 12 cells", "tolerance": 1e-4}
    verification_record("outer face of a hollow sphere whose bore widens", fine, grown(3), **known)
    assert_kills(check, tube=(grown(2),), as_far=(wider * inner,))
