"""The trapezoid: exact distances, its corners, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tactsim.contact.trapezoid import Trapezoid
from tactsim.errors import CaseError

LEAN = math.radians(20)
SHARP = Trapezoid(face=2e-3, fillet=0.0, height=8e-3)


def distance(body, *points):
    return body.signed_distance(np.array(points, float).T * 1e-3)[0] * 1e3


def test_distances_to_face_side_corner_and_inside():
    along, across = np.array([math.sin(LEAN), math.cos(LEAN)]), np.array([math.cos(LEAN), -math.sin(LEAN)])
    beside = np.array([1.0, 0.0]) + 3 * along + 0.5 * across
    computed = distance(SHARP, (0, -1), (0.5, -0.25), (1 + 3e-1, -4e-1), beside, (0, 0.1), (0, 8.5))
    np.testing.assert_allclose(computed, [1, 0.25, 0.5, 0.5, -0.1, 0.5], rtol=1e-12)
    np.testing.assert_allclose(distance(SHARP, *(np.array([[-1, 1]]) * [beside, (1.3, -0.4)])), [0.5, 0.5], rtol=1e-12)


def test_the_sides_lean_by_the_angle_of_the_thesis():
    body = Trapezoid()
    height = np.array([1e-3, 5e-3])
    np.testing.assert_allclose(np.diff(body.half_width(height)) / 4e-3, math.tan(LEAN), rtol=1e-12)
    gap, normal, _ = body.signed_distance(np.stack([body.half_width(height), height]))
    np.testing.assert_allclose(gap, 0, atol=1e-15)
    np.testing.assert_allclose(np.degrees(np.arctan2(-normal[1], normal[0])), 20, rtol=1e-12)
    steeper = Trapezoid(lean=math.radians(21)).signed_distance(np.stack([body.half_width(height), height]))[0]
    assert (np.abs(steeper) > 1e-5).all()


def test_the_fillet_touches_face_and_side():
    body = Trapezoid(fillet=0.5e-3)
    inner = body.radius - body.fillet * (1 - math.sin(LEAN)) / math.cos(LEAN)
    ends = np.array([[inner, body.half_width(body.fillet_height)], [0.0, body.fillet_height]])
    gap, normal, hessian = body.signed_distance(ends)
    np.testing.assert_allclose(gap, 0, atol=1e-15)
    np.testing.assert_allclose(normal.T, [[0, -1], [math.cos(LEAN), -math.sin(LEAN)]], atol=1e-7)
    arc = np.array([[inner], [body.fillet]]) + 0.6e-3 * np.array([[math.sin(0.5)], [-math.cos(0.5)]])
    gap, _, hessian = body.signed_distance(arc)
    assert gap[0] == pytest.approx(0.1e-3, rel=1e-9)
    assert np.trace(hessian[..., 0]) == pytest.approx(1 / 0.6e-3, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"fillet": 2e-3}, "leaves no face"),
        ({"fillet": 0.5e-3, "height": 0.8e-3}, "leaves no face"),
        ({"lean": math.radians(85)}, "at most"),
        ({"lean": -0.1}, "at least"),
        ({"face": 0.0}, "greater than 0"),
    ],
)
def test_impossible_sections_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        Trapezoid(**changes)
