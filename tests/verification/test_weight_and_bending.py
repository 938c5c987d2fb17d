r"""Forces per volume and faces that turn in plane strain, against exact displacements.

*A bar hangs from its top* (Timoshenko & Goodier 1970, section 102): with the weight :math:`\gamma` per volume, and z up from the
lower end,

.. math::
    u_z = \frac{\gamma}{2E} \bigl(z^2 - L^2 + \nu r^2\bigr), \qquad u_r = -\frac{\nu\gamma}{E} r z, \qquad \sigma_{zz} = \gamma z.

Quadratic displacements hold it to round-off.

*A column stands between smooth walls* under its weight, at finite strain: the nominal stress is that of uniaxial strain,
:math:`P(\lambda(Z)) = -\gamma (L - Z)`, and the top sinks by :math:`\int (1 - \lambda)\, dZ`.

*A strip is bent* by its ends, which turn as rigid plates: without lateral contraction its displacement is quadratic, and the
moment :math:`E h^3 \kappa / 12` per depth.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.integrate import quad
from scipy.optimize import brentq
from small_problems import result_of

pytestmark = pytest.mark.usefixtures("one_thread")
MODULUS, POISSON_RATIO, WEIGHT, LENGTH, WIDTH = 10e3, 0.3, 9.81e3, 8e-3, 4e-3
ROUND_OFF = 1e-10
C10, BULK, HEAVY = 1e3, 5e3, 4e5
"""Energy in Pa and weight in N/m^3 of the column, whose lowest cells are pressed to 0.66 of their height."""
THICKNESS, ANGLE = 2e-3, 1e-4
"""Of the strip in m, and by which both of its ends turn together."""


def block(cells=2, **sizes):
    return {"kind": "block"} | {axis: [{"length": length, "cells": cells}] for axis, length in sizes.items()}


def linear(poisson_ratio):
    return {"kind": "linear_elastic", "youngs_modulus": MODULUS, "poisson_ratio": poisson_ratio}


def values(**fields):
    return {name: float(quantity.value) for name, quantity in result_of(**fields).quantities.items()}


def hanging(geometry, held, middle, side, across):
    """Displacements in m of the lower end and of the side at the top, stress in Pa at half height."""
    return values(
        dimension="3d" if across == "x" else "axisymmetric",
        geometry=geometry,
        material=linear(POISSON_RATIO),
        conditions=[{"kind": "body_force", "z": -WEIGHT}, {"kind": "traction", "face": "top", "z": WEIGHT * LENGTH}, *held],
        asked={
            "lower_end": {"kind": "displacement", "at": [*middle, 0.0], "component": "z"},
            "side": {"kind": "displacement", "at": [*side, LENGTH], "component": across},
            "stress": {"kind": "stress", "at": [*middle, LENGTH / 2], "component": "zz"},
        },
        steps=1,
    )


def hanging_bar():
    middle = [WIDTH / 2, WIDTH / 2]
    held = [
        {"kind": "point", "at": [*middle, LENGTH], "x": 0.0, "y": 0.0, "z": 0.0},
        {"kind": "point", "at": [*middle, 0.0], "x": 0.0, "y": 0.0},
        {"kind": "point", "at": [WIDTH / 2, 0.0, LENGTH], "x": 0.0},
    ]
    return hanging(block(x=WIDTH, y=WIDTH, z=LENGTH), held, middle, [WIDTH, WIDTH / 2], "x")


def hanging_rod():
    lines = {"radial": [{"length": WIDTH / 2, "cells": 2}], "axial": [{"length": LENGTH, "cells": 2}]}
    held = [{"kind": "point", "at": [0.0, LENGTH], "z": 0.0}]
    return hanging({"kind": "cylinder"} | lines, held, [0.0], [WIDTH / 2], "r")


@pytest.mark.parametrize("body", [hanging_bar, hanging_rod])
def test_a_bar_hangs_under_its_weight(body, verification_record):
    """Mutants: the weight as a force at the lower end, the weight upwards, no lateral contraction, half the weight."""
    reached = body()

    def check(lower_end, side, stress):
        for name, value in {"lower_end": lower_end, "side": side, "stress": stress}.items():
            assert abs(reached[name] - value) < ROUND_OFF * abs(reached[name]), name

    down, aside = -WEIGHT * LENGTH**2 / (2 * MODULUS), -POISSON_RATIO * WEIGHT * LENGTH * WIDTH / (2 * MODULUS)
    exact = (down, aside, WEIGHT * LENGTH / 2)
    check(*exact)
    for name, value in zip(("lower_end", "side", "stress"), exact, strict=True):
        verification_record(
            f"{body.__name__.replace('_', ' ')} under its weight, {name.replace('_', ' ')}",
            reached[name],
            value,
            reference="Timoshenko & Goodier 1970, section 102",
            kind="exact",
            mesh="2 cells along each side",
            tolerance=ROUND_OFF,
        )
    assert_kills(
        check,
        at_the_end=(2 * down, aside, WEIGHT * LENGTH),
        upwards=(-down, -aside, -WEIGHT * LENGTH / 2),
        no_contraction=(down, 0.0, WEIGHT * LENGTH / 2),
        half=(down / 2, aside / 2, WEIGHT * LENGTH / 4),
    )


def nominal(stretch):
    """Nominal stress in Pa of the column's energy in uniaxial strain."""
    return 4 / 3 * C10 * (stretch ** (1 / 3) - stretch ** (-5 / 3)) + BULK * (stretch - 1)


