"""Load and displacement signals: exact sines, noise within its standard errors, and signals that cannot be used."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.identification.dma_signals import DmaSignals, complex_modulus, dma_from_estimates, read_dma_signals

MODULUS, AREA, HEIGHT = 30e3 + 12e3j, 1e-4, 5e-3


def oscillation(frequency=6.0, noise=0.0, seed=0, **changes):
    """Signals of a tissue of the modulus, with offset, drift and noise relative to the amplitudes."""
    time = np.linspace(0, 5 / frequency, 400)
    wave = np.exp(2j * np.pi * frequency * time)
    strain = 0.05 * np.exp(0.4j)
    generator = np.random.default_rng(seed)
    load, displacement = AREA * MODULUS * strain, HEIGHT * strain
    signals = {
        "time": time,
        "load": (load * wave).real + 0.3 + 0.02 * time + noise * abs(load) * generator.standard_normal(time.size),
        "displacement": (displacement * wave).real
        + 1e-3
        - 1e-5 * time
        + noise * abs(displacement) * generator.standard_normal(time.size),
        "frequency": frequency,
        "area": AREA,
        "height": HEIGHT,
    }
    return {**signals, **changes}


def test_exact_sines_give_the_modulus():
    modulus = complex_modulus(DmaSignals(**oscillation())).modulus
    tolerance = 1e-9  # relative; round-off of the offset and of the least squares
    assert abs(modulus / MODULUS - 1) < tolerance
    assert abs(modulus.conjugate() / MODULUS - 1) > tolerance, "the sign of the phase counts"


def test_a_frequency_that_is_a_little_off_is_refined():
    signals = DmaSignals(**oscillation(frequency=6.0, noise=0.0) | {"frequency": 6.05})
    assert abs(complex_modulus(signals).modulus / MODULUS - 1) > 1e-4
    computed = complex_modulus(signals, refine=True)
    assert computed.frequency == pytest.approx(6.0, rel=1e-7)
    assert abs(computed.modulus / MODULUS - 1) < 1e-7  # of a frequency found to the root of round-off


def test_a_wrong_frequency_is_not_refined():
    with pytest.raises((ConvergenceError, InvalidQuantity)):
        complex_modulus(DmaSignals(**oscillation() | {"frequency": 7.7}), refine=True)


@pytest.mark.parametrize("named", [5.3, 6.7])
def test_a_frequency_beyond_the_search_is_not_refined_to_its_border(named):
    signals = DmaSignals(**oscillation(frequency=6.0) | {"frequency": named})  # half a cycle over the record is 0.6 Hz
    with pytest.raises(ConvergenceError, match=r"within 0\.6 Hz"):
        complex_modulus(signals, refine=True)


@pytest.mark.parametrize("of", ["modulus", "compliance"])
def test_noise_stays_within_its_standard_errors(of):
    scores = []
    for seed in range(200):
        computed = complex_modulus(DmaSignals(**oscillation(noise=0.1, seed=seed)))
        if of == "modulus":
            difference = computed.modulus - MODULUS
            scores.append([difference.real / computed.modulus_errors[0], difference.imag / computed.modulus_errors[1]])
        else:
            ratio = [(1 / computed.modulus).real / (1 / MODULUS).real - 1, (1 / computed.modulus).imag / (1 / MODULUS).imag - 1]
            scores.append(np.array(ratio) / computed.compliance_errors)
    assert np.std(scores, axis=0) == pytest.approx([1, 1], abs=0.2)  # 200 trials: four standard errors of a standard deviation
    assert np.abs(np.mean(scores, axis=0)).max() < 0.3


def test_signals_become_data_in_order_of_frequency():
    data = dma_from_estimates([complex_modulus(DmaSignals(**oscillation(f, noise=0.01))) for f in (6.0, 1.0, 11.0)])
    np.testing.assert_array_equal(data.frequencies, [1, 6, 11])
    np.testing.assert_allclose(data.modulus, MODULUS, rtol=0.01)  # noise of 1 %, averaged over 400 samples
    assert (data.relative_noise < 0.01).all()
    exact = dma_from_estimates([complex_modulus(DmaSignals(**oscillation(f))) for f in (6.0, 1.0, 11.0)])
    assert (exact.relative_noise > 0).all()


def test_a_file_of_signals(tmp_path):
    path, given = tmp_path / "signals.csv", oscillation()
    rows = np.column_stack([given["displacement"] * 1e3, given["time"], given["load"]])
    np.savetxt(path, rows, delimiter=",", header="displacement [mm], time [s], load [N]", comments="", fmt="%.17g")
    signals = read_dma_signals(path, frequency=6.0, area=AREA, height=HEIGHT)
    assert abs(complex_modulus(signals).modulus / MODULUS - 1) < 1e-9
    path.write_text("time [s], load [N]\n0,1\n")
    with pytest.raises(InvalidQuantity, match="allowed: time, load, displacement"):
        read_dma_signals(path, frequency=6.0, area=AREA, height=HEIGHT)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: {"load": np.where(np.arange(400) == 7, np.nan, s["load"])}, "load in row 8 is nan N"),
        (lambda s: {"time": s["time"][::-1]}, "time in row 2"),
        (lambda s: {"load": s["load"][:-1]}, "one shape"),
        (lambda s: {name: s[name][:70] for name in ("time", "load", "displacement")}, "periods of 6 Hz; allowed: at least one"),
        (lambda s: {name: s[name][::25] for name in ("time", "load", "displacement")}, "samples per period"),
        (lambda s: {name: s[name][::40] for name in ("time", "load", "displacement")}, "10 samples; allowed: at least 12"),
        (lambda s: {"displacement": np.zeros(400)}, "displacement is 0 m throughout"),
        (lambda s: {"frequency": 0.0}, "frequency is 0"),
        (lambda s: {"area": -1.0}, "area is -1"),
        (lambda s: {"load": -s["load"]}, "both be positive in compression"),
    ],
)
def test_bad_signals_are_refused(change, words):
    given = oscillation()
    with pytest.raises(InvalidQuantity) as caught:
        complex_modulus(DmaSignals(**given | change(given)))
    assert words in str(caught.value)
