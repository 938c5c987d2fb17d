"""Calibration line: exact data give it back, the intervals hold what they promise, bad data are refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import curve_fit

from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.identification.calibration_line import fit_calibration_line
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.divider import divider_voltage

DIVIDER = {"supply": 5.0, "load": 1e3}
FORCE = np.linspace(0.5, 25, 26)
TRIALS = 200
BAND = (0.895, 0.99)


def voltages(force=FORCE):
    return divider_voltage(THESIS_LINE.conductance(force), **DIVIDER)


def covered(noise, seed=7):
    """Shares of the trials whose 95 % intervals hold the true m and n."""
    fit = fit_calibration_line(FORCE, voltages()[:, None] + noise(np.random.default_rng(seed)), **DIVIDER)
    ends = ((fit.slope_interval, THESIS_LINE.slope), (fit.intercept_interval, THESIS_LINE.intercept))
    return [float(((low < true) & (true < high)).mean()) for (low, high), true in ends]


def test_exact_data_give_the_line():
    fit = fit_calibration_line(FORCE, voltages(), **DIVIDER)
    assert fit.slope == pytest.approx(THESIS_LINE.slope, rel=1e-12)
    assert fit.intercept == pytest.approx(THESIS_LINE.intercept, rel=1e-9)
    assert fit.rms < 1e-12
    other = fit_calibration_line(FORCE, voltages(), **DIVIDER | {"load": 1.01e3})
    assert other.slope != pytest.approx(THESIS_LINE.slope, rel=1e-12), "the load resistor counts"
    assert np.ndim(fit.slope) == 0


@pytest.mark.parametrize("size", [1e-3, 10e-3])
def test_the_intervals_hold_the_truth_as_often_as_they_say(size):
    for share in covered(lambda generator: generator.normal(0, size, (FORCE.size, TRIALS))):
        assert BAND[0] <= share <= BAND[1]


def test_a_wrong_noise_model_is_noticed():
    """Noise that stays over all points of a trial, as drift would, is not the independent noise of the intervals."""

    def drifting(generator):
        steps = generator.normal(0, 2e-3, (FORCE.size, TRIALS))
        return np.cumsum(steps, axis=0)

    assert not all(BAND[0] <= share <= BAND[1] for share in covered(drifting))


def test_only_residuals_in_voltage_claim_the_scatter_that_the_intercept_has():
    """Least squares in conductance takes the noise at high forces for that at zero, where the intercept is."""
    voltage = voltages()[:, None] + np.random.default_rng(7).normal(0, 10e-3, (FORCE.size, TRIALS))
    fit = fit_calibration_line(FORCE, voltage, **DIVIDER)
    assert fit.covariance[1, 1].mean() == pytest.approx(fit.intercept.var(), rel=0.3)  # 200 trials: three standard errors
    plain = [np.polyfit(FORCE, column, 1, cov=True) for column in (voltage / ((5.0 - voltage) * 1e3)).T]
    claimed = np.mean([covariance[1, 1] for _, covariance in plain])
    assert claimed > 1.6 * np.var([coefficients[1] for coefficients, _ in plain])


def test_it_is_least_squares_in_voltage():
    voltage = voltages() + np.random.default_rng(2).normal(0, 5e-3, FORCE.size)
    fit = fit_calibration_line(FORCE, voltage, **DIVIDER)

    def model(force, slope, intercept):
        loaded = 1e3 * (1e-5 * slope * force + 1e-5 * intercept)
        return 5.0 * loaded / (1 + loaded)

    fitted, covariance = curve_fit(model, FORCE, voltage, p0=(5, 0), xtol=1e-14, ftol=1e-14)
    np.testing.assert_allclose([fit.slope, fit.intercept], 1e-5 * fitted, rtol=1e-6)
    np.testing.assert_allclose(fit.covariance, 1e-10 * covariance, rtol=1e-4)
    assert fit.noise == pytest.approx(5e-3, rel=0.5)
    half = fit.band(np.array([0.0, 10.0]))
    assert half[0] == pytest.approx(fit.intercept_interval[1] - fit.intercept)
    assert 0 < half[1] < half[0], "the line is surer among its points than at their end"


def test_linearity_is_the_largest_and_smallest_force_error_over_full_scale():
    read = FORCE.copy()
    read[3] += 0.03 * 25
    read[20] -= 0.05 * 25
    fit = fit_calibration_line(FORCE, voltages(read), **DIVIDER)
    error = (THESIS_LINE.conductance(read) - fit.intercept) / fit.slope - FORCE
    np.testing.assert_allclose(fit.force_error, error, atol=1e-12)
    assert fit.linearity_positive == pytest.approx(error.max() / 25) == error[3] / 25
    assert fit.linearity_negative == pytest.approx(error.min() / 25) == error[20] / 25
    assert fit.rms == pytest.approx(np.sqrt((error**2).mean()))
    half = fit_calibration_line(FORCE, voltages(read), **DIVIDER, full_scale=50.0)
    assert half.linearity_positive == pytest.approx(fit.linearity_positive / 2)


def test_every_sensor_has_its_own_line_and_saturated_points():
    gains = np.array([[0.9, 1.0, 1.1], [1.2, 1.3, 1.4]])
    conductance = THESIS_LINE.conductance(FORCE)[:, None, None] * gains
    voltage = divider_voltage(conductance, **DIVIDER)
    saturated = voltage > 3.0
    voltage[saturated] = 3.0
    fit = fit_calibration_line(FORCE, voltage, **DIVIDER, saturated=saturated)
    np.testing.assert_allclose(fit.slope, gains * THESIS_LINE.slope, rtol=1e-10)
    np.testing.assert_array_equal(fit.excluded, saturated.sum(axis=0))
    assert fit.excluded.max() > 2
    assert fit.linearity_positive.max() < 1e-10
    assert fit.full_scale[1, 2] < 25
    blind = fit_calibration_line(FORCE, voltage, **DIVIDER)
    assert abs(blind.slope[1, 2] / fit.slope[1, 2] - 1) > 1e-3
    assert blind.linearity_negative[1, 2] < -0.01


@pytest.mark.parametrize(
    ("force", "voltage", "more", "words"),
    [
        ([1.0, 2.0], [0.1, 0.2], {}, "2 points; allowed: at least 3"),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], {"saturated": [0, 0, 1]}, "2 points after 1 saturated were left out"),
        ([2.0, 2.0, 2.0], [0.1, 0.2, 0.3], {}, "all forces are equal"),
        ([1.0, np.nan, 3.0], [0.1, 0.2, 0.3], {}, "1 of 3 values of force are not finite"),
        ([1.0, 2.0, 3.0], [0.1, np.inf, 0.3], {}, "1 of 3 values of voltage are not finite"),
        ([-1.0, 2.0, 3.0], [0.1, 0.2, 0.3], {}, "a force is -1 N"),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 5.0], {}, "below the supply of 5 V"),
        ([1.0, 2.0, 3.0], [0.3, 0.2, 0.1], {}, "allowed: above 0, as it rises with the force"),
        ([1.0, 2.0, 3.0], [0.1, 0.2], {}, "forces of shape"),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], {"saturated": [0, 1]}, "saturated of shape"),
        ([1.0, "x", 3.0], [0.1, 0.2, 0.3], {}, "real numbers"),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], {"confidence": 1.0}, "confidence is 1"),
        ([1.0, 2.0, 3.0], [0.1, 0.2, 0.3], {"full_scale": 0.0}, "full_scale is 0 N"),
    ],
)
def test_bad_data_are_refused(force, voltage, more, words):
    with pytest.raises(InvalidQuantity, match=words):
        fit_calibration_line(force, voltage, **DIVIDER, **more)


def test_data_that_no_line_follows():
    with pytest.raises((ConvergenceError, InvalidQuantity)):
        fit_calibration_line([0.0, 1.0, 2.0, 3.0], [-4.0, -4.9, 4.99, 4.0], **DIVIDER)
