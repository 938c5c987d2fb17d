"""How long the steps of a history are, and when they are load steps."""

from __future__ import annotations

import math

import pytest

from tactsim.analytic.histories import Harmonic, Segment
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.mechanics.paths.history_path import TimeInterval
from tactsim.mechanics.paths.step_policy import FIRST_SHARE, SMALLEST_SHARE, StepPolicy, TimeSettings, shortest_relaxation_time
from tactsim.relaxation import Relaxation

SETTINGS = TimeSettings(tolerance=0.01, per_decade=0)
HELD = TimeInterval(0.0, 2.0, (Segment(0.0, 2.0, 1.0),))
RAMPED = TimeInterval(0.0, 2.0, (Segment(0.0, 2.0, 0.0, 0.5),))
BENT = TimeInterval(0.0, 2.0, (Segment(0.0, 2.0, 1.0, 0.0, (Harmonic(0.1, 2 * math.pi / 8.0, 0.0),)),))
"""A quarter of a period of 8 s."""


def policy(shortest: float = math.inf, *, sparing: bool = False) -> StepPolicy:
    """Twenty steps of a ramp, ten of a period."""
    return StepPolicy(SETTINGS, shortest, per_ramp=20, per_period=10, sparing=sparing)


@pytest.mark.parametrize(
    ("interval", "sparing", "longest"),
    [(HELD, False, 2.0), (RAMPED, False, 0.1), (BENT, False, 0.1), (HELD, True, 2.0), (RAMPED, True, 0.1), (BENT, True, 0.8)],
)
def test_longest_step(interval: TimeInterval, sparing: bool, longest: float) -> None:
    assert policy(sparing=sparing).largest(interval) == pytest.approx(longest)


def test_load_steps_are_those_of_a_sparing_policy_where_nothing_relaxes() -> None:
    control = policy(sparing=True).control(RAMPED)
    assert (control.first, control.tolerance) == (pytest.approx(0.1), 1.0)
    assert policy(sparing=True).stops(RAMPED) == [2.0]
    timed = policy().control(RAMPED)
    assert (timed.first, timed.tolerance) == (pytest.approx(FIRST_SHARE * 2.0), 0.01)


def test_steps_grow_faster_while_nothing_changes() -> None:
    assert [policy(0.5).control(interval).growth for interval in (HELD, RAMPED, BENT)] == [5.0, 2.0, 2.0]


def test_first_step_resolves_the_shortest_time_where_it_must() -> None:
    jump = TimeInterval(0.0, 2.0, HELD.segments, sudden=True)
    assert policy(0.01).control(HELD).first == pytest.approx(FIRST_SHARE * 0.01)
    assert policy(0.01, sparing=True).control(jump).first == pytest.approx(FIRST_SHARE * 0.01)
    smooth = policy(0.01, sparing=True).control(HELD)
    assert smooth.first == pytest.approx(FIRST_SHARE * 2.0)
    assert smooth.smallest == pytest.approx(SMALLEST_SHARE * smooth.first)


def test_shortest_of_all_relaxation_times() -> None:
    slow = NeoHookean(c10=1e3, relaxation=Relaxation(fractions=(0.2, 0.3), times=(5.0, 0.5)))
    assert shortest_relaxation_time([NeoHookean(c10=1e3), slow]) == 0.5
    assert shortest_relaxation_time([NeoHookean(c10=1e3)]) == math.inf
