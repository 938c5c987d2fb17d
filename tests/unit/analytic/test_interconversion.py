"""Interconversion of random models, near-equal times and extreme weights among them, against the identities that bind J and G."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.interconversion import kelvin_of, maxwell_of
from tactsim.errors import InvalidQuantity

MODELS = pytest.mark.parametrize(
    "models", [range(50), pytest.param(range(50, 200), marks=pytest.mark.slow)], ids=["some", "more"]
)
"""Random models, by their seeds."""
CURVES = np.logspace(-7, 7, 141)
"""Times in s and angular frequencies in rad/s."""
ROUND_OFF = 1e-12
"""Some hundred roundings of sums and products over at most 13 terms; exp(-t / tau) at t = 30 tau multiplies one by 30."""


def random_kelvin(seed: int) -> GeneralizedKelvin:
    """1 to 12 units, compliances over 6 decades, times over 10; half of the models have times 1e-12 apart, a third flow."""
    generator = np.random.default_rng(seed)
    count = int(generator.integers(1, 13))
    compliances = 10 ** generator.uniform(-6, 0, count)
    times = 10 ** generator.uniform(-5, 5, count)
    if seed % 2:
        near = count // 2
        times[:near] = times[generator.integers(near, count, near)] * (1 + 1e-12 * generator.uniform(-1, 1, near))
    fluidity = 10 ** generator.uniform(-8, 2) if seed % 3 == 0 else 0.0
    return GeneralizedKelvin(10 ** generator.uniform(-6, 0), compliances, times, fluidity=fluidity)


def identity(kelvin: GeneralizedKelvin, maxwell: GeneralizedMaxwell, t: np.ndarray) -> np.ndarray:
    """J(0) G(t) + integral of G(t - s) J'(s) over 0 < s < t, in closed form by pairs of a unit of each model."""
    weights = np.append(kelvin.compliances / kelvin.times, kelvin.fluidity)
    creeping = np.append(kelvin.times, np.inf)
    moduli = np.append(maxwell.moduli, maxwell.equilibrium_modulus)
    relaxing = np.append(maxwell.times, np.inf)
    total = kelvin.glassy_compliance * maxwell.relaxation(t)
    for weight, tau in zip(weights, creeping, strict=True):
        for modulus, time in zip(moduli, relaxing, strict=True):
            slower, faster = max(tau, time), min(tau, time)
            gap = 0.0 if slower == faster else 1 / faster if slower == np.inf else (slower - faster) / faster / slower
            mean = t if gap == 0 else -np.expm1(-gap * t) / gap
            total = total + weight * modulus * np.exp(-t / slower) * mean
    return total


def transforms(kelvin: GeneralizedKelvin, maxwell: GeneralizedMaxwell, s: np.ndarray) -> np.ndarray:
    """s^2 times the product of the Laplace transforms of J and G."""
    compliance = kelvin.glassy_compliance + (1 / (1 + s[:, None] * kelvin.times)) @ kelvin.compliances + kelvin.fluidity / s
    phase = s[:, None] * maxwell.times
    return compliance * (maxwell.equilibrium_modulus + (phase / (1 + phase)) @ maxwell.moduli)


def assert_equal(computed: np.ndarray | float, expected: np.ndarray | float, seed: int) -> None:
    """Refuse what differs by more than round-off, naming the model."""
    np.testing.assert_allclose(computed, expected, rtol=ROUND_OFF, err_msg=f"model of the seed {seed}")


@MODELS
def test_a_round_trip_keeps_all_curves(models):
    for seed in models:
        kelvin = random_kelvin(seed)
        maxwell = maxwell_of(kelvin)
        back = kelvin_of(maxwell)
        t = CURVES[30 * maxwell.times.max() > CURVES] if kelvin.fluidity else CURVES
        assert_equal(back.creep(CURVES), kelvin.creep(CURVES), seed)
        assert_equal(maxwell_of(back).relaxation(t), maxwell.relaxation(t), seed)
        first, second = kelvin.complex_compliance(CURVES), back.complex_compliance(CURVES)
        assert_equal(second.real, first.real, seed)
        assert_equal(second.imag, first.imag, seed)


@MODELS
def test_compliance_and_modulus_are_inverse_in_time_and_frequency(models):
    for seed in models:
        kelvin = random_kelvin(seed)
        maxwell = maxwell_of(kelvin)
        assert_equal(identity(kelvin, maxwell, CURVES), 1, seed)
        assert_equal(kelvin.complex_compliance(CURVES) * maxwell.complex_modulus(CURVES), 1, seed)
        generator = np.random.default_rng(seed)
        s = 10 ** generator.uniform(-7, 7, 50) * np.exp(1j * generator.uniform(-np.pi / 2, np.pi / 2, 50))
        assert_equal(transforms(kelvin, maxwell, s), 1, seed)
        assert_equal(kelvin.glassy_compliance * maxwell.instantaneous_modulus, 1, seed)
        if kelvin.fluidity == 0:
            assert kelvin.equilibrium_compliance * maxwell.equilibrium_modulus == pytest.approx(1, rel=1e-15)


