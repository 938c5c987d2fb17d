r"""Torsion of a bar of rectangular section whose ends warp freely: Saint-Venant 1855.

With sides a >= b, angle :math:`\theta` per length and shear modulus G (Timoshenko & Goodier 1970, section 109),

.. math::
    M = G \theta \frac{a b^3}{3} \Bigl(1 - \frac{192}{\pi^5} \frac{b}{a} \sum_{n\ \mathrm{odd}}
        \frac{\tanh(n \pi a / 2 b)}{n^5}\Bigr), \qquad
    \tau_{max} = G \theta b \Bigl(1 - \frac{8}{\pi^2} \sum_{n\ \mathrm{odd}} \frac{1}{n^2 \cosh(n \pi a / 2 b)}\Bigr).

As no end is held along the bar, this holds at any length.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from small_problems import result_of

pytestmark = pytest.mark.usefixtures("one_thread")
SHEAR_MODULUS, POISSON_RATIO, LENGTH, ANGLE = 10e3, 0.3, 5e-3, 1e-3
ENDS = (("bottom", 0.0), ("top", ANGLE))
CELLS = {"coarse": (4, 1), "fine": (8, 2)}
"""Along the sides and along the bar."""
TOLERANCE = {"coarse": {"torque": 3e-3, "stress": 3e-2}, "fine": {"torque": 4e-4, "stress": 6e-3}}
"""Twice the torque's error on the fine cells, where it is a tenth of that on the coarse ones (third order, as the corners of the
section allow); a stress at a corner of cells is one order less, and the coarse bar has one cell along it."""


def twisted(a: float, b: float, mesh: str) -> dict[str, float]:
    """Torque in N m and largest shear stress in Pa of a bar with sides b along x and a along y, turned about its middle."""
    across, along = CELLS[mesh]
    middle = (b / 2, a / 2)
    lines = {"x": (b, across), "y": (a, across), "z": (LENGTH, along)}
    ends = [{"kind": "rotation", "face": face, "angle": angle, "axial": "free", "about": middle} for face, angle in ENDS]
    quantities = result_of(
        geometry={"kind": "block"} | {axis: [{"length": length, "cells": cells}] for axis, (length, cells) in lines.items()},
        material={
            "kind": "linear_elastic",
            "youngs_modulus": 2 * SHEAR_MODULUS * (1 + POISSON_RATIO),
            "poisson_ratio": POISSON_RATIO,
        },
        conditions=[*ends, {"kind": "point", "at": [*middle, 0.0], "z": 0.0}],
        asked={
            "torque": {"kind": "torque", "face": "top"},
            "stress": {"kind": "stress", "at": [0.0, a / 2, LENGTH / 2 if along > 1 else 0.0], "component": "yz", "factor": -1.0},
        },
        steps=1,
    ).quantities
    return {name: float(quantities[name].value) for name in ("torque", "stress")}


def saint_venant(a: float, b: float) -> dict[str, float]:
    """Torque in N m and largest shear stress in Pa."""
    n, twist = np.arange(1, 200, 2), ANGLE / LENGTH
    narrow = 1 - 192 / np.pi**5 * b / a * np.sum(np.tanh(n * np.pi * a / (2 * b)) / n**5)
    edge = 1 - 8 / np.pi**2 * np.sum(1 / (n**2 * np.cosh(np.minimum(n * np.pi * a / (2 * b), 700))))
    return {"torque": SHEAR_MODULUS * twist * a * b**3 / 3 * narrow, "stress": SHEAR_MODULUS * twist * b * edge}


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("fine", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("a", "b"), [(6e-3, 6e-3), (9e-3, 6e-3)])
def test_a_rectangular_bar_that_warps_freely(a, b, mesh, verification_record):
    """Mutants: the polar moment of the section, as if it did not warp, and its stress at the corner; a long thin strip."""
    reached, exact = twisted(a, b, mesh), saint_venant(a, b)

    def check(expected):
        for name, value in expected.items():
            assert abs(reached[name] - value) < TOLERANCE[mesh][name] * value, name

    check(exact)
    for name in ("torque", "stress"):
        verification_record(
            f"torsion of a bar {a / b:g} times as wide as thick, {name}",
            reached[name],
            exact[name],
            reference="Saint-Venant 1855",
            kind="exact",
            mesh=f"{CELLS[mesh][0]} cells along each side",
            tolerance=TOLERANCE[mesh][name],
        )
    twist = SHEAR_MODULUS * ANGLE / LENGTH
    assert_kills(
        check,
        plane_sections=({"torque": twist * a * b * (a**2 + b**2) / 12},),
        thin_strip=({"torque": twist * a * b**3 / 3},),
        stress_of_a_thin_strip=({"stress": twist * b},),
        stress_at_the_corner=({"stress": twist * np.hypot(a, b) / 2},),
    )
