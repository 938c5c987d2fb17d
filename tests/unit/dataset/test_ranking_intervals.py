"""Intervals of what a ranking states: as wide as other specimens would make it."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.stats import binomtest

from tactsim.dataset.ranking.intervals import INTERVAL, interval, share, spread


def width(bounds: dict[str, float] | None) -> float:
    assert bounds is not None
    assert bounds["low"] <= bounds["value"] <= bounds["high"]
    return bounds["high"] - bounds["low"]


def test_an_interval_holds_its_value_and_shrinks() -> None:
    generator = np.random.default_rng(0)
    few, many = (width(interval(enumerate(generator.standard_normal(n)), np.mean)) for n in (20, 2000))
    assert many < few / 5  # 1 / sqrt(100) but for chance
    assert interval([], np.mean) is None
    assert interval([(0, None)], np.mean) is None
    assert spread([(0, None)]) is None


@pytest.mark.parametrize(("true", "count"), [(20, 20), (0, 20), (3, 20), (1, 1)])
def test_the_interval_of_a_rate_is_wilsons_which_has_a_width_at_its_ends(true: int, count: int) -> None:
    found = share(enumerate([True] * true + [False] * (count - true)))
    low, high = binomtest(true, count).proportion_ci(INTERVAL, method="wilson")
    assert found == pytest.approx({"value": true / count, "low": low, "high": high}, rel=1e-12, abs=1e-15)
    assert share([]) is None


def test_samples_that_repeat_one_another_are_known_no_better_than_one_of_each() -> None:
    values = np.random.default_rng(1).standard_normal(30)
    thrice = [(k, float(value)) for k, value in enumerate(values) for _ in range(3)]
    for statistic in (np.mean, np.median):
        assert interval(thrice, statistic) == pytest.approx(interval(enumerate(values), statistic), rel=1e-12)
    true = [(k, value > 0.3) for k, value in thrice]
    part = share(enumerate(values > 0.3))
    assert width(share(true)) == pytest.approx(width(part), rel=0.02)  # 29 independent samples against 30
    assert width(share((k, True) for k, _ in thrice)) == width(share(enumerate([True] * 30)))
    assert width(share([(7, True), (7, False), (7, True)])) > 0.8, "a single specimen"


@pytest.mark.parametrize("sizes", [pytest.param((3,) * 40, marks=pytest.mark.slow), (1, 2, 3, 4, 5) * 8])
def test_intervals_hold_the_truth_as_often_as_they_say_where_samples_of_a_specimen_are_alike(sizes: tuple[int, ...]) -> None:
    """300 data sets of 40 specimens whose samples share much of their error.

    The percentile bootstrap of the mean of n independent values is as wide as the normal distribution makes it, and holds the
    truth in 93.7 % for n = 33, as many as 40 specimens of one to five samples are worth.
    """
    generator = np.random.default_rng(2)
    specimens = np.repeat(np.arange(len(sizes)), sizes)
    held = {"mean": 0, "share": 0, "mean, independent": 0, "share, independent": 0}
    for _ in range(300):
        values = 2 * generator.standard_normal(len(sizes))[specimens] + generator.standard_normal(len(specimens))
        for name, groups in (("", specimens), (", independent", np.arange(len(specimens)))):
            found = interval(zip(groups, values, strict=True), np.mean)
            rate = share(zip(groups, values > 0, strict=True))
            held[f"mean{name}"] += found["low"] <= 0 <= found["high"]
            held[f"share{name}"] += rate["low"] <= 0.5 <= rate["high"]
    assert min(held["mean"], held["share"]) > 0.895 * 300, "three standard deviations of 300 draws below 93.7 %"
    assert max(held["mean, independent"], held["share, independent"]) < 0.82 * 300


def test_of_specimens_of_different_sizes_each_statistic_is_that_of_all_samples() -> None:
    given = [(0, 1.0), (1, 2.0), (1, 4.0), (2, None)]
    found = spread(given)
    assert found is not None
    assert [found[name]["value"] for name in ("median", "mean", "quantile_90")] == pytest.approx([2.0, 7 / 3, 3.6])
    assert (found["mean"]["low"], found["mean"]["high"]) == (1.0, 3.0)
    assert interval(given, partial(np.quantile, q=0.5))["value"] == 2.0
