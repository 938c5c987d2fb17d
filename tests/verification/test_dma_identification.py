"""Generalized Kelvin model from eight frequencies: exact data come back, noise is banded, and least squares beats the search."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pytest
from mutants import assert_kills
from scipy.stats import binom

from tactsim.analytic.atrial import TIMES, table_4_1
from tactsim.identification.dma_bands import least_squares_band
from tactsim.identification.dma_data import DmaData, parts_of, synthetic_dma
from tactsim.identification.dma_genetic import GeneticSettings, fit_genetic
from tactsim.identification.dma_least_squares import fit_least_squares

FREQUENCIES = np.linspace(1, 36, 1000)
BAND_FREQUENCIES = np.geomspace(1, 36, 120)
NOISE, CONFIDENCE = 0.02, 0.95


def true_parts(times, frequencies):
    return parts_of(table_4_1(times).complex_compliance(2 * np.pi * frequencies))


SEARCHES = [(0.0, 40), (NOISE, 200)]
"""Noise and generations of a search: without noise the least is zero, far below what any search reaches."""


@cache
def band(times, seed, stretched, replicates):
    """The band of one trial, its noise taken for ``stretched`` times what it is."""
    data = synthetic_dma(table_4_1(times), noise=NOISE, seed=5000 + seed)
    known = DmaData(data.frequencies, data.compliance, stretched * data.relative_noise)
    return least_squares_band(fit_least_squares(known), BAND_FREQUENCIES, confidence=CONFIDENCE, replicates=replicates, seed=seed)


def trials(times, count, *, stretched=1.0, factor=1.0, replicates=300):
    """Part of the trials in which the band holds the true curves times a factor, and the median full width of the band."""
    true = factor * true_parts(times, BAND_FREQUENCIES)
    bands = [band(times, seed, stretched, replicates) for seed in range(count)]
    return np.mean([one.contains(true) for one in bands]), np.median([np.median(one.relative_width) for one in bands])


@pytest.mark.parametrize(
    ("times", "known"),
    [(TIMES[0], True), (TIMES[0], False), *(pytest.param(TIMES[1], known, marks=pytest.mark.slow) for known in (True, False))],
)
def test_exact_data_give_the_curves_back(times, known, verification_record):
    data = synthetic_dma(table_4_1(times))
    fit = fit_least_squares(data if known else DmaData(data.frequencies, data.compliance))
    parts = fit.parts(FREQUENCIES)

    def check(true):
        assert np.abs(parts / true - 1).max() < 1e-6  # relative, as demanded; the largest seen is 6e-8

    true = true_parts(times, FREQUENCIES)
    check(true)
    words = {"reference": "the model that made the data", "kind": "exact", "mesh": "eight frequencies", "tolerance": 1e-6}
    verification_record("compliance identified from exact data", parts / true, np.ones_like(true), **words)
    (other,) = (reading for reading in TIMES if reading != times)
    hertz = parts_of(table_4_1(times).complex_compliance(FREQUENCIES))
    assert_kills(check, times=(true_parts(other, FREQUENCIES),), swapped=(true[::-1],), hertz_for_radians=(hertz,))


@pytest.mark.parametrize(
    ("times", "noise", "generations"),
    [
        (TIMES[0], NOISE, 40),
        *(pytest.param(times, noise, count, marks=pytest.mark.slow) for times in TIMES for noise, count in SEARCHES),
    ],
)
def test_the_search_does_not_reach_the_objective_of_least_squares(times, noise, generations):
    data = synthetic_dma(table_4_1(times), noise=noise, seed=1)
    searched = fit_genetic(data, settings=GeneticSettings(population=100, generations=generations, seed=1))
    least = fit_least_squares(data, weighting="objective")
    assert least.objective < searched.objective
    if noise == 0:
        assert fit_least_squares(data).objective < 1e-6 * searched.objective


@pytest.mark.slow
@pytest.mark.parametrize("times", TIMES)
def test_the_band_holds_the_true_curves_in_forty_trials(times, verification_record):
    covered, width = trials(times, 40)
    least = binom.ppf(1e-3, 40, CONFIDENCE) / 40  # one false alarm in a thousand
    assert covered >= least
    assert width < 4 * NOISE
    known = {"reference": "the confidence asked for", "kind": "exact", "mesh": "eight frequencies", "scale": 1.0}
    verification_record("part of 40 bands that hold the true curves", covered, CONFIDENCE, tolerance=CONFIDENCE - least, **known)


FEWEST = binom.ppf(1e-3, 20, CONFIDENCE) / 20
few = partial(trials, TIMES[0], 20, replicates=120)
"""Twenty trials show it, with as many replicates as a quantile of 0.95 needs."""


def test_the_band_holds_the_true_curves_and_that_of_another_curve_does_not(verification_record):
    covered, width = few()
    assert covered >= FEWEST
    assert width < 4 * NOISE
    known = {"reference": "the confidence asked for", "kind": "exact", "mesh": "eight frequencies", "scale": 1.0}
    verification_record("part of 20 bands that hold the true curves", covered, CONFIDENCE, tolerance=CONFIDENCE - FEWEST, **known)
    assert few(factor=1.05)[0] < FEWEST


@pytest.mark.slow
def test_a_band_of_half_the_noise_would_not_hold_them():
    assert few(stretched=0.5)[0] < FEWEST


@pytest.mark.slow
@pytest.mark.parametrize("times", TIMES)
def test_the_band_holds_the_true_curves_in_two_hundred_trials(times, verification_record):
    covered, width = trials(times, 200)
    assert 0.895 <= covered <= 0.99  # 3.5 standard deviations of a binomial of 0.95
    assert width < 4 * NOISE
    known = {"reference": "the confidence asked for", "kind": "exact", "mesh": "eight frequencies", "scale": 1.0}
    verification_record("part of 200 bands that hold the true curves", covered, CONFIDENCE, tolerance=0.055, **known)
