"""The error of the reported threshold against the lag of a first-order low pass on ramps, and the parts that make it up."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from tactsim.experiments.threshold.contact_curve import Approach
from tactsim.experiments.threshold.sampling import SILENT, ApproachSampling
from tactsim.experiments.threshold.source import ClosedFormSource
from tactsim.experiments.threshold.threshold_trial import ThresholdTrial
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.sensors.converter import Converter
from tactsim.sensors.low_pass import LowPass
from tactsim.sensors.signal_chain import SignalChain
from tactsim.sensors.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold_trigger import ThresholdTrigger

PLATE_RATE, SMALL_RATE, TOUCH = 2.0, 0.5, 1.0
"""In N/s, N/s and s."""
# A load of 1 ohm makes the divider linear to 1e-4 of the signal; 32 bits leave no rounding.
LINEAR = SignalChain(load_resistor=1.0, converter=Converter(bits=32), low_pass=LowPass(cutoff=10.0), sampling_rate=1000.0)


def ramps(**changes):
    """A sampling of forces that grow at constant rates, the small one from the touch on."""

    def forces(times):
        return PLATE_RATE * times, SMALL_RATE * np.maximum(times - TOUCH, 0.0)

    approach = Approach(1e-3, 2.0, TOUCH, PLATE_RATE * TOUCH, forces)
    sensor = ThresholdSensor(**({"chain": LINEAR, "large_bears": "plate"} | changes))
    return ApproachSampling.settled(sensor, approach, 1.0, 0.5, [LINEAR.low_pass])


def lagged_error(level, cutoff, *, filtered=True):
    r"""Error in N of the captured force in continuous time.

    A ramp of rate s behind a low pass reads :math:`s (t - \tau (1 - e^{-t/\tau}))`; the small sensor triggers at the time t*
    after the touch at which that is the level, when the large one reads :math:`r (T + t^* - \tau)`, long after it began.
    """
    tau = 1 / (2 * np.pi * cutoff)

    def beyond(time):
        return SMALL_RATE * (time + tau * np.expm1(-time / tau)) - level

    return PLATE_RATE * (brentq(beyond, 0.0, 10.0) - (tau if filtered else 0.0))


@pytest.mark.parametrize("level", [1e-4, 1e-3, 1e-2, 0.1])
@pytest.mark.parametrize("capture", ["filtered", "unfiltered"])
def test_filter_lag_on_ramps(level, capture):
    found = ramps(capture=capture).ideal_error(LowPass(cutoff=10.0), level)
    expected = lagged_error(level, 10.0, filtered=capture == "filtered")
    # one sample of the ideal chain, 62.5 us at 2 N/s, and 1e-3 of the lag of 32 mN for divider and bilinear transform
    tolerance = PLATE_RATE / 16_000 + 3.2e-5
    assert found == pytest.approx(expected, abs=tolerance)
    twin = lagged_error(level, 5.0, filtered=capture == "filtered")
    if level < 0.1 or capture == "unfiltered":
        assert abs(found - twin) > 3 * tolerance, "a cut-off of 5 Hz must be told from 10 Hz"


def test_without_filter_only_the_level_remains():
    found = ramps().ideal_error(None, 0.01)
    expected = PLATE_RATE * 0.01 / SMALL_RATE
    assert found == pytest.approx(expected, abs=PLATE_RATE / 16_000)
    assert found != pytest.approx(1.05 * expected, abs=3 * PLATE_RATE / 16_000)


def test_lags_cancel_for_a_level_far_above_the_lag():
    """Both readings lag by the same time: what remains is the level's own error, whatever the cut-off."""
    assert lagged_error(0.1, 10.0) == pytest.approx(PLATE_RATE * 0.1 / SMALL_RATE, rel=1e-5)
    assert lagged_error(1e-4, 10.0) < 0, "a low level triggers while the large sensor still lags"


def test_sampling_adds_half_an_interval():
    sampling = ramps()
    trigger = ThresholdTrigger(np.array(0.0), np.array(0.01))
    (trials,) = sampling.trials(SILENT, [None], [trigger], trials=100, seed=(1,))
    interval = PLATE_RATE / 1000.0
    found = trials.mean_error() - PLATE_RATE * 0.01 / SMALL_RATE
    assert found == pytest.approx(interval / 2, abs=interval / 10), "ten phases, each a tenth of an interval"
    assert found != pytest.approx(interval, abs=3 * interval / 10)


def test_threshold_of_the_closed_form_and_the_sum_of_the_parts():
    source = ClosedFormSource(material=NeoHookean(c10=5e3), recess=0.1e-3)
    tissue = source.tissue()
    approach = tissue.approach(2e-3)
    time = np.array([0.0, approach.touch, approach.duration])
    plate, small = approach.at(time)
    annulus = tissue._annulus
    expected = annulus.length * 1e4 * 0.1e-3 / annulus.rise_factor  # 8 a kappa G L / rho
    assert approach.threshold_force == pytest.approx(expected, rel=1e-9)
    assert plate[1] == pytest.approx(expected, rel=1e-9)
    assert small[:2] == pytest.approx(0.0, abs=1e-15)
    excess = annulus.rise_factor * source.beyond
    assert small[2] == pytest.approx(8 * 1e4 * 1.5e-3 * excess, rel=1e-6), "a solid punch has 8 G b"
    assert small[2] != pytest.approx(1.00001 * 8 * 1e4 * 1.5e-3 * excess, rel=1e-6)
    trial = ThresholdTrial(source=source, speeds=(1e-3, 4e-3), noises=(1e-4, 5e-4), cutoffs=(10.0, 30.0), trials=20)
    quantities = trial.run().quantities
    parts = [quantities[f"{name}_error"].value for name in ("level", "film", "filter", "sampling", "noise")]
    total = np.array(quantities["force_error"].value, dtype=float)
    np.testing.assert_allclose(np.sum(parts, axis=0), total, rtol=1e-9, err_msg="differences of the same numbers")
