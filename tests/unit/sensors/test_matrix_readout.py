"""Forces of taxels through film and electronics, and back."""

import numpy as np
import pytest

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.sensors.electronics.calibration import LinearCalibration
from tactsim.sensors.electronics.film_calibration import film_line
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.films.film import Film
from tactsim.sensors.matrix_readout import MatrixReadout

AREA = 81e-6
TIMES = np.array([0.5, 1.0])
FORCES = np.random.default_rng(5).uniform(0.05, 0.5, (2, 2, 3, 3))
PLAIN = MatrixReadout(scatter=None, chain=SignalChain(sampling_rate=200.0, low_pass=None))


def test_voltages_are_those_of_film_and_divider():
    reading = PLAIN.read(TIMES, FORCES, AREA)
    applied = np.concatenate([np.zeros((1, 2, 3, 3)), FORCES])
    expected = [np.interp(reading.time, [0.0, 0.5, 1.0], applied[:, k, i, j]) for k, i, j in np.ndindex(2, 3, 3)]
    np.testing.assert_allclose(reading.applied.reshape(len(reading.time), -1).T, expected, atol=1e-15)
    voltage = PLAIN.chain.voltage(Film(active_area=AREA).conductance(reading.time, reading.applied))
    assert np.abs(reading.voltage - voltage).max() <= PLAIN.chain.converter.step / 2 * (1 + 1e-9)
    assert reading.voltage[0].max() == 0


def test_the_line_of_the_film_reads_a_calibration_force():
    line = PLAIN.line(AREA)
    film = Film(active_area=AREA)
    held = film.conductance([0.0, 1.0], [[0.5], [0.5]])[-1]
    assert line.force(held)[0] == pytest.approx(0.5, abs=0.25)
    assert film_line(film, (0.4, 0.6)).force(held)[0] == pytest.approx(0.5, abs=0.01)
    given = LinearCalibration(slope=1e-4)
    assert MatrixReadout(calibration=given).line(AREA) == given


def test_channels_differ_by_the_seed_of_their_scatter():
    same = [MatrixReadout(seed=seed).read(TIMES, np.full((2, 2, 3, 3), 0.3), AREA).voltage for seed in (1, 1)]
    np.testing.assert_array_equal(same[0], same[1])
    assert np.ptp(same[0][-1]) > 0
    assert np.ptp(PLAIN.read(TIMES, np.full((2, 2, 3, 3), 0.3), AREA).voltage[-1]) == 0


def test_noise_does_not_repeat_the_scatter_of_the_same_seed():
    readout = MatrixReadout(chain=SignalChain(sampling_rate=200.0, low_pass=None, noise={"white": 1e-3}))
    assert readout.scatter.seed == readout.seed
    shape = (1, 2, 30, 30)
    noise = readout.read(np.array([5.0]), np.zeros(shape), AREA).voltage[0]
    gains = readout.scatter.gains(shape[1:], readout.line(AREA))
    # 0.024 is one standard deviation for 1800 independent pairs
    assert abs(np.corrcoef(noise.ravel(), gains.ravel())[0, 1]) < 0.1


def test_a_pull_reads_as_no_force_and_is_reported():
    pulled = FORCES.copy()
    pulled[-1, 0, 0, 0] = -1e-3
    reading = PLAIN.read(TIMES, pulled, AREA)
    assert reading.strongest_pull == pytest.approx(1e-3)
    assert reading.voltage[-1, 0, 0, 0] == 0
    assert PLAIN.read(TIMES, FORCES, AREA).strongest_pull == 0


def test_noise_below_zero_is_read_and_what_reaches_the_supply_is_flagged():
    noisy = {"sampling_rate": 200.0, "converter": {"low": -50.0, "high": 50.0}, "low_pass": None}
    still = np.zeros((1, 2, 3, 3))
    quiet, loud = (
        MatrixReadout(scatter=None, chain=SignalChain(noise={"white": white}, **noisy)).read(np.array([5.0]), still, AREA)
        for white in (1e-2, 5.0)
    )
    line = PLAIN.line(AREA)
    assert quiet.force.mean() == pytest.approx(-line.intercept / line.slope, abs=0.05 * quiet.force.std())
    assert not quiet.saturated.any()
    np.testing.assert_array_equal(loud.saturated, loud.filtered >= 5.0)
    assert loud.saturated.any()


def test_bad_input_is_refused():
    with pytest.raises(InvalidQuantity, match="at least one sample"):
        PLAIN.read(np.array([]), np.zeros((0, 2, 3, 3)), AREA)
    with pytest.raises(InvalidQuantity, match="lower sampling_rate"):
        PLAIN.read(np.array([100.0]), np.zeros((1, 2, 32, 32)), AREA)
    with pytest.raises(CaseError, match="must increase"):
        MatrixReadout(calibration_forces=(2.0, 1.0))
    with pytest.raises(InvalidQuantity, match=r"calibration_forces up to 10000 N: .*allowed: 0 to 100 N"):
        MatrixReadout(calibration_forces=(0.0, 1e4)).line(AREA)
