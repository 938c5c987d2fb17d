"""Histories: their values, sums, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tactsim.analytic.histories import Harmonic, History, Segment, harmonic, ramp, sampled, step
from tactsim.errors import InvalidQuantity

TIMES = np.array([-1.0, 0.0, 0.3, 1.0, 2.0, 2.5, 7.0])


def test_steps_ramps_and_harmonics():
    assert step(3.0).value(TIMES).tolist() == [0, 3, 3, 3, 3, 3, 3]
    np.testing.assert_allclose(ramp(2.0, 2.0).value(TIMES), [0, 0, 0.6, 2, 4, 4, 4], rtol=1e-15)
    wave = harmonic(2.0, 0.5, start=1.0, mean=-1.0).value(TIMES)
    expected = [0, -1, -1, *(-1 + 2 * np.sin(np.pi * (TIMES[3:] - 1)))]
    np.testing.assert_allclose(wave, expected, rtol=1e-14, atol=1e-15)
    assert step(1.0).value(np.zeros((2, 3))).shape == (2, 3)


def test_samples_are_joined_by_lines_after_a_jump_and_held():
    history = sampled([0.5, 1.0, 2.0], [1.0, 3.0, -1.0])
    t = np.array([0.0, 0.49, 0.5, 0.75, 1.5, 2.0, 9.0])
    np.testing.assert_allclose(history.value(t), [0, 0, 1, 2, 1, -1, -1], rtol=1e-15)
    assert sampled([0.0, 1.0], [2.0, 2.0]).value(0.0) == 2.0


def test_a_history_that_ends_is_held_at_its_last_value():
    history = History([Segment(0.0, 0.25, 1.0, 4.0, (Harmonic(2.0, 2 * np.pi),))])
    assert history.value([0.25, 5.0]).tolist() == pytest.approx([4.0, 4.0], rel=1e-15)


def test_sums_keep_every_jump_and_every_frequency():
    parts = ramp(1.0, 1.5), harmonic(2.0, 0.7, start=0.4), harmonic(0.5, 3.1, mean=1.0), sampled([0.2, 0.9, 3.0], [1.0, 2.0, 0.0])
    total = parts[0].added(parts[1]).added(parts[2]).added(parts[3])
    t = np.linspace(-1, 10, 500)
    np.testing.assert_allclose(total.value(t), sum(part.value(t) for part in parts), rtol=1e-13, atol=1e-13)
    assert total.starts.tolist() == [0.0, 0.2, 0.4, 0.9, 1.5, 3.0]
    assert max(len(segment.harmonics) for segment in total.segments) == 2


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: sampled([0.0, 1.0], [1.0, math.nan]), "NaN or infinity"),
        (lambda: sampled([0.0, math.inf], [1.0, 1.0]), "NaN or infinity"),
        (lambda: sampled([0.0, 2.0, 1.0], [1.0] * 3), r"times\[2\] is 1 s after 2 s; allowed: increasing"),
        (lambda: sampled([0.0, 1.0, 1.0], [1.0] * 3), r"times\[2\] is 1 s after 1 s"),
        (lambda: sampled([0.0], [1.0]), r"shapes \(1,\) and \(1,\)"),
        (lambda: sampled([0.0, 1.0], [1.0]), r"shapes \(2,\) and \(1,\)"),
        (lambda: sampled([-1.0, 1.0], [1.0, 1.0]), r"times\[0\] is -1 s; allowed: >= 0"),
        (lambda: History(()), "at least one"),
        (lambda: History((Segment(1.0, 2.0, 0.0),)), "the first from 0 s"),
        (lambda: History((Segment(0.0, 1.0, 0.0), Segment(1.5, 2.0, 0.0))), "ends at 1.0 s, the next starts at 1.5 s"),
        (lambda: Segment(1.0, 1.0, 0.0), r"\[1.0, 1.0\) s; allowed: 0 <= start < end"),
        (lambda: Segment(0.0, 1.0, math.nan), "value nan"),
        (lambda: Segment(math.nan, 1.0, 0.0), r"\[nan, 1.0\)"),
        (lambda: Harmonic(1.0, -1.0), "angular_frequency >= 0"),
        (lambda: Harmonic(math.nan, 1.0), "finite numbers"),
        (lambda: step(math.inf), "value inf"),
        (lambda: ramp(1.0, 0.0), "duration is 0.0; allowed: finite and > 0"),
        (lambda: harmonic(1.0, 0.0), "frequency is 0.0"),
        (lambda: harmonic(1.0, 1.0, start=-1.0), "start is -1.0"),
        (lambda: step(1.0).value(math.nan), "t is nan"),
        (lambda: step(1.0).value([0.0, math.inf]), "inf.*; allowed: finite times"),
    ],
)
def test_impossible_histories_are_refused(build, message):
    with pytest.raises(InvalidQuantity, match=message):
        build()
