"""Response to histories: convolution by quadrature, another solver, and exact series at early times."""

from __future__ import annotations

import itertools
from decimal import Decimal, getcontext

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.analytic.generalized_maxwell import GeneralizedMaxwell
from tactsim.analytic.histories import Harmonic, History, Segment, harmonic, ramp, sampled, step
from tactsim.analytic.interconversion import maxwell_of
from tactsim.analytic.response import ramp_lag, response, wave_lags
from tactsim.errors import InvalidQuantity

getcontext().prec = 60


def random_kelvin(seed: int) -> GeneralizedKelvin:
    generator = np.random.default_rng(seed)
    strengths, times = 10 ** generator.uniform(-1, 1, (2, int(generator.integers(1, 5))))
    return GeneralizedKelvin(generator.uniform(0.1, 1), strengths, times, fluidity=generator.uniform(0.1, 1) * (seed % 2))


def random_history(seed: int) -> History:
    """Segments with jumps, slopes and up to two harmonics of any phase."""
    generator = np.random.default_rng(seed)
    starts = np.append(0.0, np.cumsum(generator.uniform(0.1, 2, 3)))
    segments = []
    for start, end in itertools.pairwise([*starts.tolist(), np.inf]):
        waves = tuple(Harmonic(*generator.uniform([-1, 0, -4], [1, 5, 4])) for _ in range(generator.integers(0, 3)))
        segments.append(Segment(start, end, *generator.normal(size=2), waves))
    return History(tuple(segments))


def convolved(history: History, kernel, instantaneous: float, t: float) -> float:
    """instantaneous * f(t) + integral of kernel(t - s) f(s) over 0 < s < t, by adaptive quadrature between the jumps."""
    breaks = [*history.starts[history.starts < t], t]
    pieces = (
        quad(lambda s: kernel(t - s) * history.value(s), a, b, epsabs=0, epsrel=1e-12) for a, b in itertools.pairwise(breaks)
    )
    return instantaneous * float(history.value(t)) + sum(piece[0] for piece in pieces)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 8))])
def test_the_response_is_the_convolution(seed):
    kelvin, history = random_kelvin(seed), random_history(seed)
    maxwell = maxwell_of(kelvin)
    times = np.array([0.05, 1.0, 2.5, 5.0, 9.0])
    creeping = lambda u: np.exp(-u / kelvin.times) @ (kelvin.compliances / kelvin.times) + kelvin.fluidity  # noqa: E731
    relaxing = lambda u: -np.exp(-u / maxwell.times) @ (maxwell.moduli / maxwell.times)  # noqa: E731
    strain = [convolved(history, creeping, kelvin.glassy_compliance, t) for t in times]
    stress = [convolved(history, relaxing, maxwell.instantaneous_modulus, t) for t in times]
    size = max(np.abs(stress).max(), maxwell.instantaneous_modulus)  # its parts, which cancel where the stress has relaxed
    np.testing.assert_allclose(response(kelvin, history, times), strain, rtol=1e-10, atol=1e-10 * np.abs(strain).max())
    np.testing.assert_allclose(response(maxwell, history, times), stress, rtol=1e-10, atol=1e-10 * size)


def test_a_wrong_time_is_seen_by_the_convolution():
    """Twin: a retardation time wrong by 1e-8."""
    kelvin, history = random_kelvin(0), random_history(0)
    creeping = lambda u: np.exp(-u / kelvin.times) @ (kelvin.compliances / kelvin.times) + kelvin.fluidity  # noqa: E731
    wrong = GeneralizedKelvin(kelvin.glassy_compliance, kelvin.compliances, kelvin.times * (1 + 1e-8), fluidity=kelvin.fluidity)
    expected = convolved(history, creeping, kelvin.glassy_compliance, 5.0)
    assert response(wrong, history, 5.0) != pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_the_response_is_that_of_an_ordinary_differential_equation(seed):
    kelvin = random_kelvin(seed)
    history = ramp(0.7, 20.0).added(harmonic(0.3, 0.4, mean=0.2)).added(harmonic(-0.2, 0.11))
    t = np.linspace(0, 10, 21)

    def rates(instant, state):
        stress = history.value(instant)
        return [*((stress - state[:-1]) / kelvin.times), stress]

    solved = solve_ivp(rates, (0, 10), np.zeros(kelvin.times.size + 1), "DOP853", t, rtol=1e-12, atol=1e-13).y
    strain = kelvin.glassy_compliance * history.value(t) + kelvin.compliances @ solved[:-1] + kelvin.fluidity * solved[-1]
    np.testing.assert_allclose(response(kelvin, history, t), strain, rtol=1e-10)


