"""How well estimators find lumps: errors, coverage, misses and false alarms over the samples of a data set, and one score."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from itertools import pairwise
from operator import attrgetter
from typing import Any

import numpy as np

from tactsim.array import Array
from tactsim.dataset.ranking.intervals import Given, interval, share, spread
from tactsim.dataset.ranking.samples import JudgedSamples, Truth
from tactsim.errors import InputError
from tactsim.interfaces import Estimator
from tactsim.interfaces.estimate import LEVEL, Estimate
from tactsim.localization.checked_estimate import estimate_of
from tactsim.localization.lump_response import LumpResponse
from tactsim.progress import count_bar

NOISES = (1.0, 2.0, 4.0)
"""Noise of a reading over the stated one."""
BINS = 4
"""Parts into which a label is divided, with equally many lumps each."""
LABELS = {"depth": "m", "radius": "m", "contrast": "1", "closing": "m"}
"""Labels of the truth over which everything is binned, with units."""


@dataclass(frozen=True)
class JudgedEstimate:
    """One estimate against the truth; lengths in m, None where there is none.

    ``lateral``, ``depth`` and ``radius`` are errors: distance in plan, estimated less true height, estimated less true radius.
    ``covered`` states whether the 90 % region holds the true centre; ``width`` and ``height`` are its sizes.
    """

    truth: Truth
    found: bool
    probability: float | None = None
    center: tuple[float, float, float] | None = None
    lateral: float | None = None
    depth: float | None = None
    radius: float | None = None
    covered: bool | None = None
    width: float | None = None
    height: float | None = None


def outcome(estimate: Estimate, truth: Truth) -> JudgedEstimate:
    """The strongest inclusion of an estimate against the truth."""
    if not estimate.inclusions:
        return JudgedEstimate(truth, False, estimate.probability)
    ball = estimate.inclusions[0]
    against: dict[str, Any] = {"found": True, "probability": estimate.probability, "center": ball.center}
    if ball.region is not None:
        against["width"], against["height"] = ball.region.sizes(LEVEL)
    if truth.center is not None and truth.radius is not None:
        away = np.asarray(ball.center) - truth.center
        against |= {"lateral": float(np.hypot(*away[:2])), "depth": float(away[2])}
        against["radius"] = None if ball.radius is None else ball.radius - truth.radius
        against["covered"] = None if ball.region is None else ball.region.contains(np.asarray(truth.center), LEVEL)
    return JudgedEstimate(truth, **against)


def outcomes(
    estimator: Estimator,
    samples: JudgedSamples,
    response: LumpResponse | None,
    *,
    multiple: float = 1.0,
    seed: int = 1,
    done: Callable[[], None] = lambda: None,
) -> list[JudgedEstimate]:
    """One outcome for each sample; ``done`` is called after each.

    Raises
    ------
    InputError
        If the estimator needs what the samples lack.
    """
    model = response if estimator.needs_response else None
    if estimator.needs_response and model is None:
        raise InputError(f"the estimator {estimator.kind} needs the response of the tissue")
    readings = samples.readings(model, multiple=multiple, seed=seed)
    judged = []
    for each, truth in zip(readings, samples.truths, strict=True):
        judged.append(outcome(estimate_of(estimator, each), truth))
        done()
    return judged


def measures(judged: Sequence[JudgedEstimate], block_size: Array) -> dict[str, Any]:
    """Numbers in SI: rates, errors of lumps that were detected, coverage and sizes of the regions, and the score.

    Each is a mapping to ``value`` and to ``low`` and ``high``, the 95 % interval: of rates and the coverage Wilson's, of all else
    by the bootstrap, over the specimens; None where no sample has any. ``block_size`` (3,) is in m.
    """
    lumps = [one for one in judged if one.truth.present]
    plain = [one for one in judged if not one.truth.present]
    hits = [one for one in lumps if one.found]

    def each(value: Callable[[JudgedEstimate], float | None], of: Sequence[JudgedEstimate] = hits) -> list[Given]:
        return [(one.truth.group, value(one)) for one in of]

    by_name: dict[str, Any] = {"samples": len(judged), "lumps": len(lumps), "without_lump": len(plain), "found": len(hits)}
    by_name["detection_rate"] = share(each(attrgetter("found"), lumps))
    by_name["false_alarm_rate"] = share(each(attrgetter("found"), plain))
    by_name["score"] = interval(each(partial(penalty, block_size=block_size), judged), np.mean)
    for name in ("lateral", "depth", "radius"):
        by_name[f"{name}_error"] = spread(each(partial(_size_of, name=name)))
        by_name[f"{name}_error_with_misses"] = _with_misses(lumps, name, block_size)
    by_name["depth_bias"] = interval(each(attrgetter("depth")), np.median)
    by_name["coverage"] = share(each(attrgetter("covered")))
    by_name["region_width"] = interval(each(attrgetter("width")), np.median)
    by_name["region_height"] = interval(each(attrgetter("height")), np.median)
    return by_name


def _size_of(one: JudgedEstimate, name: str) -> float | None:
    """Size in m of an error, None where there is none."""
    error = getattr(one, name)
    return None if error is None else abs(float(error))


def penalty(one: JudgedEstimate, block_size: Array) -> float:
    """Distance in m of the estimated from the true centre, at most half the block's plan and height together.

    That much is also counted for a lump that is missed and for an alarm without a lump, so that it does not pay to report
    nothing; nothing is counted for rightly finding nothing. ``block_size`` (3,) is in m.
    """
    most = float(np.hypot(np.min(block_size[:2]) / 2, block_size[2] / 2))
    if one.lateral is not None and one.depth is not None:
        return min(most, float(np.hypot(one.lateral, one.depth)))
    return 0.0 if one.found == one.truth.present else most


def _with_misses(lumps: Sequence[JudgedEstimate], name: str, block_size: Array) -> dict[str, float] | None:
    """Median of an error in m over all lumps, a missed one counted as half the block's size; None for the radius."""
    if name == "radius":
        return None
    most = float(np.min(block_size[:2]) / 2 if name == "lateral" else block_size[2] / 2)
    errors = ((one.truth.group, _size_of(one, name)) for one in lumps)
    return interval(((group, most if size is None else size) for group, size in errors), np.median)


