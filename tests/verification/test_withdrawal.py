"""A sphere pressed into relaxing tissue and withdrawn, until the tissue loses touch with it and goes on recovering.

Reference: while the contact grows, the force is the fading memory of the elastic one; while it shrinks, it is that of the force
up to the time t1 at which the contact was as large (Ting 1966, doi:10.1115/1.3625192):

.. math:: P(t) = \\int_0^{t_1} g(t - s)\\, dP_e(\\delta(s)), \\qquad \\int_{t_1}^t g(t - s)\\, \\dot\\delta(s)\\, ds = 0

It holds for an incompressible layer of any thickness, and with the elastic force of the same mesh for the mesh, whose contact
grows from node to node. Mutants: the memory of the whole elastic force, as if the tissue stuck to the sphere (Lee & Radok 1960),
another relaxation time, and no relaxation.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from small_problems import SIDE, result_of

FRACTIONS, TIMES, DEPTH = (0.3, 0.4), (0.2, 2.0), 0.01 * SIDE
TOLERANCE = 0.01
"""Largest error over the peak: the pressed nodes release one by one, an elastic curve of 40 steps, 5e-3 in time."""


def forces(relaxation, pieces, steps):
    """Times in s and forces in N of the sphere."""
    spans = {"radial": [{"length": 2 * SIDE, "cells": 12}], "axial": [{"length": SIDE, "cells": 6}]}
    sphere = {"face": "top", "side": "top", "body": {"kind": "sphere", "radius": 20 * SIDE}, "z": -DEPTH}
    result = result_of(
        dimension="axisymmetric",
        geometry={"kind": "cylinder", **spans},
        material={"kind": "linear_elastic", "youngs_modulus": 3e3, "poisson_ratio": 0.5, "relaxation": relaxation},
        conditions=[{"kind": "clamped", "face": "bottom"}],
        contacts=[sphere],
        amplitude={"pieces": [{"kind": "ramp", "to": to, "duration": 1.0} for to in pieces]},
        steps=steps,
        time={"tolerance": 5e-3},
        asked={"force": {"kind": "contact_force", "component": "z", "factor": -1.0}},
    )
    return result.history_values("time"), result.history_values("force")


def kept(time, times=TIMES):
    """Part of an elastic force that is left after a time in s."""
    faded = sum(part * (1 - np.exp(-np.asarray(time) / tau)) for part, tau in zip(FRACTIONS, times, strict=True))
    return 1 - faded


def passed(time, times=TIMES):
    """Integral in s over a time in s of what is left of an elastic force."""
    return time - sum(part * (time + tau * np.expm1(-time / tau)) for part, tau in zip(FRACTIONS, times, strict=True))


def memory(elastic, time, until, times=TIMES):
    """Fading memory at a time in s of the elastic force up to another time."""
    s = np.linspace(0.0, until, 2001)
    return float(kept(time - (s[1:] + s[:-1]) / 2, times) @ np.diff(elastic(s)))


def as_large_before(time, times=TIMES):
    """When the contact was as large as at a time in s after the turn at 1 s; zero if it never was."""

    def moved(start):
        return passed(time - start, times) - 2 * passed(time - 1.0, times)

    return brentq(moved, 0.0, 1.0) if moved(0.0) > 0 else 0.0


@pytest.mark.slow
def test_a_sphere_is_withdrawn_from_relaxing_tissue(one_thread, verification_record):
    pressed, elastic_force = forces(None, [1.0], 40)
    # Against the depth to 3/2, in which a Hertzian force is a straight line.
    curve = PchipInterpolator(np.append(0.0, pressed) ** 1.5, np.append(0.0, elastic_force))
    time, computed = forces({"fractions": FRACTIONS, "times": TIMES}, [1.0, 0.0, 0.0], 10)
    assert time[-1] == 3.0

    def elastic(s):
        return curve(s**1.5)

    def expected(times=TIMES):
        turned = [as_large_before(now, times) if now > 1 else now for now in time]
        return np.array([memory(elastic, now, until, times) for now, until in zip(time, turned, strict=True)])

    def check(reference):
        assert np.abs(computed - reference).max() < TOLERANCE * computed.max()

    reference = expected()
    check(reference)
    gone = time > time[reference > 0].max()
    assert 1.6 < time[gone].min() < 1.8  # before the sphere is back where it first touched
    assert (computed[gone] == 0).all()
    stuck = [memory(lambda s: elastic(1 - np.abs(1 - np.minimum(s, 2))), now, now) for now in time]
    known = {"reference": "Ting 1966", "kind": "exact", "mesh": "12 by 6 cells", "tolerance": TOLERANCE}
    verification_record(
        "force on a withdrawn sphere over its peak", computed / reference.max(), reference / reference.max(), **known
    )
    assert_kills(
        check,
        stuck=(np.array(stuck),),
        time=(expected((0.1, 2.0)),),
        elastic=(elastic(np.clip(1 - np.abs(1 - time), 0, None)),),
    )
