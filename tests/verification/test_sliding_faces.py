"""Faces that turn while their points slide: a strip bent to an arc, a tube twisted as it widens, a tube everted.

A Mooney-Rivlin body; flexure and torsion after Rivlin 1949, doi:10.1098/rsta.1949.0009. Each shape is known from the volume up to
a constant, which the balance of forces gives, as written beside it.
"""

from __future__ import annotations

import numpy as np
import pytest
from mutants import assert_kills
from scipy.integrate import quad
from scipy.optimize import brentq
from small_problems import numbers

C10, C01 = 30e3, 9e3
RUBBER = {"kind": "mooney_rivlin_2", "c10": C10, "c01": C01}
LENGTH, THICKNESS, BEND = 12e-3, 4e-3, np.radians(120)
TUBE, WIDER, HEIGHT, TWIST, STRETCH = (4e-3, 6e-3), 4.4e-3, 3e-3, np.radians(30), 1.2
"""Radii of the tube, its bore as it is inflated, its height, and by how much it is twisted and stretched."""
SLEEVE = (8e-3, 10e-3)
"""Radii of the tube that is everted."""


def spans(length, cells):
    return [{"length": length, "cells": cells}]


def bent_exactly(modulus=2 * (C10 + C01)):
    """Moment in N per depth and thickness in m of an arc without forces on its curved faces.

    Circles of the radius r were lines; their stretch is r / k with k = LENGTH / BEND. Free faces have r1 r2 = k^2, and the volume
    r2^2 - r1^2 = 2 k THICKNESS. The moment is the integral of the hoop stress times r.
    """
    k = LENGTH / BEND
    inner = np.sqrt(k * (np.hypot(THICKNESS, k) - THICKNESS))
    outer = k**2 / inner

    def hoop(r):
        radial = modulus * ((r**2 - inner**2) / (2 * k**2) + k**2 / 2 * (r**-2 - inner**-2))
        return radial + modulus * (r**2 / k**2 - k**2 / r**2)

    return quad(lambda r: hoop(r) * r, inner, outer)[0], outer - inner


def bent(cells, sliding="in_plane"):
    """Moment and thickness of a strip whose ends turn against each other about their middles, and the force on an end."""
    ends = (("left", 0.0, -BEND / 2), ("right", LENGTH, BEND / 2))
    corners = {"low": [LENGTH, 0.0], "high": [LENGTH, THICKNESS]}
    asked = {
        f"{name}_{axis}": {"kind": "displacement", "at": at, "component": axis} for name, at in corners.items() for axis in "xy"
    }
    found = numbers(
        dimension="plane_strain",
        geometry={"kind": "block", "x": spans(LENGTH, 3 * cells), "y": spans(THICKNESS, cells)},
        material=RUBBER,
        conditions=[
            {"kind": "rotation", "face": face, "angle": angle, "about": [x, THICKNESS / 2], "sliding": sliding}
            for face, x, angle in ends
        ],
        steps=6,
        asked=asked
        | {"moment": {"kind": "torque", "face": "right"}}
        | {f"force_{axis}": {"kind": "force", "face": "right", "component": axis} for axis in "xy"},
    )
    across = np.hypot(found["high_x"] - found["low_x"], found["high_y"] - found["low_y"] + THICKNESS)
    return found["moment"], float(across), np.hypot(found["force_x"], found["force_y"])


def test_a_strip_is_bent_to_an_arc(one_thread, verification_record):
    """Ends that turn about their middles meet the arc wherever it settles, and their force is none. Mutants: a modulus without
    c01, a strip that keeps its thickness, and ends that are glued to what turns them."""
    (coarse, fine), (moment, thickness) = (bent(2), bent(4)), bent_exactly()

    def check(moment, thickness, found=fine):
        assert found[0] == pytest.approx(moment, rel=1e-3), "of the fourth order in cells of a quarter of the thickness"
        assert found[1] == pytest.approx(thickness, rel=1e-3)

    check(moment, thickness)
    assert fine[2] < 1e-6 * C10 * THICKNESS
    assert np.log2(abs(coarse[0] / moment - 1) / abs(fine[0] / moment - 1)) > 3
    known = {"reference": "Rivlin 1949", "kind": "exact", "mesh": "12 x 4 cells", "tolerance": 1e-3}
    verification_record("moment of a strip bent to an arc of 120 degrees", fine[0], moment, **known)
    glued = bent(4, sliding="none")
    assert_kills(
        check,
        without_c01=(bent_exactly(2 * C10)[0], thickness),
        as_thick=(moment, THICKNESS),
        glued=(moment, thickness, glued),
    )


def twisted_exactly(c10=C10, c01=C01):
    """Pressure in Pa that widens the bore to WIDER, torque in N m and axial force in N of the twisted and stretched tube.

    r^2 = WIDER^2 + (R^2 - TUBE[0]^2) / STRETCH, and the angle rises by TWIST over the height. With B the left Cauchy-Green tensor
    the stress is 2 c10 B - 2 c01 B^-1 and a pressure, which the balance along r gives.
    """

    def state(reference):
        r = np.sqrt(WIDER**2 + (reference**2 - TUBE[0] ** 2) / STRETCH)
        shear = r * TWIST / HEIGHT
        gradient = np.array([[reference / (r * STRETCH), 0, 0], [0, r / reference, shear], [0, 0, STRETCH]])
        tensor = gradient @ gradient.T
        return r, 2 * c10 * tensor - 2 * c01 * np.linalg.inv(tensor), reference / (STRETCH * r)

    def rise(reference):
        r, stress, slope = state(reference)
        return (stress[1, 1] - stress[0, 0]) / r * slope

    def turning(reference):
        r, stress, slope = state(reference)
        return 2 * np.pi * r**2 * stress[1, 2] * slope

    pressure = quad(rise, *TUBE)[0]

    def pulling(reference):
        r, stress, slope = state(reference)
        return 2 * np.pi * r * slope * (quad(rise, TUBE[0], reference)[0] - pressure + stress[2, 2] - stress[0, 0])

    return pressure, quad(turning, *TUBE)[0], quad(pulling, *TUBE)[0]