def binned(judged: Sequence[JudgedEstimate], block_size: Array) -> dict[str, list[dict[str, Any]]]:
    """For each label, the measures of lumps in parts of its range with equally many lumps; ``block_size`` (3,) in m."""
    lumps = [one for one in judged if one.truth.present]
    by_label: dict[str, list[dict[str, Any]]] = {}
    for label in LABELS:
        values = np.array([getattr(one.truth, label) for one in lumps], dtype=float)
        edges = np.unique(np.quantile(values, np.linspace(0, 1, BINS + 1))) if values.size else np.zeros(0)
        edges = np.repeat(edges, 2) if len(edges) == 1 else edges
        by_label[label] = []
        for k, (low, high) in enumerate(pairwise(edges)):
            inside = (values >= low) & ((values <= high) if k == len(edges) - 2 else (values < high))
            members = [one for one, held in zip(lumps, inside, strict=True) if held]
            by_label[label].append({"low": float(low), "high": float(high), **measures(members, block_size)})
    return by_label


@dataclass(frozen=True, eq=False)
class Ranked:
    """An estimator, its outcomes at the stated noise, and its measures at several."""

    name: str
    outcomes: tuple[JudgedEstimate, ...]
    noises: Mapping[float, dict[str, Any]]
    bins: Mapping[str, list[dict[str, Any]]]

    @property
    def measures(self) -> dict[str, Any]:
        """At the stated noise."""
        return self.noises[1.0]

    def record(self) -> dict[str, Any]:
        """All numbers, in SI, with one row for each sample."""
        rows = [asdict(one) for one in self.outcomes]
        noises = [{"multiple": multiple, **measures} for multiple, measures in self.noises.items()]
        return {"name": self.name, "measures": self.measures, "noise": noises, "bins": dict(self.bins), "samples": rows}


def ranking(
    estimators: Mapping[str, Estimator],
    samples: JudgedSamples,
    response: LumpResponse | None,
    *,
    seed: int = 1,
    failed: Callable[[str, Exception], None] | None = None,
) -> list[Ranked]:
    """Every estimator on every sample at every noise, the least score first.

    One that fails is left out, and ``failed`` is called with its name and its error; by default the error is raised.

    Raises
    ------
    InputError
        If an estimator needs what the samples lack.
    """
    ranked = []
    with count_bar("estimates", len(estimators) * len(NOISES) * len(samples.truths)) as show:
        numbers = itertools.count(1)
        judge = partial(outcomes, samples=samples, response=response, seed=seed, done=lambda: show(next(numbers)))
        for name, estimator in estimators.items():
            try:
                runs = {multiple: judge(estimator, multiple=multiple) for multiple in NOISES}
            except Exception as error:  # a defect in one of the user's own costs no other its place
                if failed is None:
                    raise
                failed(name, error)
                continue
            noises = {multiple: measures(run, samples.block_size) for multiple, run in runs.items()}
            ranked.append(Ranked(name, tuple(runs[1.0]), noises, binned(runs[1.0], samples.block_size)))
    return sorted(ranked, key=lambda one: float(one.measures["score"]["value"]))
