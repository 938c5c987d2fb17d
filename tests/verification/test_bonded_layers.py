"""Bodies of two materials: a tube of two layers under pressure, a compressible core in a sleeve of rubber, a strip of two layers
that is bent, and a laminate that is stretched while one layer relaxes."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.integrate import quad
from scipy.optimize import brentq
from small_problems import CELLS, PLANES, SIDE, numbers

INNER, BETWEEN, OUTER, WIDER = 4e-3, 5e-3, 7e-3, 4.8e-3
"""Radii of the tube before, and of its bore under pressure."""
SOFT, STIFF = 10e3, 80e3
"""c10 in Pa of the layers."""
STRETCH = 1.6
CORE, SLEEVE, CORE_STRETCH = 4e-3, 8e-3, 1.25
"""Radii of a core and of the sleeve around it, and the stretch of the core across its axis."""
CORE_C10, BULK, RUBBER = 5e3, 50e3, (30e3, 9e3)
"""Energy of the core, and c10 and c01 of the sleeve, in Pa."""
LENGTH, UNDER, OVER, BEND = 12e-3, 1.5e-3, 2.5e-3, np.radians(60)
"""Length of a strip, thickness of its lower and upper layer, and the angle between its ends."""
LAYERS = ((80e3, 10e3), RUBBER)
"""c10 and c01 of the lower and the upper layer in Pa."""


def mooney_rivlin(c10, c01):
    return {"kind": "mooney_rivlin_2", "c10": c10, "c01": c01}


def neo_hookean(c10, **more):
    return {"kind": "neo_hookean", "c10": c10, **more}


def pressure_of(inside, outside):
    """Pressure in Pa that widens a tube of constant length to WIDER: ds_rr/dr = (s_hoop - s_rr) / r, layer after layer."""

    def rise(reference, c10):
        r = np.sqrt(WIDER**2 + reference**2 - INNER**2)
        stretch = r / reference
        return 2 * c10 * (stretch**2 - stretch**-2) * reference / r**2

    return quad(rise, INNER, BETWEEN, args=(inside,))[0] + quad(rise, BETWEEN, OUTER, args=(outside,))[0]


def widened(cells, dimension="axisymmetric", inside=STIFF, outside=SOFT):
    """Displacement in m of the bore of a tube of two layers, under what widens a stiff one in a soft one to WIDER."""
    spans = [{"length": BETWEEN - INNER, "cells": cells}, {"length": OUTER - BETWEEN, "cells": 2 * cells}]
    geometry = {"kind": "cylinder", "inner_radius": INNER, "radial": spans, "around": 6 * cells}
    ends = []
    if dimension == "axisymmetric":
        geometry |= {"axial": [{"length": 1e-3, "cells": cells}]}
        ends = [{"kind": "displacement", "face": face, "z": 0.0} for face in ("bottom", "top")]
    return numbers(
        dimension=dimension,
        geometry=geometry,
        material=neo_hookean(outside),
        regions=[{"within": {"r": [INNER, BETWEEN]}, "material": neo_hookean(inside)}],
        conditions=[*ends, {"kind": "pressure", "face": "inner", "pressure": pressure_of(STIFF, SOFT)}],
        asked={"bore": {"kind": "displacement", "at": [INNER, 0.0], "component": "r" if ends else "x"}},
    )["bore"]


def test_a_tube_of_two_layers_widens(one_thread, verification_record):
    """Mutants: the layers swapped, an inner one that is 5 % stiffer, and the mean of both, weighed by their volumes."""
    coarse, fine = widened(1), widened(2)

    def check(bore):
        assert bore == pytest.approx(WIDER - INNER, rel=1e-4), "two cubic cells across each millimetre"

    check(fine)
    check(widened(2, dimension="plane_strain"))
    assert np.log2(abs(coarse - WIDER + INNER) / abs(fine - WIDER + INNER)) > 2.5, "third order: the pressure may jump"
    known = {"reference": "balance of forces, layer after layer", "kind": "exact", "mesh": "6 x 2 cells", "tolerance": 1e-4}
    verification_record("bore of a tube of two layers", fine, WIDER - INNER, **known)
    share = (BETWEEN**2 - INNER**2) / (OUTER**2 - INNER**2)
    mean = share * STIFF + (1 - share) * SOFT
    assert_kills(
        check,
        swapped=(widened(2, inside=SOFT, outside=STIFF),),
        stiffer=(widened(2, inside=1.05 * STIFF),),
        mean=(widened(2, inside=mean, outside=mean),),
    )


def test_a_laminate_is_stretched_while_a_layer_relaxes(one_thread, verification_record):
    """Incompressible layers in parallel contract alike, so that each is stretched evenly. Mutants: no layer, all of it, and one
    that does not relax."""
    fraction, time = 0.5, 2.0
    found = numbers(
        material=neo_hookean(SOFT),
        regions=[
            {
                "within": {"y": [0.0, SIDE / 2]},
                "material": neo_hookean(STIFF, relaxation={"fractions": [fraction], "times": [time]}),
            }
        ],
        conditions=[*PLANES, {"kind": "displacement", "face": "top", "z": (STRETCH - 1) * SIDE}],
        amplitude={"pieces": [{"kind": "jump", "to": 1.0, "duration": 3.0}]},
        asked={
            "force": {"kind": "force", "face": "top", "component": "z"},
            "energy": {"kind": "energy"},
            "soft": {"kind": "stress", "at": [0.0, SIDE, 0.0], "component": "zz"},
        },
        geometry={"kind": "block", "x": CELLS, "y": CELLS, "z": CELLS},
    )
    kept = 1 - fraction + fraction * np.exp(-3.0 / time)

    def check(c10, lasting):
        assert found["force"] == pytest.approx(2 * c10 * (STRETCH - STRETCH**-2) * SIDE**2, rel=1e-6), "the steps of time"
        assert found["energy"] == pytest.approx(lasting * (STRETCH**2 + 2 / STRETCH - 3) * SIDE**3, rel=1e-9)

    check((SOFT + kept * STIFF) / 2, (SOFT + (1 - fraction) * STIFF) / 2)
    assert found["soft"] == pytest.approx(2 * SOFT * (STRETCH**2 - 1 / STRETCH), rel=1e-6)
    force = (SOFT + kept * STIFF) * (STRETCH - STRETCH**-2) * SIDE**2
    known = {"reference": "closed form, layers stretched alike", "kind": "exact", "mesh": "2 cells along each side"}
    verification_record("laminate with a layer that relaxes, force", found["force"], force, tolerance=1e-6, **known)
    assert_kills(
        check,
        no_layer=(SOFT, SOFT),
        all_of_it=(kept * STIFF, (1 - fraction) * STIFF),
        lasting=((SOFT + STIFF) / 2, (SOFT + STIFF) / 2),
    )


def cored_exactly(rubber=RUBBER, shear=CORE_C10):
    """Tension in Pa on the sleeve, its displacement in m, and the stress in Pa of the core across and along its axis.

    Nothing moves along the axis. The core is stretched evenly, J = CORE_STRETCH^2, so that its stress is the same everywhere: the
    mean K (J - 1), and 2 c10 J^(-5/3) times the deviator of diag(J, J, 1). The sleeve keeps its volume.
    """
    volume = CORE_STRETCH**2
    deviator = 2 * shear * volume ** (-5 / 3) * (volume - 1) / 3
    across, along = BULK * (volume - 1) + deviator, BULK * (volume - 1) - 2 * deviator

    def stretch(reference):
        return np.sqrt(1 + (volume - 1) * CORE**2 / reference**2)

    def rise(reference):
        squared = stretch(reference) ** 2
        return 2 * sum(rubber) * (squared - 1 / squared) / (squared * reference)

    return across + quad(rise, CORE, SLEEVE)[0], (stretch(SLEEVE) - 1) * SLEEVE, across, along


def cored(cells):
    """Displacement in m of the sleeve and stress in Pa in the middle of the core, under the exact tension."""
    spans = [{"length": length, "cells": cells} for length in (CORE, SLEEVE - CORE)]
    found = numbers(
        dimension="axisymmetric",
        geometry={"kind": "cylinder", "radial": spans, "axial": [{"length": CORE / 2, "cells": cells // 2}]},
        material=mooney_rivlin(*RUBBER),
        regions=[{"within": {"r": [0.0, CORE]}, "material": neo_hookean(CORE_C10, bulk_modulus=BULK)}],
        conditions=[
            *({"kind": "displacement", "face": face, "z": 0.0} for face in ("bottom", "top")),
            {"kind": "pressure", "face": "outer", "pressure": -cored_exactly()[0]},
        ],
        asked={
            "sleeve": {"kind": "displacement", "at": [SLEEVE, 0.0], "component": "r"},
            "across": {"kind": "stress", "at": [0.0, 0.0], "component": "rr"},
            "along": {"kind": "stress", "at": [0.0, 0.0], "component": "zz"},
        },
    )
    return [found[name] for name in ("sleeve", "across", "along")]


def test_a_compressible_core_is_drawn_wide_by_its_sleeve(one_thread, verification_record):
    """Mutants: a sleeve without c01 under the same tension, a core without shear stress, and one under the tension itself."""
    coarse, fine = cored(2), cored(4)
    tension, *exact = cored_exactly()

    def check(sleeve, across, along):
        assert fine[0] == pytest.approx(sleeve, rel=1e-4), "of the third order in cells of a quarter of the core"
        assert fine[1:] == pytest.approx([across, along], rel=1e-5), "of the fourth, for it is even in the core"

    check(*exact)
    assert abs(coarse[1] - exact[1]) > 4 * abs(fine[1] - exact[1])
    known = {"reference": "even core, balance of forces in the sleeve", "kind": "exact", "mesh": "8 x 2 cells"}
    verification_record("sleeve around a compressible core, displacement", fine[0], exact[0], **known, tolerance=1e-4)
    verification_record("compressible core in a sleeve, stress", fine[1:], exact[1:], **known, tolerance=1e-5)
    borne_by_the_sleeve = cored_exactly(rubber=(RUBBER[0], 0.0))[0] - exact[1]
    assert_kills(
        check,
        without_c01=(exact[0], tension - borne_by_the_sleeve, exact[2]),
        no_shear=(exact[0], *[BULK * (CORE_STRETCH**2 - 1)] * 2),
        no_sleeve=(exact[0], tension, exact[2]),
    )


def bent_exactly(under=LAYERS[0], over=LAYERS[1]):
    """Moment in N per depth and thickness in m of an arc of two layers, the lower one outside, without forces on its faces.

    A line at the height Y has the radius r, r^2 = inner^2 + 2 k (height - Y) with k = LENGTH / BEND, and the stretch r / k.
    """
    k, height = LENGTH / BEND, UNDER + OVER
    parts = ((0.0, UNDER, 2 * sum(under)), (UNDER, height, 2 * sum(over)))

    def radius(y, inner):
        return np.sqrt(inner**2 + 2 * k * (height - y))

    def tension(y, inner, modulus):
        squared = (radius(y, inner) / k) ** 2
        return modulus * (squared - 1 / squared)  # of the lines over that across them

    def rise(y, inner, modulus):
        return tension(y, inner, modulus) * k / radius(y, inner) ** 2

    def across(y, inner):
        """Stress across the lines: what lies above them pulls inwards."""
        above = ((max(y, low), high, modulus) for low, high, modulus in parts if y < high)
        return sum(quad(rise, low, high, args=(inner, modulus))[0] for low, high, modulus in above)

    def turning(y, inner, modulus):
        return (across(y, inner) + tension(y, inner, modulus)) * k

    inner = brentq(lambda inner: across(0.0, inner), 0.5 * k, 1.5 * k, xtol=1e-15)
    moment = sum(quad(turning, low, high, args=(inner, modulus))[0] for low, high, modulus in parts)
    return moment, radius(0.0, inner) - inner


def bent(cells):
    """Moment in N per depth and thickness in m of a strip of two layers whose ends turn against each other."""
    height = UNDER + OVER
    corners = {"low": [LENGTH, 0.0], "high": [LENGTH, height]}
    found = numbers(
        dimension="plane_strain",
        geometry={
            "kind": "block",
            "x": [{"length": LENGTH, "cells": 4 * cells}],
            "y": [{"length": length, "cells": cells} for length in (UNDER, OVER)],
        },
        material=mooney_rivlin(*LAYERS[1]),
        regions=[{"within": {"y": [0.0, UNDER]}, "material": mooney_rivlin(*LAYERS[0])}],
        conditions=[
            {"kind": "rotation", "face": face, "angle": angle, "about": [x, height / 2], "sliding": "in_plane"}
            for face, x, angle in (("left", 0.0, -BEND / 2), ("right", LENGTH, BEND / 2))
        ],
        asked={"moment": {"kind": "torque", "face": "right"}}
        | {
            f"{name}_{axis}": {"kind": "displacement", "at": at, "component": axis}
            for name, at in corners.items()
            for axis in "xy"
        },
    )
    return found["moment"], np.hypot(found["high_x"] - found["low_x"], found["high_y"] - found["low_y"] + height)


def test_a_strip_of_two_layers_is_bent_to_an_arc(one_thread, verification_record):
    """The force on an end is none, so that its moment is the same about any point. Mutants: the layers swapped, a strip of their
    mean, one without c01, and one that keeps its thickness."""
    (coarse, fine), exact = (bent(1), bent(2)), bent_exactly()

    def check(moment, thickness):
        assert fine[0] == pytest.approx(moment, rel=2e-4), "two cells of fourth order across each layer"
        assert fine[1] == pytest.approx(thickness, rel=2e-4)

    check(*exact)
    assert np.log2(abs(coarse[0] - exact[0]) / abs(fine[0] - exact[0])) > 3
    known = {"reference": "balance of forces, layer after layer", "kind": "exact", "mesh": "8 x 4 cells", "tolerance": 2e-4}
    verification_record("moment of a strip of two layers bent by 60 degrees", fine[0], exact[0], **known)
    verification_record("thickness of a strip of two layers bent by 60 degrees", fine[1], exact[1], **known)
    mean = [(UNDER * under + OVER * over) / (UNDER + OVER) for under, over in zip(*LAYERS, strict=True)]
    assert_kills(
        check,
        swapped=bent_exactly(*LAYERS[::-1]),
        mean=bent_exactly(mean, mean),
        without_c01=bent_exactly(*((c10, 0.0) for c10, _ in LAYERS)),
        as_thick=(exact[0], UNDER + OVER),
    )
