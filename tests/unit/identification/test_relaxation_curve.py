"""A Prony series from a relaxation curve: recovered from its own response, with a rise and with noise; refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad_vec

import tactsim as ts
from tactsim.errors import InvalidQuantity, StorageError
from tactsim.identification.relaxation_curve import RelaxationCurve

FRACTIONS, TIMES = (0.3, 0.2), (0.13, 2.4)
SAMPLES = np.geomspace(0.01, 60, 80)


def relaxed(t, fractions=FRACTIONS, times=TIMES):
    return 1 - sum(fractions) + sum(g * np.exp(-t / tau) for g, tau in zip(fractions, times, strict=True))


def ramped(t, rise):
    """The mean of the responses to the steps of which the ramp consists, by quadrature."""
    return quad_vec(lambda s: relaxed(t - s), 0, rise, epsabs=1e-13, epsrel=1e-13)[0] / rise


def test_the_series_of_a_step_is_recovered() -> None:
    fit = ts.fit_relaxation(RelaxationCurve(SAMPLES, 5e3 * relaxed(SAMPLES)))
    np.testing.assert_allclose(fit.relaxation.fractions, FRACTIONS, rtol=1e-5)  # noise-free: the least squares are zero there
    np.testing.assert_allclose(fit.relaxation.times, TIMES, rtol=1e-5)
    assert fit.instantaneous == pytest.approx(5e3, rel=1e-6)
    assert fit.max_relative_error < 1e-6


def test_a_rise_is_taken_into_account() -> None:
    rise = 0.4
    t = rise + SAMPLES
    curve = RelaxationCurve(t, ramped(t, rise))
    fit = ts.fit_relaxation(curve, rise=rise)
    np.testing.assert_allclose(fit.relaxation.fractions, FRACTIONS, rtol=1e-4)  # of the quadrature, amplified by its fit
    np.testing.assert_allclose(fit.relaxation.times, TIMES, rtol=1e-4)
    assert fit.instantaneous == pytest.approx(1, rel=1e-4)
    ignored = ts.fit_relaxation(curve)  # the wrong model: a step at 0 s
    assert ignored.relaxation.fractions[0] != pytest.approx(FRACTIONS[0], rel=0.1)


def test_noise_moves_the_curve_by_less_than_itself() -> None:
    noise = 0.01
    measured = relaxed(SAMPLES) * (1 + noise * np.random.default_rng(1).standard_normal(SAMPLES.size))
    fit = ts.fit_relaxation(RelaxationCurve(SAMPLES, -measured))
    assert len(fit.relaxation.times) <= 4
    remaining, parts, times = fit.relaxation.amplitudes
    curve = fit.instantaneous * (remaining + np.exp(-SAMPLES[:, None] / times) @ parts)
    assert np.abs(curve / relaxed(SAMPLES) - 1).max() < noise
    assert fit.rms_relative_error == pytest.approx(noise, rel=0.25)  # 80 samples: its standard deviation is 8 %


def test_a_file_becomes_the_relaxation_of_a_material(tmp_path: Path) -> None:
    path = tmp_path / "held.csv"
    rows = [f"{t:.9g},{4 * relaxed(t):.9g}" for t in SAMPLES]
    path.write_text("# held at 10 %\ntime [s], force [mN]\n" + "\n".join(rows), encoding="utf-8")
    fit = ts.fit_relaxation(path)
    assert fit.instantaneous == pytest.approx(4e-3, rel=1e-4)
    material = ts.NeoHookean(c10="3 kPa", relaxation=fit.relaxation)
    assert material.relaxation.fractions == pytest.approx(FRACTIONS, rel=1e-3)
    assert fit.case_line.startswith("relaxation: {fractions: [0.3, 0.2], times: [0.13 s, 2.4 s]}")


@pytest.mark.parametrize(
    ("time", "response", "words"),
    [
        (SAMPLES, np.ones(80), "does not relax"),
        (SAMPLES, np.exp(-SAMPLES / 2), "relaxes to nothing"),
        (SAMPLES[::-1], relaxed(SAMPLES), "must increase"),
        (SAMPLES, relaxed(SAMPLES) - 0.7, "keep its sign"),
        (SAMPLES[:5], relaxed(SAMPLES[:5]), "at least 6"),
    ],
)
def test_what_is_no_relaxation_of_a_solid_is_refused(time, response, words: str) -> None:
    with pytest.raises(InvalidQuantity, match=words):
        ts.fit_relaxation(RelaxationCurve(time, response))


def test_columns_and_rise_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "two.csv"
    path.write_text("time [s], stress [kPa], force [N]\n0, 1, 1\n1, 1, 1\n", encoding="utf-8")
    with pytest.raises(InvalidQuantity, match="needed: time and one of stress"):
        ts.fit_relaxation(path)
    with pytest.raises(StorageError):
        ts.fit_relaxation(tmp_path / "none.csv")
    curve = RelaxationCurve(SAMPLES, relaxed(SAMPLES))
    with pytest.raises(InvalidQuantity, match="0 or more"):
        ts.fit_relaxation(curve, rise=-1.0)
    with pytest.raises(InvalidQuantity, match="fewer than 6 samples after a rise"):
        ts.fit_relaxation(curve, rise=59.0)


def noisy(seed: int, noise: float = 0.005) -> RelaxationCurve:
    return RelaxationCurve(SAMPLES, relaxed(SAMPLES) * (1 + noise * np.random.default_rng(seed).standard_normal(SAMPLES.size)))


def test_intervals_hold_the_true_series_as_often_as_they_say() -> None:
    """Of 40 noisy curves that are fitted with the two units they have; the mutant's intervals are half as wide."""
    fits = [fit for fit in map(ts.fit_relaxation, map(noisy, range(40))) if len(fit.relaxation.times) == 2]
    assert len(fits) > 5

    def held(narrowed: float) -> float:
        hits = []
        for fit in fits:
            for (low, high), true in zip(
                [*fit.fraction_intervals.T, *fit.time_intervals.T, fit.equilibrium_interval],
                [*FRACTIONS, *TIMES, 0.5],
                strict=True,
            ):
                middle, half = (low + high) / 2, narrowed * (high - low) / 2
                hits.append(abs(true - middle) < half)
        return float(np.mean(hits))

    assert held(1.0) > 0.85  # 0.95 of some fifty numbers that go together in fives
    assert held(0.4) < 0.75


