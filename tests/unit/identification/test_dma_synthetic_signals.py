"""Signals of a Kelvin model: exact moduli in the steady state, transients, coverage of the error bars, one file of all tests."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from mutants import assert_kills

from tactsim.analytic.atrial import table_4_1
from tactsim.errors import InvalidQuantity
from tactsim.identification.dma_data import THESIS_FREQUENCIES
from tactsim.identification.dma_signals import complex_modulus, read_dma_tests
from tactsim.identification.dma_synthetic_signals import DmaMachine, synthetic_signals
from tactsim.validation.quantities import dma as quantities

MODEL = table_4_1()
MACHINE = {"area": 100e-6, "height": 5e-3, "mean_load": 5e-3, "amplitude": 2.5e-3}


def true_moduli(frequencies=THESIS_FREQUENCIES, model=MODEL):
    return 1 / model.complex_compliance(2 * np.pi * np.array(frequencies))


def signals(frequencies=THESIS_FREQUENCIES, seed=1, **changes):
    return synthetic_signals(MODEL, frequencies, DmaMachine(**MACHINE | changes), seed=seed)


@pytest.mark.parametrize("cycles", [1.0, 7.3, 20.0])
def test_the_steady_state_gives_the_moduli_to_round_off(cycles):
    """Also of a record that does not end with a cycle: nothing leaks."""
    moduli = np.array([complex_modulus(one).modulus for one in signals(cycles=cycles)])

    def check(true):
        np.testing.assert_allclose(moduli, true, rtol=1e-11)  # round-off of the mean, 600 times the swing at 36 Hz

    check(true_moduli())
    assert_kills(
        check,
        conjugate=(true_moduli().conjugate(),),
        viscosities=(true_moduli(model=table_4_1("viscosities")),),
        angular=(true_moduli(np.array(THESIS_FREQUENCIES) / (2 * np.pi)),),
    )


def test_a_spectrum_by_fourier_would_leak():
    """The reason for least squares: the bin next to the frequency of 7.3 cycles is off by tens of percent."""
    (one,) = signals((6.0,), cycles=7.3)
    spectra = [scipy.fft.rfft(values - values.mean()) for values in (one.load, one.displacement)]
    fourier = spectra[0][7] / spectra[1][7] * one.height / one.area
    assert abs(fourier / true_moduli((6.0,))[0] - 1) > 0.01
    assert abs(complex_modulus(one).modulus / true_moduli((6.0,))[0] - 1) < 1e-11


def test_what_a_specimen_still_creeps_fades_and_is_noticed():
    def error(hold, precycles=0.0):
        (one,) = signals((1.0,), cycles=20.0, hold=hold, precycles=precycles)
        estimate = complex_modulus(one)
        return abs(estimate.modulus / true_moduli((1.0,))[0] - 1), estimate.has_white_residuals

    errors = [error(*settling)[0] for settling in ((5.0, 0.0), (10.0, 5.0), (20.0, 20.0), (40.0, 60.0))]
    assert (np.diff(errors) < 0).all()
    assert errors[0] > 1e-3
    # the slowest unit has 2.46 s: after another 40 s its share is smaller by exp(-16)
    assert errors[3] < 1e-8
    assert not error(5.0)[1], "correlated residuals"
    assert error(None)[1]


def test_standard_errors_cover_the_true_moduli():
    """The squared deviations over their variances follow chi-square: 2 numbers, 8 frequencies, 60 seeds."""
    frequencies = THESIS_FREQUENCIES

    def scores(stated):
        total, inside = 0.0, []
        for seed in range(60):
            for one, true in zip(signals(seed=seed, load_noise=0.05, displacement_noise=0.02), true_moduli(), strict=True):
                estimate = complex_modulus(one)
                errors = stated * np.array(estimate.modulus_errors)
                deviations = np.array([(estimate.modulus - true).real, (estimate.modulus - true).imag]) / errors
                total += float(deviations @ deviations)
                inside += list(np.abs(deviations) < 1.96)
        return total, float(np.mean(inside))

    count = 2 * len(frequencies) * 60

    def check(stated):
        total, inside = scores(stated)
        low, high = scipy.stats.chi2.ppf([1e-4, 1 - 1e-4], count)
        assert low < total < high
        assert inside == pytest.approx(0.95, abs=0.03)  # four standard deviations of 960 numbers

    check(1.0)
    assert_kills(check, too_small=(0.8,), too_large=(1.25,))


def test_white_noise_is_not_taken_for_a_transient():
    estimates = [
        complex_modulus(one) for seed in range(20) for one in signals(seed=seed, load_noise=0.02, displacement_noise=0.02)
    ]
    assert all(estimate.has_white_residuals for estimate in estimates)


def test_one_file_of_all_tests(tmp_path):
    tests = signals((1.0, 6.0, 36.0), load_noise=0.01, displacement_noise=0.01)
    path = tmp_path / "tests.csv"
    rows = [np.column_stack([np.full(t.time.size, t.frequency), t.time, t.load, 1e3 * t.displacement]) for t in reversed(tests)]
    header = "frequency [Hz], time [s], load [N], displacement [mm]"
    np.savetxt(path, np.vstack(rows), delimiter=",", header=header, comments="", fmt="%.17g")
    read = read_dma_tests(path, area=MACHINE["area"], height=MACHINE["height"])
    assert [one.frequency for one in read] == [1.0, 6.0, 36.0]
    for one, other in zip(read, tests, strict=True):
        assert complex_modulus(one).modulus == pytest.approx(complex_modulus(other).modulus, rel=1e-12)
    path.write_text(f"{header}\n" + "\n".join(f"1, {t / 100}, {np.sin(t)}, 1" for t in range(200)))
    with pytest.raises(InvalidQuantity, match=r"test at 1 Hz: displacement is 0\.001 m throughout"):
        read_dma_tests(path, area=1e-4, height=1e-3)
    path.write_text(f"{header}\n" + "\n".join(f"{1 + 1e-6 * t}, {t / 100}, {np.sin(t)}, {np.cos(t)}" for t in range(20)))
    with pytest.raises(
        InvalidQuantity, match=r"tests\.csv: the frequency 1 Hz stands in 1 rows.*write the frequency that was set"
    ):
        read_dma_tests(path, area=1e-4, height=1e-3)
    path.write_text("time [s], load [N], displacement [mm]\n0, 1, 1\n")
    with pytest.raises(InvalidQuantity, match="no column frequency"):
        read_dma_tests(path, area=1e-4, height=1e-3)


@pytest.mark.parametrize(
    ("changes", "words"), [({"mean_load": 1e-3}, "let go"), ({"load_noise": -0.1}, "load_noise"), ({"area": 0.0}, "area")]
)
def test_impossible_machines_are_refused(changes, words):
    with pytest.raises(InvalidQuantity, match=words):
        DmaMachine(**MACHINE | changes)


def test_numbers_for_the_tables():
    assert quantities.dma_signal_error("difference", 6.0, cycles=7.3) < 1e-11
    noisy = {"noise": 0.02, "seed": 3}
    assert quantities.dma_signal_error("difference", 6.0, **noisy) > 1e-4
    assert quantities.dma_signal_error("standard_error", 6.0, **noisy) == pytest.approx(0.02 * np.sqrt(8 / 1001), rel=0.1)
    assert quantities.dma_signal_error("difference_over_error", 6.0, **noisy) < 3
    assert quantities.dma_signal_error("difference", 1.0, hold=5.0) > 1e-3
    assert quantities.dma_signal_lag(1.0) == pytest.approx(np.angle(true_moduli((1.0,))[0]), rel=1e-11)
    load, displacement = quantities.dma_successive_tests("Tests", (6.0, 11.0))["panels"]
    (first, second), _ = load["curves"], displacement["curves"]
    assert first["x"][-1] < second["x"][0], "one after the other"
    force, way = (np.array(curve["y"]) for curve in quantities.dma_phase("Signals", 6.0, noise=0.0)["panels"][0]["curves"])
    assert np.mean(force * way) * 2 == pytest.approx(np.cos(np.angle(true_moduli((6.0,))[0])), abs=0.01)  # whole cycles, sampled