def sunk(stress):
    """How far in m the top sinks under a nominal stress in Pa that depends on the undeformed height."""
    return quad(lambda z: 1 - brentq(lambda stretch: nominal(stretch) - stress(z), 0.2, 1.5), 0.0, LENGTH, epsabs=1e-15)[0]


def column(cells):
    """How far in m the top sinks, and the force in N on the base over the area."""
    walls = [{"kind": "displacement", "face": face, "x": 0.0} for face in ("left", "right")]
    reached = values(
        dimension="plane_strain",
        geometry=block(cells, x=WIDTH, y=LENGTH),
        material={"kind": "neo_hookean", "c10": C10, "bulk_modulus": BULK},
        conditions=[{"kind": "displacement", "face": "bottom", "y": 0.0}, {"kind": "body_force", "y": -HEAVY}, *walls],
        asked={
            "top": {"kind": "displacement", "at": [0.0, LENGTH], "component": "y"},
            "base": {"kind": "force", "face": "bottom", "component": "y"},
        },
    )
    return -reached["top"], reached["base"] / WIDTH


def test_a_soft_column_sinks_under_its_weight(verification_record):
    """Mutants: the weight of the deformed volume, a small strain, and no weight but its sum on the top."""
    (coarse, _), (fine, base) = column(4), column(8)
    exact = sunk(lambda z: -HEAVY * (LENGTH - z))

    def check(expected):
        assert abs(fine / expected - 1) < 2e-5
        assert np.log2(abs(coarse - expected) / abs(fine - expected)) > 2.9, "third order"

    check(exact)
    assert base == pytest.approx(HEAVY * LENGTH, rel=1e-9), "all of the weight stands on the base"
    verification_record(
        "column between walls under its weight, top",
        fine,
        exact,
        reference="equilibrium of one dimension, integrated",
        kind="exact",
        mesh="plane strain, 8 x 8 cells",
        tolerance=2e-5,
        order=float(np.log2(abs(coarse - exact) / abs(fine - exact))),
    )
    small = HEAVY * LENGTH**2 / 2 / (BULK + 8 / 3 * C10)
    assert_kills(
        check,
        small_strain=(small,),
        deformed_volume=(sunk(lambda z: -HEAVY * (LENGTH - z - exact * (1 - z / LENGTH))),),
        on_the_top=(sunk(lambda _: -HEAVY * LENGTH),),
    )


def bent():
    """Moment in N per depth, and displacement in m of a place of the axis, of a strip whose ends turn against each other."""
    ends = (("left", 0.0, -ANGLE / 2), ("right", LENGTH, ANGLE / 2))
    place = [LENGTH / 4, THICKNESS / 2]
    return values(
        dimension="plane_strain",
        geometry={"kind": "block", "x": [{"length": LENGTH, "cells": 4}], "y": [{"length": THICKNESS, "cells": 2}]},
        material=linear(0.0),
        conditions=[
            {"kind": "rotation", "face": face, "angle": angle, "about": [middle, THICKNESS / 2]} for face, middle, angle in ends
        ],
        asked={
            "moment": {"kind": "torque", "face": "right"},
            "height": {"kind": "displacement", "at": place, "component": "y"},
        },
        steps=1,
    )


def test_a_strip_is_bent_by_its_ends(verification_record):
    """Mutants: the curvature of one end alone, a strip that shears instead, and a moment of the other sign."""
    reached, curvature = bent(), ANGLE / LENGTH

    def check(moment, height):
        assert abs(reached["moment"] / moment - 1) < ANGLE**2, "the ends turn on arcs, the linear strip does not"
        assert abs(reached["height"] - height) < ANGLE**2 * abs(reached["height"])

    moment, sag = MODULUS * THICKNESS**3 / 12 * curvature, -curvature / 2 * (LENGTH / 4) * (3 * LENGTH / 4)
    check(moment, sag)
    verification_record(
        "strip bent by its ends, moment",
        reached["moment"],
        moment,
        reference="beam without lateral contraction, exact in plane strain",
        kind="exact",
        mesh="plane strain, 4 x 2 cells",
        tolerance=ANGLE**2,
    )
    assert_kills(check, one_end=(moment / 2, sag / 2), sheared=(moment, 0.0), other_sign=(-moment, sag))


def test_ends_that_turn_alike_turn_the_strip_as_a_rigid_body(verification_record):
    """Mutant: ends that turn about their own middles, which shear the strip."""

    def stressed(abouts):
        ends = zip(("left", "right"), abouts, strict=True)
        return values(
            dimension="plane_strain",
            geometry={"kind": "block", "x": [{"length": LENGTH, "cells": 4}], "y": [{"length": THICKNESS, "cells": 2}]},
            material={"kind": "mooney_rivlin_2", "c10": C10, "c01": C10 / 4},
            conditions=[{"kind": "rotation", "face": face, "angle": np.pi / 2, "about": [x, 0.0]} for face, x in ends],
            asked={"stress": {"kind": "stress", "at": [LENGTH / 4, THICKNESS / 2], "component": "von_mises"}},
            steps=4,
        )["stress"]

    found = stressed((LENGTH / 2, LENGTH / 2))
    assert found < 1e-9 * C10
    known = {"reference": "a rigid motion", "kind": "exact", "mesh": "plane strain, 4 x 2 cells", "tolerance": 1e-9}
    verification_record("stress in a strip turned as a whole, over c10", found, 0.0, scale=C10, **known)
    assert stressed((0.0, LENGTH)) > 0.1 * C10