def test_a_part_that_noise_splits_in_two_is_named() -> None:
    fit = ts.fit_relaxation(noisy(1, 0.01))
    assert len(fit.relaxation.times) == 3
    assert "does not determine the part that relaxes in 0.09" in fit.warnings[0]
    low, high = fit.equilibrium_interval
    assert low < 0.5 < high  # what stays is known all the same
    assert high - low < 0.05
    assert "95 % intervals: fractions" in str(fit)
    assert ts.fit_relaxation(noisy(1, 0.0005)).warnings == ()


def test_a_part_that_the_curve_leaves_open_has_finite_intervals() -> None:
    """The tails of what is drawn of a spurious part go beyond the floating-point numbers, of which numpy warns."""
    generator, time = np.random.default_rng(3), np.geomspace(0.02, 60, 60)
    noise = [generator.standard_normal(time.size) for _ in range(31)][-1]
    mean = {tau: tau / 0.2 * np.expm1(0.2 / tau) for tau in (0.5, 8.0)}
    response = 0.5 + 0.3 * mean[0.5] * np.exp(-time / 0.5) + 0.2 * mean[8.0] * np.exp(-time / 8.0)
    fit = ts.fit_relaxation(RelaxationCurve(time, response * (1 + 0.003 * noise)), rise=0.2)
    assert len(fit.warnings) == 1
    assert np.isfinite(fit.time_intervals).all()
    assert fit.fraction_intervals.max() == 1