@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 6))])
def test_the_stress_of_a_strain_gives_the_strain_back(seed):
    """Both models of one material: a sampled stress, its strain at many points, and the stress of this strain."""
    kelvin = random_kelvin(seed)
    stress = ramp(1.0, 1.0).added(harmonic(0.5, 0.2, start=0.5))
    t = np.linspace(0, 3, 3001)
    back = response(maxwell_of(kelvin), sampled(t, response(kelvin, stress, t)), t)
    np.testing.assert_allclose(back, stress.value(t), atol=2e-4)  # interpolation: h^2 / (8 tau^2) with tau from 0.03 s


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_loop_carries_as_numpy_does(seed, monkeypatch):
    """Sampled histories of 300 pieces, their steps from a thousandth to 30 times the times of the units."""
    generator = np.random.default_rng(seed)
    times = np.cumsum(10 ** generator.uniform(-3, 1.5, 300))
    history, model = sampled(times, generator.normal(size=300)), random_kelvin(seed)
    models = (model, maxwell_of(model))
    by_numpy = [response(one, history, times) for one in models]
    monkeypatch.setattr("tactsim.analytic.response.INTERPRETED", 0)
    for one, expected in zip(models, by_numpy, strict=True):
        np.testing.assert_allclose(response(one, history, times), expected, rtol=1e-13, atol=1e-14 * np.abs(expected).max())


def test_steps_give_creep_and_relaxation():
    kelvin = random_kelvin(1)
    t = np.concatenate([[-1.0, 0.0], np.logspace(-12, 3, 40)])
    np.testing.assert_allclose(response(kelvin, step(2.0), t), 2 * kelvin.creep(t), rtol=1e-14)
    np.testing.assert_allclose(response(maxwell_of(kelvin), step(2.0), t), 2 * maxwell_of(kelvin).relaxation(t), rtol=1e-14)


def test_superposition_order_and_shape():
    kelvin = random_kelvin(3)
    first, second = random_history(1), random_history(2)
    t = np.random.default_rng(5).uniform(-1, 12, (7, 11))
    for model in (kelvin, maxwell_of(kelvin)):
        total = response(model, first.added(second), t)
        parts = response(model, first, t) + response(model, second, t)
        np.testing.assert_allclose(total, parts, rtol=1e-12, atol=1e-12 * np.abs(parts).max())
        np.testing.assert_array_equal(total.ravel()[::-1], response(model, first.added(second), t.ravel()[::-1]))
        assert response(model, first, []).shape == (0,)
        assert float(response(model, first, -1.0)) == 0.0
        with pytest.raises(InvalidQuantity, match="NaN or infinity"):
            response(model, first, np.inf)


def test_a_spring_follows_its_input():
    history, t = random_history(4), np.linspace(-1, 9, 50)
    np.testing.assert_allclose(response(GeneralizedKelvin(2.0, [], []), history, t), 2 * history.value(t), rtol=1e-15)
    np.testing.assert_allclose(response(GeneralizedMaxwell(2.0, [], []), history, t), 2 * history.value(t), rtol=1e-15)


def exponential(x: Decimal) -> Decimal:
    return x.exp()


def cosine_and_sine(x: Decimal) -> tuple[Decimal, Decimal]:
    """Taylor series with 60 digits, for |x| < 20."""
    term, sums = Decimal(1), [Decimal(0), Decimal(0)]
    for k in range(200):
        sums[k % 2] += term * (1, 1, -1, -1)[k % 4]
        term *= x / (k + 1)
    return sums[0], sums[1]


@pytest.mark.parametrize("h", [1e-15, 1e-9, 1e-4, 0.01, 0.3, 0.4999, 0.5, 0.7, 0.9999, 1.0, 1.5, 6.0, 40.0])
def test_lags_are_exact_to_round_off_from_the_earliest_times(h):
    exact = Decimal(h) - 1 + exponential(-Decimal(h))
    assert float(ramp_lag(np.array(h))) == pytest.approx(float(exact), rel=2e-15)
    for lag in (1e-6, 0.03, 1.0, 1.3, 15.0, 1e4):
        angle = h * lag
        if angle > 15:
            continue
        ratio = Decimal(angle) / Decimal(lag)  # the angle is a float, so the ratio is not quite h
        cos, sin = cosine_and_sine(Decimal(angle))
        r = Decimal(lag)
        c = (cos - exponential(-ratio) + r * sin) / (1 + r * r)
        s = (sin - r * cos + r * exponential(-ratio)) / (1 + r * r)
        computed = wave_lags(*(np.array(x) for x in (h, angle, lag)))
        size = min(1.0, h) * min(1.0, 1 / lag) if angle > 1 else 0.0  # zeros of waves are met to round-off of the wave
        assert float(computed[0]) == pytest.approx(float(c), rel=2e-14, abs=1e-14 * size)
        assert float(computed[1]) == pytest.approx(float(s), rel=2e-14, abs=1e-14 * size)
