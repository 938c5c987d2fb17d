"""The error of the reported threshold against the lag of a first-order low pass on ramps, and the parts that make it up."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mutants import assert_kills
from scipy.optimize import brentq

from tactsim.experiments.threshold.contact_curve import Approach
from tactsim.experiments.threshold.sampling import SILENT, ApproachSampling
from tactsim.experiments.threshold.source import ClosedFormSource
from tactsim.experiments.threshold.threshold_trial import ThresholdTrial
from tactsim.interfaces.run import returned_by
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.sensors.threshold.threshold_trigger import ThresholdTrigger

PLATE_RATE, SMALL_RATE, TOUCH = 2.0, 0.5, 1.0
"""In N/s, N/s and s."""
# A load of 1 ohm makes the divider linear to 1e-4 of the signal; 32 bits leave no rounding.
LINEAR = SignalChain(load_resistor=1.0, converter=Converter(bits=32), low_pass=LowPass(cutoff=10.0), sampling_rate=1000.0)


LAG = PLATE_RATE / (2 * np.pi * 10.0)
"""In N: the large ramp in a time constant of the low pass."""
SAMPLED = "none: 1000 samples/s"


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
def test_filter_lag_on_ramps(level, capture, verification_record):
    """Mutants: a cut-off of 5 Hz, which a level far above the lag does not show, and the other capture."""
    computed = ramps(capture=capture).ideal_error(LowPass(cutoff=10.0), level)

    def check(cutoff, filtered):
        # one sample of the ideal chain, 62.5 us at 2 N/s, and 1e-3 of the lag of 32 mN for divider and bilinear transform
        assert computed == pytest.approx(lagged_error(level, cutoff, filtered=filtered), abs=PLATE_RATE / 16_000 + 3.2e-5)

    filtered = capture == "filtered"
    check(10.0, filtered)
    allowed = (PLATE_RATE / 16_000 + 3.2e-5) / LAG
    known = {"reference": "lag of a first-order low pass on ramps", "kind": "exact", "mesh": SAMPLED, "tolerance": allowed}
    expected = lagged_error(level, 10.0, filtered=filtered)
    verification_record(f"threshold, error of a {capture} capture over the lag of 32 mN", computed, expected, scale=LAG, **known)
    assert_kills(check, capture=(10.0, not filtered))
    if level < 0.1 or not filtered:
        assert_kills(check, cutoff=(5.0, filtered))


def test_without_filter_only_the_level_remains(verification_record):
    """Mutants: the level itself, and the rates swapped."""
    computed = ramps().ideal_error(None, 0.01)

    def check(factor):
        assert computed == pytest.approx(factor * 0.01, abs=PLATE_RATE / 16_000)

    check(PLATE_RATE / SMALL_RATE)
    known = {"reference": "level over the rate of the small force", "kind": "exact", "mesh": SAMPLED}
    expected, allowed = 0.01 * PLATE_RATE / SMALL_RATE, SMALL_RATE / 16_000 / 0.01
    verification_record("threshold, error of the level alone", computed, expected, tolerance=allowed, **known)
    assert_kills(check, level=(1.0,), swapped=(SMALL_RATE / PLATE_RATE,))


def test_lags_cancel_for_a_level_far_above_the_lag(verification_record):
    """Both readings lag by the same time: what remains is the level's own error, whatever the cut-off.

    Mutants: an unfiltered capture, and a low level, which triggers while the large sensor still lags.
    """

    def check(level, capture="filtered"):
        computed = ramps(capture=capture).ideal_error(LowPass(cutoff=10.0), level)
        assert computed == pytest.approx(PLATE_RATE * level / SMALL_RATE, abs=PLATE_RATE / 16_000 + 3.2e-5)

    check(0.1)
    found, expected = ramps(capture="filtered").ideal_error(LowPass(cutoff=10.0), 0.1), PLATE_RATE * 0.1 / SMALL_RATE
    known = {"reference": "error of the level alone", "kind": "exact", "mesh": "signals at 16 kHz", "scale": 1.0}
    verification_record(
        "threshold, error in N of a level far above the lag", found, expected, tolerance=PLATE_RATE / 16_000 + 3.2e-5, **known
    )
    assert_kills(check, unfiltered=(0.1, "unfiltered"), low_level=(1e-4,))
    assert ramps().ideal_error(LowPass(cutoff=10.0), 1e-4) < 0


def test_sampling_adds_half_an_interval(verification_record):
    sampling = ramps()
    trigger = ThresholdTrigger(np.array(0.0), np.array(0.01))
    (trials,) = sampling.trials(SILENT, [None], [trigger], trials=100, seed=(1,))
    interval = PLATE_RATE / 1000.0
    computed = trials.mean_error() - PLATE_RATE * 0.01 / SMALL_RATE

    def check(delay):
        assert computed == pytest.approx(delay * interval, abs=interval / 10), "ten phases, each a tenth of an interval"

    check(0.5)
    known = {"reference": "half an interval", "kind": "exact", "mesh": SAMPLED, "tolerance": 0.2}
    verification_record("threshold, delay by sampling", computed, 0.5 * interval, **known)
    assert_kills(check, instant=(0.0,), whole=(1.0,))


def test_threshold_of_the_closed_form_and_the_sum_of_the_parts(verification_record):
    source = ClosedFormSource(material=NeoHookean(c10=5e3), recess=0.1e-3)
    tissue = returned_by(source.tissue())
    approach = tissue.approach(2e-3)
    time = np.array([0.0, approach.touch, approach.duration])
    plate, small = approach.at(time)
    annulus = tissue._annulus

    def check_threshold(expected):
        assert approach.threshold_force == pytest.approx(expected, rel=1e-9)
        assert plate[1] == pytest.approx(expected, rel=1e-9)

    per_rise = annulus.length * 1e4 * 0.1e-3
    check_threshold(per_rise / annulus.rise_factor)  # 8 a kappa G L / rho
    exact: dict[str, Any] = {"reference": "exact annulus", "kind": "exact", "mesh": "integral equation", "tolerance": 1e-9}
    verification_record("threshold force", approach.threshold_force, per_rise / annulus.rise_factor, **exact)
    assert_kills(check_threshold, without_the_rise=(per_rise,))
    assert small[:2] == pytest.approx(0.0, abs=1e-15)
    excess = annulus.rise_factor * source.beyond

    def check_small(stiffness):
        assert small[2] == pytest.approx(stiffness * excess, rel=1e-6), "a solid punch has 8 G b"

    check_small(8 * 1e4 * 1.5e-3)
    assert_kills(check_small, compressible=(4 * 1e4 * 1.5e-3,), diameter=(8 * 1e4 * 3e-3,))
    trial = ThresholdTrial(source=source, speeds=(1e-3, 4e-3), noises=(1e-4, 5e-4), cutoffs=(10.0, 30.0), trials=20)
    quantities = trial.run().quantities
    parts = [quantities[f"{name}_error"].value for name in ("level", "film", "filter", "sampling", "noise")]
    total = np.array(quantities["force_error"].value, dtype=float)

    def check_sum(parts):
        np.testing.assert_allclose(np.sum(parts, axis=0), total, rtol=1e-9, err_msg="differences of the same numbers")

    check_sum(parts)
    identity = {"reference": "their sum", "kind": "invariance", "mesh": "none: 20 trials", "tolerance": 1e-9}
    verification_record("threshold, parts of the error", np.sum(parts, axis=0), total, **identity)
    assert_kills(check_sum, without_the_level=(parts[1:],), without_the_filter=(parts[:2] + parts[3:],))
