"""Numbers over the samples of a data set, each with the interval in which it would lie for other specimens."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.special import ndtri

from tactsim.array import Array

DRAWN = 1000
"""Bootstrap samples of an interval."""
INTERVAL = 0.95
"""Probability of an interval."""
Statistic = Callable[..., Any]
"""Of values along the ``axis`` that it is given."""
Given = tuple[int, float | None]
"""Number of the specimen, and the value of one of its samples, if it has one."""


def spread(given: Iterable[Given]) -> dict[str, Any] | None:
    """Median, 90 % quantile and mean, each with its interval; None without values."""
    known = [one for one in given if one[1] is not None]
    named: dict[str, Statistic] = {"median": np.median, "quantile_90": partial(np.quantile, q=0.9), "mean": np.mean}
    return {name: interval(known, statistic) for name, statistic in named.items()} if known else None


def interval(given: Iterable[Given], statistic: Statistic) -> dict[str, float] | None:
    """Value of a statistic with its 95 % interval; None without values.

    The percentile bootstrap, seeded, which draws whole specimens: samples of one specimen err alike, and together count as little
    more than one (Davison and Hinkley 1997, doi:10.1017/CBO9780511802843, section 3.8).
    """
    groups = _by_specimen(given)
    if not groups:
        return None
    low, high = np.quantile(_resampled(groups, statistic), [(1 - INTERVAL) / 2, (1 + INTERVAL) / 2])
    return {"value": float(statistic(np.concatenate(groups), axis=0)), "low": float(low), "high": float(high)}


def _resampled(groups: Sequence[Array], statistic: Statistic) -> Array:
    """The statistic of each of the bootstrap samples, at once for all that have as many values."""
    drawn = np.random.default_rng(1).integers(len(groups), size=(DRAWN, len(groups)))
    lengths = np.array([len(group) for group in groups])
    starts, taken = (np.cumsum(lengths) - lengths)[drawn].ravel(), lengths[drawn].ravel()
    places = np.repeat(starts - (np.cumsum(taken) - taken), taken) + np.arange(taken.sum())
    values, counts = np.concatenate(groups)[places], lengths[drawn].sum(axis=1)
    first, resampled = np.cumsum(counts) - counts, np.empty(DRAWN)
    for count in np.unique(counts):
        alike = counts == count
        resampled[alike] = statistic(values[first[alike, None] + np.arange(count)], axis=1)
    return resampled


def share(given: Iterable[Given]) -> dict[str, float] | None:
    """Part of the true ones with its 95 % interval; None without values.

    Wilson's interval (1927, doi:10.1080/01621459.1927.10502953), which has a width at 0 and 1 too, for the number of independent
    samples that would tell as much (Rao and Scott 1992, doi:10.2307/2532311), which is the smaller, the more alike the samples of
    one specimen are. Where all are true or none is, nothing shows how alike they are, and every specimen counts as one.
    """
    groups = _by_specimen(given)
    if not groups:
        return None
    part = float(np.concatenate(groups).mean())
    low, high = _wilson(part, _independent(groups, part))
    return {"value": part, "low": low, "high": high}


def _independent(groups: Sequence[Array], part: float) -> float:
    """Number of independent samples that would tell the part of the true ones as well as the specimens do, at most all."""
    counts = np.array([len(group) for group in groups])
    total, number = counts.sum(), len(groups)
    if number in (1, total) or not 0 < part < 1:
        return float(number)
    off = np.array([group.sum() for group in groups]) - part * counts
    variance = number / (number - 1) * float((off**2).sum()) / total**2
    return float(min(total, max(1.0, part * (1 - part) / variance if variance else np.inf)))


def _wilson(part: float, count: float) -> tuple[float, float]:
    """Wilson's bounds of a part of ``count`` independent samples."""
    z = float(ndtri((1 + INTERVAL) / 2))
    middle = (part + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z / (1 + z**2 / count) * float(np.sqrt(part * (1 - part) / count + z**2 / (4 * count**2)))
    return max(0.0, middle - half) if part else 0.0, min(1.0, middle + half) if part < 1 else 1.0


def _by_specimen(given: Iterable[Given]) -> list[Array]:
    """The values that there are, those of one specimen together, in the order of its first one."""
    groups: dict[int, list[float]] = {}
    for specimen, value in given:
        if value is not None:
            groups.setdefault(specimen, []).append(float(value))
    return [np.array(values) for values in groups.values()]
