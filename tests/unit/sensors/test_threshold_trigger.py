"""The trigger: what it captures, block by block as at once, its false alarms, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold.threshold_trigger import UNTRIGGERED, ThresholdTrigger, TriggerLevel, reported_threshold

TIMES = np.arange(6) / 10
LARGE = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
SMALL = np.array([0.0, 0.1, 0.0, 0.3, 0.0, 0.4])
TRIGGER = ThresholdTrigger(np.array(0.0), np.array(0.2))


def test_the_first_sample_beyond_the_level_captures_the_large_sensor():
    threshold = reported_threshold(TRIGGER.captured(LARGE, SMALL), TIMES, area=2.0, touch=0.25)
    assert (threshold.index, threshold.time, threshold.force, threshold.pressure) == (3, 0.3, 3.0, 1.5)
    assert threshold.triggered
    assert threshold.valid
    assert not threshold.false
    early = reported_threshold(TRIGGER.captured(LARGE, SMALL), TIMES, area=2.0, touch=0.35)
    assert early.false
    assert not early.valid


def test_a_level_that_is_only_reached_does_not_trigger():
    state = ThresholdTrigger(np.array(0.0), np.array(0.4)).captured(LARGE, SMALL)
    assert state.index == UNTRIGGERED
    threshold = reported_threshold(state, TIMES, area=1.0, touch=0.0)
    assert not threshold.triggered
    assert not threshold.valid
    assert threshold.force == 0


def test_saturation_counts_up_to_the_capture_and_not_after():
    flags = np.zeros(6, bool)
    flags[4] = True
    assert not TRIGGER.captured(LARGE, SMALL, flags).saturated
    flags[2] = True
    assert TRIGGER.captured(LARGE, SMALL, flags).saturated


@pytest.mark.parametrize("lengths", [[1] * 300, [7, 100, 1, 192], [300]])
def test_blocks_come_exactly_to_the_whole_with_noise_and_filter(lengths):
    chain = SignalChain(low_pass=LowPass(cutoff=10.0), noise=Noise(white=2e-3, line=1e-3))
    conductance = 1e-4 * np.linspace(0.1, 1.0, 300)[:, None, None] * np.array([[[1.0], [0.2]]]) * np.ones((1, 1, 4))
    sensor = ThresholdSensor(chain=chain)

    def forces(voltage):
        return sensor.large.calibration.force(chain.conductance(voltage))

    trigger = ThresholdTrigger(np.zeros(4), np.array([0.01, 0.1, 0.2, 9.0]))
    whole = chain.acquire(conductance, np.random.default_rng(3))
    expected = trigger.captured(forces(whole.filtered)[:, 0], forces(whole.filtered)[:, 1], whole.saturated.any(axis=1))
    stream, state, begin = chain.stream(np.random.default_rng(3)), trigger.start((4,)), 0
    for length in lengths:
        part, stream = stream.take(conductance[begin : begin + length])
        begin += length
        state = trigger.advanced(state, *np.moveaxis(forces(part.filtered), 1, 0), part.saturated.any(axis=1))
    for name in ("seen", "index", "force", "saturated"):
        np.testing.assert_array_equal(getattr(state, name), getattr(expected, name))
    assert state.triggered.tolist() == [True, True, True, False]


def false_alarms(multiple, level_of):
    """Part of 4000 channels of 200 samples of white noise that trigger, and the part that a multiple predicts."""
    noise = np.random.default_rng(11).standard_normal((200, 4000))
    state = ThresholdTrigger(np.array(0.0), np.array(level_of)).captured(np.zeros_like(noise), noise)
    return float(state.triggered.mean()), 1 - (1 - norm.sf(multiple)) ** 200


def test_false_triggers_come_at_the_rate_that_the_multiple_predicts():
    rate, predicted = false_alarms(3.0, 3.0)
    tolerance = 4 * np.sqrt(predicted * (1 - predicted) / 4000)  # four standard deviations of a binomial count
    assert abs(rate - predicted) < tolerance
    twin, _ = false_alarms(3.0, 3.4)
    assert abs(twin - predicted) > 3 * tolerance
    assert false_alarms(8.0, 8.0)[0] == 0


def test_level_from_the_noise_at_rest_and_its_least_value():
    rest = np.random.default_rng(1).normal(0.5, 0.01, 20_000)
    value, level = TriggerLevel(multiple=5).above_rest(rest, 1e-6)
    assert value == pytest.approx(0.5, abs=4 * 0.01 / np.sqrt(20_000))
    assert level == pytest.approx(0.05, rel=0.03), "standard deviation of 20 000 samples"
    assert TriggerLevel().above_rest(np.zeros(10), 1e-3)[1] == 1e-3
    assert TriggerLevel(force=0.1).above_rest(rest, 1e-3)[1] == 0.1


@pytest.mark.parametrize("level", [0.0, -1.0, np.nan])
def test_bad_levels_are_refused(level):
    with pytest.raises(InvalidQuantity, match="level above 0"):
        ThresholdTrigger(np.array(0.0), np.array(level))


def test_bad_readings_and_times_are_refused():
    with pytest.raises(InvalidQuantity, match="shapes"):
        TRIGGER.captured(LARGE[:-1], SMALL)
    with pytest.raises(InvalidQuantity, match="NaN"):
        TRIGGER.captured(LARGE, np.where(SMALL > 0, np.nan, 0.0))
    state = TRIGGER.captured(LARGE, SMALL)
    with pytest.raises(InvalidQuantity, match="one for each"):
        reported_threshold(state, TIMES[:-1], area=1.0, touch=0.0)
    with pytest.raises(InvalidQuantity, match="increase"):
        reported_threshold(state, TIMES[::-1], area=1.0, touch=0.0)
    with pytest.raises(InvalidQuantity, match="area"):
        reported_threshold(state, TIMES, area=0.0, touch=0.0)
    with pytest.raises(InvalidQuantity, match="empty"):
        TriggerLevel().above_rest(np.zeros(0), 1e-3)
    with pytest.raises(InvalidQuantity, match="step"):
        TriggerLevel().above_rest(np.zeros(3), 0.0)
    for bad in ({"multiple": 0}, {"multiple": -1}, {"force": 0.0}):
        with pytest.raises(CaseError):
            TriggerLevel(**bad)
