"""The sensing algorithm of chapter 5: clean touches to one sample, false switches as noise predicts, unloading never recorded."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.sensors.switch_array import SwitchArray, rising
from tactsim.sensors.switch_reading import SwitchState, read_switches

RATE, STEP = 1e-3, 1e-3
"""Of the indentation in m/s, and between samples in s."""
STIFFNESS = 200.0
"""Force on the probe over its depth in N/m; a switch carries half of that over the depth since it was reached."""


def touch_signals(ways=(0.0, 5.5e-3, 0.0), rest=0.1):
    """Clean time, force and switches of a probe that moves between depths in m at the rate, after a rest and before another."""
    ends = np.cumsum([rest, *np.abs(np.diff(ways)) / RATE, rest])
    time = np.arange(0.0, ends[-1], STEP)
    depth = np.interp(time, [0.0, *ends], [ways[0], *ways, ways[-1]])
    force = STIFFNESS * depth
    switches = STIFFNESS / 2 * np.maximum(depth[:, None] - SwitchArray().heights, 0.0)
    return time, force, switches


def noisy(signals, noise, seed=0):
    time, force, switches = signals
    generator = np.random.default_rng(seed)
    return time, force + generator.normal(0, noise, force.shape), switches + generator.normal(0, noise, switches.shape)


def test_a_clean_touch_is_right_to_one_sample():
    array = SwitchArray()
    (touch,) = read_switches(array, *touch_signals()).touches
    assert touch.complete(array)
    expected = 0.1 + array.heights / RATE
    times = np.array([closing.time for closing in touch.closings])
    assert touch.start - 0.1 == pytest.approx(STEP, abs=0.01 * STEP)
    assert ((times > expected) & (times <= expected + 1.001 * STEP)).all()
    assert np.abs(touch.intervals() - 1.0).max() <= 1.001 * STEP
    forces = np.array([closing.force for closing in touch.closings])
    assert (np.abs(forces - STIFFNESS * array.heights) <= 1.001 * STIFFNESS * RATE * STEP).all()
    assert touch.mean_rate(array) == pytest.approx(RATE, rel=STEP)
    assert touch.mean_rate(SwitchArray(formula="as_printed")) != pytest.approx(RATE, rel=STEP)


def test_both_readings_of_the_mean_rate():
    times = np.arange(1.0, 6.0)
    assert SwitchArray().mean_rate(0.0, times) == pytest.approx(1e-3, rel=1e-12)
    assert SwitchArray(formula="as_printed").mean_rate(0.0, times) == pytest.approx(5e-3 / 15, rel=1e-12)
    with pytest.raises(InvalidQuantity, match="all 5 switches"):
        SwitchArray().mean_rate(0.0, times[:3])
    with pytest.raises(InvalidQuantity, match="later than it"):
        SwitchArray().mean_rate(6.0, times)


@pytest.mark.parametrize("cuts", [(1,), (7, 8, 3000, 5000), tuple(range(1, 11000, 97))])
def test_streaming_is_offline(cuts):
    array, signals = SwitchArray().above_noise(2e-3, 2e-3, times=8), noisy(touch_signals(), 2e-3)
    whole, ended, state = read_switches(array, *signals), [], None
    for block in zip(*(np.split(values, cuts) for values in signals), strict=True):
        reading = read_switches(array, *block, state=state)
        ended, state = [*ended, *reading.ended], reading.state
    assert tuple(ended) == whole.ended
    assert state.touch == whole.state.touch
    assert len(ended[0].closings) == 5
    lost = read_switches(array, *(values[4000:] for values in signals))
    assert lost.ended != whole.ended, "without the state of the first block"


def false_switching_rate(times: float) -> float:
    r"""Share of the samples of an open switch that `rising` takes, with a threshold of ``times`` its white Gaussian noise.

    .. math:: P(x_N > k,\ x_N > x_{N-1}) = \int_k^\infty \varphi \Phi\, dx = \tfrac12 (1 - \Phi(k)^2)

    """
    tail = float(ndtr(-times))
    return tail * (1 - tail / 2)


@pytest.mark.parametrize("times", [2.0, 3.0, 3.5])
def test_false_switches_come_as_often_as_the_noise_predicts(times):
    samples, noise = 100_000, 1e-3
    generator = np.random.default_rng(3)
    signals = generator.normal(0, noise, (samples, 5))
    counted = rising(signals, times * noise, np.full(5, np.inf)).mean(axis=0)

    def holds(predicted):
        return ((counted > predicted / 2) & (counted < 2 * predicted)).all()

    assert holds(false_switching_rate(times))
    assert not holds(false_switching_rate(times + 0.5))


def test_false_switches_of_the_algorithm_and_none_at_eight():
    """Touches of 50 samples whose switches stay open: each may close falsely once."""
    period, count, noise = 50, 2000, 1e-3
    time = np.arange(period * count) * STEP
    force = np.where(np.arange(period * count) % period < period - 1, 1.0, 0.0)
    switches = np.random.default_rng(5).normal(0, noise, (len(time), 5))
    for times, few in ((2.5, False), (3.0, False), (8.0, True)):
        array = SwitchArray(touch_threshold=0.5, switch_threshold=times * noise, fall=0.1)
        touches = read_switches(array, time, force, switches).touches
        assert len(touches) == count
        counted = sum(len(touch.closings) for touch in touches)
        predicted = 5 * count * (1 - (1 - false_switching_rate(times)) ** (period - 1))
        assert (counted == 0) if few else (predicted / 2 < counted < 2 * predicted)


def test_the_rate_is_that_of_two_gaussian_samples():
    generator = np.random.default_rng(1)
    first, second = generator.standard_normal((2, 2_000_000))
    share = ((second > 1.5) & (second > first)).mean()
    assert share == pytest.approx(false_switching_rate(1.5), rel=0.01)  # four standard deviations of the count
    assert share != pytest.approx(false_switching_rate(1.53), rel=0.01)


def unloading_samples(times_noise, seed):
    """Noisy touch, with the algorithm and the bare rule: closings of each later than the turn."""
    noise = 2e-3
    time, force, switches = noisy(touch_signals(), noise, seed)
    turn = 0.1 + 5.5e-3 / RATE
    array = SwitchArray().above_noise(noise, noise, times=times_noise)
    closings = [c for touch in read_switches(array, time, force, switches).touches for c in touch.closings]
    bare = rising(switches, array.switch_threshold, np.full(5, np.inf)) & (force > array.touch_threshold)[:, None]
    return sum(c.time > turn for c in closings), int(bare[time > turn].sum()), len(closings)


@pytest.mark.parametrize("seed", range(20))
def test_unloading_is_never_recorded_though_the_bare_rule_takes_it(seed):
    late, bare, closings = unloading_samples(8.0, seed)
    assert (late, closings) == (0, 5)
    assert bare > 1000, "half of the noisy samples rise above the one before"


def test_a_switch_that_first_presses_on_the_way_back_is_not_recorded():
    time, force, switches = touch_signals()
    turn = int(np.argmax(force))
    switches[: turn + 500, 4], switches[turn + 500 :, 4] = 0.0, 0.05
    array = SwitchArray(fall=0.05)
    (touch,) = read_switches(array, time, force, switches).touches
    assert [closing.switch for closing in touch.closings] == [1, 2, 3, 4]
    assert touch.mean_rate(array) is None
    (wide,) = read_switches(SwitchArray(fall=0.2), time, force, switches).touches
    assert len(wide.closings) == 5, "a fall that is never reached shows nothing"


def test_a_pause_and_a_second_push_are_one_touch():
    (touch,) = read_switches(SwitchArray(), *touch_signals((0.0, 2.5e-3, 2.0e-3, 5.5e-3, 0.0))).touches
    assert [closing.switch for closing in touch.closings] == [1, 2, 3, 4, 5]
    assert touch.end is not None


def test_every_touch_has_its_record():
    array = SwitchArray().above_noise(2e-3, 2e-3, times=8)
    pauses = (0.0, 5.5e-3, 0.0, 0.0, 5.5e-3, 0.0, 3.2e-3, 0.0)
    touches = read_switches(array, *noisy(touch_signals(pauses), 2e-3)).touches
    assert [len(touch.closings) for touch in touches if touch.closings] == [5, 5, 3]
    assert [touch.mean_rate(array) is None for touch in touches if touch.closings] == [False, False, True]


def test_the_first_sample_has_none_before_it():
    time, force, switches = (values[3000:] for values in touch_signals())
    (touch,) = read_switches(SwitchArray(), time, force, switches).touches
    assert touch.closings[0].time == time[1]


def test_nothing_is_nothing():
    state = SwitchState()
    reading = read_switches(SwitchArray(), np.zeros(0), np.zeros(0), np.zeros((0, 5)), state=state)
    assert (reading.touches, reading.state) == ((), state)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda t, f, s: (t[::-1], f, s), "increasing"),
        (lambda t, f, s: (t, f, s[:, :3]), r"\(n, 5\)"),
        (lambda t, f, s: (t, np.where(t > 1, np.nan, f), s), "force of sample .* not finite"),
        (lambda t, f, s: (t, f, np.where(t[:, None] > 1, np.inf, s)), "switches of sample .* not finite"),
        (lambda t, f, s: (t[:-1], f, s), "allowed"),
    ],
)
def test_bad_signals_are_refused(spoil, words):
    with pytest.raises(InvalidQuantity, match=words):
        read_switches(SwitchArray(), *spoil(*touch_signals()))


def test_a_block_that_does_not_follow_the_last_is_refused():
    signals = touch_signals()
    state = read_switches(SwitchArray(), *signals).state
    with pytest.raises(InvalidQuantity, match="not after the sample before"):
        read_switches(SwitchArray(), *signals, state=state)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"strip": 1.2e-3}, "overlap"),
        ({"touch_threshold": 0.1, "release_threshold": 0.2}, "end as it begins"),
        ({"touch_threshold": -0.1}, "at least 0"),
        ({"count": 0}, "at least 1"),
        ({"formula": "other"}, "corrected"),
    ],
)
def test_impossible_arrays_are_refused(changes, words):
    with pytest.raises(CaseError, match=words):
        SwitchArray(**changes)


def test_two_switches_are_left_and_three_right():
    array = SwitchArray()
    np.testing.assert_allclose(array.heights, [1e-3, 2e-3, 3e-3, 4e-3, 5e-3], rtol=1e-15)
    assert array.sides == ("right", "left", "right", "left", "right")
