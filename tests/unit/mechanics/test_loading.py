"""Histories of a case file: pieces, their values, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from tactsim.errors import Refused
from tactsim.experiments.boundary_value.conditions import ClampCondition
from tactsim.mechanics.paths.loading import AnyLoading, DisplacementLoading, ForceLoading, Hold, Jump, Ramp, Samples, Sine

ADAPTER = TypeAdapter(AnyLoading)


def read(control, *pieces):
    return ADAPTER.validate_python({"control": control, "pieces": list(pieces)}, context={"units": "required"})


def test_pieces_follow_each_other():
    loading = read(
        "force",
        {"kind": "jump", "to": "0.3 N", "duration": "2 s"},
        {"kind": "sine", "amplitude": "0.2 N", "frequency": "1 Hz", "duration": "4 s"},
        {"kind": "ramp", "to": "1 N", "duration": "1 s"},
        {"kind": "hold", "duration": "3 s"},
        {"kind": "samples", "times": ["0 s", "1 s", "3 s"], "values": ["0.5 N", "0.7 N", "0.1 N"]},
    )
    history = loading.history()
    times = np.array([0.0, 1.9, 2.25, 2.75, 6.5, 8.0, 10.5, 12.0, 99.0])
    expected = [0.3, 0.3, 0.5, 0.1, 0.65, 1.0, 0.6, 0.4, 0.1]
    np.testing.assert_allclose(history.value(times), expected, rtol=1e-12)
    assert loading.duration == pytest.approx(13.0)
    assert loading.least_and_most() == pytest.approx((0.1, 1.0))


@pytest.mark.parametrize(
    ("control", "piece", "words"),
    [
        ("force", {"kind": "jump", "to": "3 mm", "duration": "1 s"}, "wrong dimension"),
        ("displacement", {"kind": "ramp", "to": "1 N", "duration": "1 s"}, "wrong dimension"),
        ("force", {"kind": "hold", "duration": "0 s"}, "greater than 0"),
        ("force", {"kind": "hold", "duration": 1.0}, "has no unit"),
        ("force", {"kind": "sine", "amplitude": "1 N", "frequency": "-1 Hz", "duration": "1 s"}, "greater than 0"),
        ("force", {"kind": "samples", "times": ["0 s", "1 s"], "values": ["1 N"]}, "each time needs its value"),
        ("force", {"kind": "samples", "times": ["0 s", "0 s"], "values": ["1 N", "1 N"]}, "increase"),
        ("force", {"kind": "samples", "times": ["1 s", "2 s"], "values": ["1 N", "1 N"]}, "begin at zero"),
        ("force", {"kind": "samples", "times": ["0 s", "1 s"], "values": ["nan N", "1 N"]}, "not finite"),
        ("force", {"kind": "jerk", "duration": "1 s"}, "jerk"),
    ],
)
def test_impossible_pieces_are_refused(control, piece, words):
    with pytest.raises(ValidationError, match=words):
        read(control, piece)


def test_a_history_needs_a_piece():
    with pytest.raises(ValidationError, match="at least one piece"):
        read("force")


@pytest.mark.parametrize("control", ["force", "displacement"])
def test_what_is_taken_back_to_zero_is_zero_and_not_below_it_by_round_off(control):
    unit = {"force": "N", "displacement": "mm"}[control]
    back = [{"kind": "ramp", "to": f"0 {unit}", "duration": "1.3 s"}, {"kind": "hold", "duration": "2.5 s"}]
    up = [{"kind": "ramp", "to": f"1.4 {unit}", "duration": "4.3 s"}, {"kind": "hold", "duration": "3.8 s"}]
    loading = read(control, *up, *back)
    assert loading.history().value(loading.duration) == 0.0
    assert loading.least_and_most()[0] == 0.0
    samples = {"kind": "samples", "times": ["0 s", "0.7 s", "2 s"], "values": [f"1.4 {unit}", f"0.3 {unit}", f"0 {unit}"]}
    assert read(control, *up, samples, back[1]).least_and_most()[0] == 0.0


def test_bounds_count_the_end_of_a_ramp_before_a_jump():
    up, down = {"kind": "ramp", "to": "3 N", "duration": "0.3 s"}, {"kind": "jump", "to": "1 N", "duration": "1 s"}
    assert read("force", up, down).least_and_most() == (1.0, 3.0)


def test_pieces_made_in_python_are_those_of_a_file():
    """Their values are text, or in SI; the kind is that of the class."""
    pieces = (
        Jump(to="0.3 N", duration="2 s"),
        Sine(amplitude=0.2, frequency="1 Hz", duration=np.float32(4)),
        Ramp(to="1 N", duration="1 s"),
        Hold(duration="3 s"),
        Samples(times=[0, "1 s"], values=["500 mN", 0.7]),
    )
    written = (
        {"kind": "jump", "to": "0.3 N", "duration": "2 s"},
        {"kind": "sine", "amplitude": "0.2 N", "frequency": "1 Hz", "duration": "4 s"},
        {"kind": "ramp", "to": "1 N", "duration": "1 s"},
        {"kind": "hold", "duration": "3 s"},
        {"kind": "samples", "times": ["0 s", "1 s"], "values": ["0.5 N", "0.7 N"]},
    )
    assert ForceLoading(pieces=pieces) == read("force", *written)
    assert ForceLoading(ForceLoading(pieces).pieces) == read("force", *written)
    with pytest.raises(Refused, match=r"DisplacementLoading: pieces\.0.*'0\.3 N' has the wrong dimension; expected a length"):
        DisplacementLoading(pieces=pieces[:1])


def test_what_a_class_alone_is_need_not_be_said_of_it():
    assert ClampCondition(face="bottom").kind == "clamped"
    assert Ramp(to=1e-3, duration=1.0) == Ramp(kind="ramp", to=1e-3, duration=1.0)
    with pytest.raises(Refused, match="control: 'force' is not allowed"):
        DisplacementLoading(control="force", pieces=[Hold(duration=1.0)])