def twisted(cells, pressure):
    """Displacement of the bore, torque and axial force of the tube between faces that let it widen."""
    found = numbers(
        geometry={
            "kind": "cylinder",
            "inner_radius": TUBE[0],
            "radial": spans(TUBE[1] - TUBE[0], cells),
            "axial": spans(HEIGHT, cells),
            "around": 3 * cells,
            "part": "whole",
        },
        material=RUBBER,
        conditions=[
            {"kind": "rotation", "face": "bottom", "angle": 0.0, "sliding": "radial"},
            {"kind": "rotation", "face": "top", "angle": TWIST, "sliding": "radial", "axial": "free"},
            {"kind": "displacement", "face": "top", "z": (STRETCH - 1) * HEIGHT},
            {"kind": "pressure", "face": "inner", "pressure": pressure},
        ],
        asked={
            "bore": {"kind": "displacement", "at": [TUBE[0], 0.0, 0.0], "component": "x"},
            "torque": {"kind": "torque", "face": "top"},
            "pull": {"kind": "force", "face": "top", "component": "z"},
        },
        steps=4,
    )
    return found["bore"], found["torque"], found["pull"]


def test_a_twisted_tube_widens(one_thread, verification_record):
    """Mutants: a torque and a force without c01, and a bore held at its radius."""
    pressure, torque, pull = twisted_exactly()
    coarse, fine = twisted(1, pressure), twisted(2, pressure)

    def check(bore, torque, pull):
        assert fine[0] == pytest.approx(bore, rel=1e-3), "two cells of cubic accuracy across the wall"
        assert fine[1:] == pytest.approx((torque, pull), rel=5e-4), "of the energy, whose order is the fourth"

    check(WIDER - TUBE[0], torque, pull)
    assert abs(coarse[1] / torque - 1) > 10 * abs(fine[1] / torque - 1), "sixteen times, were the cells fine already"
    known = {"reference": "Rivlin 1949", "kind": "exact", "mesh": "2 cells x 24 around", "tolerance": 5e-4}
    verification_record("torque of a tube twisted, stretched and inflated", fine[1], torque, **known)
    assert_kills(
        check,
        without_c01=(WIDER - TUBE[0], *twisted_exactly(c01=0.0)[1:]),
        held=(0.0, torque, pull),
    )


def everted_exactly(c10=C10, c01=C01):
    """Inner radius in m and axial force in N of an everted tube that keeps its length: r^2 = a^2 + SLEEVE[1]^2 - R^2."""

    def rise(reference, inner):
        stretch = np.sqrt(inner**2 + SLEEVE[1] ** 2 - reference**2) / reference
        return 2 * (c10 + c01) * (stretch**2 - stretch**-2) / (reference * stretch**2)

    inner = brentq(lambda a: quad(rise, *SLEEVE, args=(a,))[0], 0.8 * SLEEVE[0], 1.2 * SLEEVE[0], xtol=1e-15)

    def pulling(reference):
        stretch = np.sqrt(inner**2 + SLEEVE[1] ** 2 - reference**2) / reference
        radial = quad(rise, reference, SLEEVE[1], args=(inner,))[0]
        return 2 * np.pi * reference * (radial + 2 * (c10 + c01 * stretch**2) * (1 - stretch**-2))

    return inner, quad(pulling, *SLEEVE)[0]


def everted(cells, turn=np.pi):
    """Inner radius and axial force of a tube whose ends turn by half a turn about the middle of its section."""
    height, middle = 2e-3, sum(SLEEVE) / 2
    ends = [
        {"kind": "rotation", "face": face, "angle": turn, "about": [middle, height / 2], "sliding": "in_plane"}
        for face in ("bottom", "top")
    ]
    found = numbers(
        dimension="axisymmetric",
        geometry={
            "kind": "cylinder",
            "inner_radius": SLEEVE[0],
            "radial": spans(SLEEVE[1] - SLEEVE[0], cells),
            "axial": spans(height, cells),
        },
        material=RUBBER,
        conditions=ends,
        asked={
            "inner": {"kind": "displacement", "at": [SLEEVE[1], height / 2], "component": "r"},
            "pull": {"kind": "force", "face": "bottom", "component": "z"},
        },
        steps=20,
    )
    return SLEEVE[1] + found["inner"], found["pull"]


def test_a_tube_is_everted(one_thread, verification_record):
    """The outer face becomes the inner one. Mutants: a force without c01, of the other sign, and nine tenths of the way."""
    inner, pull = everted_exactly()
    coarse, fine = everted(2), everted(4)

    def check(inner, pull, found=fine):
        assert found[0] - SLEEVE[1] == pytest.approx(inner - SLEEVE[1], rel=1e-4), "third order, 1.4e-4 on cells twice as large"
        assert found[1] == pytest.approx(pull, rel=1e-4)

    check(inner, pull)
    assert np.log2(abs(coarse[0] - inner) / abs(fine[0] - inner)) > 2.5
    known = {"reference": "balance of forces", "kind": "exact", "mesh": "4 x 4 cells", "tolerance": 1e-4}
    verification_record("axial force of an everted tube", fine[1], pull, **known)
    assert_kills(
        check,
        without_c01=(inner, everted_exactly(c01=0.0)[1]),
        other_sign=(inner, -pull),
        part_of_the_way=(inner, pull, everted(2, turn=0.9 * np.pi)),
    )
