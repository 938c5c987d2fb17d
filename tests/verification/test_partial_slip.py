"""A rigid cylinder pressed on a soft half-space and pushed along it: the middle of the contact sticks, its borders slip.

Reference: Cattaneo 1938 and Mindlin 1949 (doi:10.1115/1.4009973). Under the normal force P and the shear force Q < m P on the
contact |x| <= a, points within c = a sqrt(1 - Q / (m P)) stick. The shear traction is that of full slip less the like one on
|x| <= c; where either acts, the surface lags behind its middle by m p0 x^2 / (E* a), with the largest pressure p0 = 2 P / (pi a).
Hertz 1881: a^2 = 4 P R / (pi E*). On nearly incompressible tissue pressure and shear do not act on each other. What is odd in x
comes of the cylinder's way, 1.4 % of a, and is left out; four times as deep the way is 3 % of a, and the difference from the
reference 3 % instead of 0.8 %.

Mutants: full slip, a stick zone as if the force were half as large, and the half-width of a cylinder twice as thick.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from mutants import assert_kills
from small_problems import numbers

from tactsim.array import Array

RADIUS, FRICTION, YOUNGS_MODULUS, POISSON_RATIO = 10e-3, 0.3, 1e6, 0.4999
STIFFNESS = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)
MIDDLE, HEIGHT, FINE = 20e-3, 20.5e-3, 0.5e-3
"""Place of the cylinder and of the surface, and how far cells of one length reach, in m."""
PRESSED, PUSHED = 10e-6, 3e-6
CELLS = 16
"""Over the length ``FINE``: seven to half of the contact."""
PLACES = np.arange(1, 9) * FINE / CELLS
"""In m, of what is looked at, from the middle to beyond the contact."""
TOLERANCE = 0.015
"""Of the largest displacement: a cell is a third of the slipping border."""


def elliptic(x: Array, half_width: float, largest: float) -> Array:
    """Displacement in m of the surface less that in its middle, under a shear ``largest`` sqrt(1 - x^2 / half_width^2) in Pa."""
    beyond = np.sqrt(np.maximum(x**2 - half_width**2, 0.0))
    outside = x * beyond - half_width**2 * np.log(np.maximum((x + beyond) / half_width, 1.0))
    return -largest / (STIFFNESS * half_width) * (x**2 - outside)


def slipped(normal: float, shear: float, *, radius: float = RADIUS, remains: float | None = None) -> Array:
    """How far the surface at ``PLACES`` lags behind its middle, in m; ``remains`` is the part of the half-width that sticks."""
    a = math.sqrt(4 * normal * radius / (math.pi * STIFFNESS))
    limit = FRICTION * 2 * normal / (math.pi * a)
    share = math.sqrt(1 - shear / (FRICTION * normal)) if remains is None else remains
    return elliptic(PLACES, a, limit) - (elliptic(PLACES, share * a, share * limit) if share else 0.0)


def pushed(steps: int, beyond: int) -> tuple[float, float, Array]:
    """Normal and shear force in N/m, and the measured lag at ``PLACES`` in m, even in x; ``beyond`` are the growing cells."""
    wide, high = MIDDLE - FINE, HEIGHT - FINE
    inward, outward = ({"length": wide, "cells": beyond, "ratio": ratio} for ratio in (1 / 80, 80))
    surface = {"length": 2 * FINE, "cells": 2 * CELLS}
    ramp, hold = {"kind": "ramp", "to": 1.0, "duration": 1.0}, {"kind": "hold", "duration": 1.0}
    signed = [0.0, *PLACES, *-PLACES]
    moved = {
        f"x{number}_{when}": {"kind": "displacement", "at": [MIDDLE + x, HEIGHT], "component": "x", "time": when}
        for number, x in enumerate(signed)
        for when in (1, 2)
    }
    forces = {name: {"kind": "contact_force", "component": axis} for name, axis in (("normal", "y"), ("shear", "x"))}
    found = numbers(
        dimension="plane_strain",
        geometry={
            "kind": "block",
            "x": [inward, surface, outward],
            "y": [{"length": high, "cells": beyond, "ratio": 1 / 80}, {"length": FINE, "cells": CELLS}],
        },
        material={"kind": "linear_elastic", "youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO},
        conditions=[{"kind": "clamped", "face": "bottom"}],
        contacts=[
            {
                "face": "top",
                "side": "top",
                "body": {"kind": "sphere", "radius": RADIUS},
                "law": {"kind": "coulomb", "friction": FRICTION},
                "at": [MIDDLE, HEIGHT],
                "y": -PRESSED,
                "amplitude": {"pieces": [ramp, hold]},
                "motions": [{"x": PUSHED, "amplitude": {"pieces": [hold, ramp]}}],
            }
        ],
        penetration_tolerance=5e-9,
        steps=steps,
        asked=forces | moved,
    )
    by_shear = np.array([found[f"x{number}_2"] - found[f"x{number}_1"] for number in range(len(signed))])
    right, left = np.split(by_shear[1:] - by_shear[0], 2)
    return abs(found["normal"]), abs(found["shear"]), (right + left) / 2


@pytest.mark.parametrize(("steps", "beyond"), [(1, 8), pytest.param(5, 14, marks=pytest.mark.slow)])
def test_a_pushed_cylinder_sticks_in_the_middle(steps, beyond, one_thread, verification_record):
    """At the contact the cells are the same. Within 1.2 % in one step for each movement, within 0.8 % in five."""
    normal, shear, lag = pushed(steps, beyond)
    assert 0.6 < shear / (FRICTION * normal) < 0.65
    scale = float(np.abs(lag).max())

    def check(expected):
        assert lag == pytest.approx(expected, abs=TOLERANCE * scale)

    exact = slipped(normal, shear)
    check(exact)
    mesh = f"seven cells to half of the contact, {beyond} beyond"
    known = {"reference": "Cattaneo 1938, Mindlin 1949", "kind": "exact", "mesh": mesh}
    verification_record("slip beside a sticking middle", lag, exact, tolerance=TOLERANCE, scale=scale, **known)
    wrong = {"half_the_force": slipped(normal, shear / 2), "thicker": slipped(normal, shear, radius=2 * RADIUS)}
    assert_kills(check, **{name: (one,) for name, one in wrong.items()}, full_slip=(slipped(normal, shear, remains=0.0),))
