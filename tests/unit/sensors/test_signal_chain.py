"""Signal chain: the divider inverts, the converter rounds and flags, chunks give the record, the noise is as declared."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from tactsim.errors import InvalidQuantity
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.converter import Converter
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.electronics.signal_chain import Buffer, SignalChain

CHANNELS = (2, 3, 3)
NOISY = Noise(white=3e-3, line=20e-3)


def conductances(samples=400, channels=CHANNELS, seed=1):
    """Random forces through the line of the thesis."""
    return THESIS_LINE.conductance(np.random.default_rng(seed).uniform(0, 20, (samples, *channels)))


def chunks(length, generator):
    """Ends of random chunks of 1 to 60 samples."""
    ends = np.cumsum(generator.integers(1, 60, length))
    return [int(end) for end in np.append(ends[ends < length], length)]


def test_divider_and_its_inverse():
    chain = SignalChain()
    assert chain.voltage(np.array([0.0, 1e-3, 3e-3])) == pytest.approx([0.0, 2.5, 3.75], abs=1e-15)
    conductance = np.geomspace(1e-9, 0.1, 50).reshape(5, 10)
    np.testing.assert_allclose(chain.conductance(chain.voltage(conductance)), conductance, rtol=1e-12)  # 1/(1 - V/V+) to 100
    other = SignalChain(load_resistor=1.001e3)
    assert not np.allclose(other.conductance(chain.voltage(conductance)), conductance, rtol=3e-12, atol=0)


def test_the_chain_inverts_to_the_force_within_one_step():
    chain = SignalChain()
    conductance = conductances()
    filtered = chain.acquire(conductance).filtered
    assert chain.low_pass is not None
    voltage, _ = chain.low_pass.unfiltered(filtered, chain.sampling_rate)
    error = np.abs(chain.conductance(voltage) - conductance)
    assert (error <= 0.501 * chain.conductance_step(conductance)).all()  # half a step, and the curvature within it
    assert (error > 0.3 * chain.conductance_step(conductance)).any(), "a finer converter would pass too"
    force = THESIS_LINE.force(chain.conductance(voltage))
    np.testing.assert_allclose(force, THESIS_LINE.force(conductance), atol=0.01)


@pytest.mark.parametrize("bits", [1, 8, 16, 24])
def test_levels_are_at_most_half_a_step_away(bits):
    converter = Converter(low=-1.0, high=4.0, bits=bits)
    voltage = np.random.default_rng(bits).uniform(-1.0, 4.0 - converter.step / 2, 1000)
    levels, saturated = converter.convert(voltage)
    assert np.abs(levels - voltage).max() <= converter.step / 2 * (1 + 1e-6)  # round-off of 2^24 levels
    assert np.abs(levels - voltage).max() > converter.step / 2 * 0.95
    assert not saturated.any()
    assert len(np.unique(levels)) <= 2**bits


def test_what_lies_outside_is_flagged():
    converter = Converter(low=0.0, high=5.0, bits=4)
    voltage = np.array([-0.16, -0.15, 0.0, 4.8, 4.84, 4.85, 7.0])
    levels, saturated = converter.convert(voltage)
    assert saturated.tolist() == [True, False, False, False, False, True, True]
    assert levels == pytest.approx([0, 0, 0, 4.6875, 4.6875, 4.6875, 4.6875])
    assert converter.at_end(levels).tolist() == [True, True, True, True, True, True, True]
    recording = SignalChain(converter=Converter(high=1.0)).acquire(conductances())
    np.testing.assert_array_equal(recording.saturated, SignalChain().voltage(conductances()) > 1.0 - 1.5 * 2.0**-16)
    assert recording.saturated.any()
    assert not SignalChain().acquire(conductances()).saturated.any()
    with pytest.raises(InvalidQuantity, match="1 of 2 voltages are not finite"):
        converter.convert(np.array([np.nan, 0.0]))


@pytest.mark.parametrize("order", [1, 2, 5])
@pytest.mark.parametrize("seed", range(5))
def test_chunks_give_the_record(order, seed):
    chain = SignalChain(noise=NOISY, low_pass=LowPass(cutoff=40.0, order=order))
    conductance = conductances(seed=seed)
    whole = chain.acquire(conductance, np.random.default_rng(seed))
    stream, begin, parts = chain.stream(np.random.default_rng(seed)), 0, []
    for end in chunks(len(conductance), np.random.default_rng(seed + 100)):
        part, stream = stream.take(conductance[begin:end])
        parts.append(part)
        begin = end
    assert len(parts) > 5
    for name in ("time", "voltage", "filtered", "saturated"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_allclose(joined, getattr(whole, name), rtol=0, atol=1e-12, err_msg=name)
    begun_anew = np.concatenate([chain.low_pass.filtered(part.voltage, 1000.0)[0] for part in parts])
    assert np.abs(begun_anew - whole.filtered).max() > 1e-3, "forgetting the state is noticed"


def test_a_stream_does_not_change_and_keeps_its_channels():
    stream = SignalChain().stream()
    first, after = stream.take(conductances(20))
    again, _ = stream.take(conductances(20))
    np.testing.assert_array_equal(first.filtered, again.filtered)
    assert (stream.samples, after.samples) == (0, 20)
    with pytest.raises(InvalidQuantity, match=r"channels of shape \(2,\) after \(2, 3, 3\)"):
        after.take(np.zeros((5, 2)))
    with pytest.raises(InvalidQuantity, match="at least one sample"):
        stream.take(np.zeros((0, 2)))
    with pytest.raises(InvalidQuantity, match="at least one sample"):
        stream.take(np.array(1e-3))


@pytest.mark.parametrize(("cutoff", "allowed"), [(10.0, 1e-12), (40.0, 1e-12), (400.0, 1e-12), (0.01, 1e-8)])
def test_the_inverse_of_the_low_pass_is_exact(cutoff, allowed):
    """Round-off times the gain of the inverse, 30 at 10 Hz and 30 000 at 0.01 Hz."""
    low_pass = LowPass(cutoff=cutoff)
    samples = 2 + np.cumsum(np.random.default_rng(3).normal(size=(5000, 3)), axis=0)
    filtered, state = low_pass.filtered(samples[:2000], 1000.0)
    rest, _ = low_pass.filtered(samples[2000:], 1000.0, state)
    first, state = low_pass.unfiltered(filtered, 1000.0)
    second, _ = low_pass.unfiltered(rest, 1000.0, state)
    scale = np.abs(samples).max()
    assert np.abs(np.concatenate([first, second]) - samples).max() < allowed * scale
    wrong, _ = LowPass(cutoff=cutoff * (1 + 1e-6)).unfiltered(filtered, 1000.0)
    assert np.abs(wrong - samples[:2000]).max() > 3 * allowed * scale
    with pytest.raises(InvalidQuantity, match="order 2 cannot be inverted"):
        LowPass(order=2).unfiltered(samples, 1000.0)


@pytest.mark.parametrize(
    ("cutoff", "order", "analog"), [(10.0, 1, 0.1644), (40.0, 1, 0.5547), (40.0, 4, 0.1938), (40.0, 5, 0.1306)]
)
def test_what_the_low_pass_leaves_of_60_hertz(cutoff, order, analog):
    low_pass, rate = LowPass(cutoff=cutoff, order=order), 1000.0
    assert low_pass.gain(60.0) == pytest.approx(analog, abs=5e-5)
    time = np.arange(4000) / rate
    filtered, _ = low_pass.filtered(np.sin(2 * np.pi * 60 * time), rate)
    tail = slice(2000, 4000)  # 120 periods, the transient gone
    amplitude = 2 * np.abs(np.mean(filtered[tail] * np.exp(2j * np.pi * 60 * time[tail])))
    warped = (np.tan(np.pi * 60 / rate) / np.tan(np.pi * cutoff / rate)) ** (2 * order)
    assert amplitude == pytest.approx(1 / np.sqrt(1 + warped), rel=1e-9)
    assert low_pass.gain(60.0, rate) == pytest.approx(amplitude, rel=1e-9)
    np.testing.assert_allclose(low_pass.gain(np.array([0.0, cutoff]), rate), [1, 1 / np.sqrt(2)], rtol=1e-9)


def test_a_constant_is_settled_from_its_first_sample():
    recording = SignalChain().acquire(np.full((50, 2), 1e-3))
    np.testing.assert_allclose(recording.filtered, recording.voltage, rtol=1e-13)


def test_without_a_low_pass_the_converted_samples_are_the_filtered_ones():
    recording = SignalChain(low_pass=None).acquire(conductances())
    np.testing.assert_array_equal(recording.filtered, recording.voltage)
    assert (SignalChain().acquire(conductances()).filtered != recording.voltage).any()


def test_noise_has_its_size_frequency_and_seed():
    noise, time = Noise(white=2e-3, line=50e-3), np.arange(10_000) / 1000
    generator = np.random.default_rng(5)
    phases = noise.phases((4,), generator)
    sample = noise.sample(time, phases, generator)
    line = noise.line * np.sin(2 * np.pi * 60 * time[:, None] + phases)
    white = sample - line
    assert white.std() == pytest.approx(2e-3, rel=0.02)  # 40 000 samples: 5.6 standard errors
    assert abs(white.mean()) < 5 * 2e-3 / 200
    assert np.abs(np.corrcoef(white.T) - np.eye(4)).max() < 0.05
    spectrum = np.abs(np.fft.rfft(sample[:, 0])) / 5000
    peak = int(spectrum.argmax())
    assert np.fft.rfftfreq(10_000, 1e-3)[peak] == pytest.approx(60.0, abs=1e-9)
    assert spectrum[peak] == pytest.approx(50e-3, rel=0.01)
    assert len(np.unique(phases)) == 4
    again = np.random.default_rng(5)
    np.testing.assert_array_equal(noise.sample(time, noise.phases((4,), again), again), sample)
    other = np.random.default_rng(6)
    assert not np.allclose(noise.sample(time, noise.phases((4,), other), other), sample)


def test_noise_and_buffer_reach_the_samples():
    conductance = np.full((2000, 2), 1e-3)
    still = SignalChain(low_pass=None)
    noisy = still.model_copy(update={"noise": Noise(white=5e-3)})
    assert noisy.acquire(conductance, np.random.default_rng(1)).voltage.std() == pytest.approx(5e-3, rel=0.06)
    for generator in (None, 1):
        with pytest.raises(InvalidQuantity, match="needs a random generator"):
            noisy.acquire(conductance, generator)
    amplified = still.model_copy(update={"buffer": Buffer(gain_error=0.01, offset=2e-3)})
    assert amplified.acquire(conductance).voltage[0, 0] == pytest.approx(2.5 * 1.01 + 2e-3, abs=still.converter.step / 2)


def test_sampling_times_and_histories():
    chain = SignalChain(sampling_rate=200.0)
    times = chain.times(0.3)
    assert times.size == 61
    assert times[-1] == pytest.approx(0.3)
    assert chain.times(0.0).tolist() == [0.0]
    own, values = chain.sampled(np.array([1.0, 1.01, 1.1]), np.array([[0.0, 1.0], [1.0, 1.0], [10.0, 1.0]]))
    assert own[:3] == pytest.approx([1.0, 1.005, 1.01])
    assert values[:4, 0] == pytest.approx([0.0, 0.5, 1.0, 1.5])
    assert values[-1] == pytest.approx([10.0, 1.0])
    assert (values[:, 1] == 1).all()
    alone, value = chain.sampled(np.array([2.0]), np.array([3.0]))
    assert (alone.tolist(), value.tolist()) == ([2.0], [3.0])


@pytest.mark.parametrize(
    ("times", "words"),
    [
        ([0.0, 0.2, 0.1], "time 3 is 0.1 s after 0.2 s; times must increase"),
        ([0.0, 0.1, 0.1], "times must increase"),
        ([0.0, np.nan, 1.0], "finite"),
        ([0.0, 1.0], "with values of shape"),
    ],
)
def test_bad_times_are_refused(times, words):
    with pytest.raises(InvalidQuantity, match=words):
        SignalChain().sampled(np.array(times), np.zeros(3))


@pytest.mark.parametrize("duration", [-1.0, np.nan, np.inf, 1e9])
def test_bad_durations_are_refused(duration):
    with pytest.raises(InvalidQuantity, match="duration"):
        SignalChain().times(duration)


@pytest.mark.parametrize("bad", [np.nan, -1e-6, np.inf, 1e300])
def test_bad_conductances_are_refused(bad):
    with pytest.raises(InvalidQuantity, match="1 of 3 conductances"):
        SignalChain().acquire(np.array([1e-3, bad, 1e-3]))


@pytest.mark.parametrize("bad", [5.0, 6.0, np.nan, np.inf, -np.inf])
def test_voltages_that_no_sensor_gives_are_refused(bad):
    with pytest.raises(InvalidQuantity, match="below the supply of 5 V"):
        SignalChain().conductance(np.array([1.0, bad]))
    assert SignalChain().conductance(np.array([-0.01])) < 0, "noise about zero keeps its mean"


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_bad_samples_are_not_filtered(bad):
    with pytest.raises(InvalidQuantity, match="1 of 2 samples"):
        LowPass().filtered(np.array([0.0, bad]), 1000.0)
    with pytest.raises(InvalidQuantity, match="no samples"):
        LowPass().filtered(np.array([]), 1000.0)
    with pytest.raises(InvalidQuantity, match="for 1 channels"):
        LowPass().filtered(np.zeros(3), 1000.0, LowPass().filtered(np.zeros((3, 2)), 1000.0)[1])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"supply": 0.0}, "greater than 0"),
        ({"supply": -5.0}, "greater than 0"),
        ({"load_resistor": 0.0}, "greater than 0"),
        ({"load_resistor": -1.0}, "greater than 0"),
        ({"sampling_rate": 0.0}, "greater than 0"),
        ({"sampling_rate": 80.0}, "must be below half the sampling_rate"),
        ({"low_pass": {"cutoff": 500.0}}, "must be below half the sampling_rate"),
        ({"low_pass": {"cutoff": 0.0}}, "greater than 0"),
        ({"low_pass": {"cutoff": 1e-3}}, "must be at least 1e-05 of the sampling_rate"),
        ({"low_pass": {"order": 0}}, "greater than or equal to 1"),
        ({"converter": {"bits": 0}}, "greater than or equal to 1"),
        ({"converter": {"bits": 33}}, "less than or equal to 32"),
        ({"converter": {"low": 5.0}}, "must be below high"),
        ({"converter": {"high": 1e-300}}, "range from low to high"),
        ({"load_resistor": 1e30}, "less than or equal to"),
        ({"noise": {"white": -1e-3}}, "greater than or equal to 0"),
        ({"noise": {"white": float("nan")}}, "finite"),
        ({"supply": float("nan")}, "greater than 0|finite"),
    ],
)
def test_bad_settings_are_refused(changes, words):
    with pytest.raises(ValidationError, match=words):
        SignalChain.model_validate(changes)


def test_units_are_read():
    chain = SignalChain.model_validate({"supply": "500 mV", "load_resistor": "10 kohm", "low_pass": {"cutoff": "10 Hz"}})
    assert (chain.supply, chain.load_resistor) == (0.5, 1e4)
