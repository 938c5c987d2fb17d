"""Bodies of two materials: a tube of two layers under pressure, and a laminate that is stretched while one layer relaxes."""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.integrate import quad
from small_problems import CELLS, PLANES, SIDE, numbers

INNER, BETWEEN, OUTER, WIDER = 4e-3, 5e-3, 7e-3, 4.8e-3
"""Radii of the tube before, and of its bore under pressure."""
SOFT, STIFF = 10e3, 80e3
"""c10 in Pa of the layers."""
STRETCH = 1.6


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


def test_a_laminate_is_stretched_while_a_layer_relaxes(one_thread):
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
    assert_kills(
        check,
        no_layer=(SOFT, SOFT),
        all_of_it=(kept * STIFF, (1 - fraction) * STIFF),
        lasting=((SOFT + STIFF) / 2, (SOFT + STIFF) / 2),
    )