def test_a_modulus_off_by_a_millionth_breaks_the_identities():
    """Twin: the checks see a single wrong constant."""
    kelvin = random_kelvin(2)
    maxwell = maxwell_of(kelvin)
    wrong = GeneralizedMaxwell(maxwell.equilibrium_modulus * (1 + 1e-6), maxwell.moduli, maxwell.times)
    assert np.abs(identity(kelvin, wrong, CURVES) - 1).max() > 1e-7
    assert np.abs(transforms(kelvin, wrong, CURVES + 0j) - 1).max() > 1e-7
    assert np.abs(kelvin_of(wrong).creep(CURVES) / kelvin.creep(CURVES) - 1).max() > 1e-7


def test_times_interlace():
    """1 / tau of the relaxation lies above that of the creep, unit by unit."""
    for seed in range(0, 240, 6):
        kelvin = random_kelvin(seed + 2)  # neither flows nor has near-equal times
        maxwell = maxwell_of(kelvin)
        assert (maxwell.times < kelvin.times).all(), seed
        assert (maxwell.times[1:] > kelvin.times[:-1]).all(), seed
        assert maxwell_of(random_kelvin(seed)).times.size == random_kelvin(seed).times.size + 1, seed


@settings(derandomize=True, max_examples=200, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-20, 20), st.floats(-12, 12)), min_size=1, max_size=12),
    st.floats(-15, 15),
    st.sampled_from([0.0, 1e-20, 1.0, 1e15]),
)
def test_extreme_moduli_and_times_are_converted(units, glassy, fluidity):
    """Compliances over 40 decades: the tolerance bounds the complex curves, of which the parts differ by as many decades."""
    compliances, times = 10.0 ** np.array(units).T
    kelvin = GeneralizedKelvin(10.0**glassy, compliances, times, fluidity=fluidity)
    maxwell = maxwell_of(kelvin)
    omega = np.logspace(-14, 14, 57)
    np.testing.assert_allclose(kelvin.complex_compliance(omega) * maxwell.complex_modulus(omega), 1, rtol=ROUND_OFF)
    back = kelvin_of(maxwell)
    np.testing.assert_allclose(back.complex_compliance(omega) / kelvin.complex_compliance(omega), 1, rtol=ROUND_OFF)
    np.testing.assert_allclose(back.creep(omega), kelvin.creep(omega), rtol=ROUND_OFF)


@pytest.mark.parametrize("apart", [2.3e-16, 1e-15, 1e-14, 1e-12, 1e-9])
def test_near_equal_times_act_as_one(apart):
    near = maxwell_of(GeneralizedKelvin(1.0, [1.0, 1.0, 2.0], [1.0, 1.0 + apart, 5.0]))
    one = maxwell_of(GeneralizedKelvin(1.0, [2.0, 2.0], [1.0, 5.0]))
    np.testing.assert_allclose(near.relaxation(CURVES), one.relaxation(CURVES), rtol=ROUND_OFF + 2 * apart)


def test_times_a_few_roundings_apart_are_converted():
    """Some of the roots between such times are not resolved, the sum of their units is."""
    for seed in range(60):
        generator = np.random.default_rng(seed)
        count = int(generator.integers(2, 13))
        compliances = 10 ** generator.uniform(-10, 10, count)
        times = 10 ** generator.uniform(-7, 7) * (1 + 2.3e-16 * generator.integers(0, 20, count))
        kelvin = GeneralizedKelvin(10 ** generator.uniform(-10, 10), compliances, times)
        maxwell = maxwell_of(kelvin)
        assert_equal(kelvin_of(maxwell).creep(CURVES), kelvin.creep(CURVES), seed)
        assert_equal(kelvin.complex_compliance(CURVES) * maxwell.complex_modulus(CURVES), 1, seed)


def test_models_beyond_the_range_of_floats_are_refused_and_never_wrong():
    generator, verdicts = np.random.default_rng(8), []
    for _ in range(100):
        strengths, times = 10 ** generator.uniform(-150, 150, 6), 10 ** generator.uniform(-60, 60, 6)
        for model, convert in (
            (GeneralizedKelvin(strengths[0], strengths[1:], times[1:]), maxwell_of),
            (GeneralizedMaxwell(strengths[0], strengths[1:], times[1:]), kelvin_of),
        ):
            try:
                other = convert(model)
            except InvalidQuantity as error:
                verdicts.append("too many decades apart" in str(error))
            else:
                kelvin, maxwell = (model, other) if convert is maxwell_of else (other, model)
                product = kelvin.complex_compliance(CURVES) * maxwell.complex_modulus(CURVES)
                np.testing.assert_allclose(product, 1, rtol=ROUND_OFF)
                verdicts.append(None)
    assert {True, None} == set(verdicts)


def test_springs_and_dashpots_alone():
    assert maxwell_of(GeneralizedKelvin(0.5, [], [])).equilibrium_modulus == 2.0
    assert kelvin_of(GeneralizedMaxwell(2.0, [], [])).glassy_compliance == 0.5
    unit = maxwell_of(GeneralizedKelvin(0.5, [], [], fluidity=0.25))
    assert (unit.equilibrium_modulus, unit.moduli.tolist(), unit.times.tolist()) == (0.0, [2.0], [2.0])
    fluid = kelvin_of(unit)
    assert (fluid.glassy_compliance, fluid.fluidity, fluid.times.size) == (0.5, 0.25, 0)
