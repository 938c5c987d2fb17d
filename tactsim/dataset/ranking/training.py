"""Training of the learned estimator: grasps of a data set and of the fast forward model, their mirror images, and noise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from itertools import product
from typing import Any

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.dataset.ranking.samples import JudgedSamples, added_noise
from tactsim.errors import InputError
from tactsim.interfaces.estimate import LEVEL
from tactsim.localization.candidates import BALL_RADII, gap_in, limits_in
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.lump_response import LumpResponse
from tactsim.localization.networks import OUTPUTS, LearnedWeights, Network, inputs

HIDDEN = (64, 64)
"""Neurons in each hidden layer of a network."""
NETWORKS = 4
"""Networks of the ensemble for the place."""
PASSES = 40
"""Passes over the examples; their number does not depend on the loss."""
FAST = 8000
"""Grasps of the fast forward model; one in four without a lump."""
COPIES = 4
"""Noisy copies of every mirror image of a grasp."""
NOISES = (0.5, 4.0)
"""Range of the noise over the stated one, log-uniform."""
CONTRASTS = (0.7, 5.0)
"""Range of the contrast of the fast model: from a lump twice as stiff to large rigid ones, which act several times more."""
HELD_OUT = 0.2
"""Share of the grasps from which the uncertainty is estimated."""
LEAST = 20
"""Grasps with a lump that training needs."""
FLOOR = 1e-6
"""Least variance over the block's height squared."""


@dataclass(frozen=True, eq=False)
class Examples:
    """Changes and references (n, jaw, row, column) in N, targets (n, 4) in m, NaN where there is no lump, and the noise (n,) in N
    of a reading: the stated one, and the part of it that the changes contain already."""

    changes: Array
    references: Array
    targets: Array
    noise: Array
    own_noise: Array

    def taken(self, chosen: Array) -> Examples:
        """Some of them, by a mask (n,) or their numbers (m,)."""
        return Examples(*(getattr(self, field.name)[chosen] for field in fields(self)))

    @staticmethod
    def joined(parts: list[Examples]) -> Examples:
        """All of them."""
        return Examples(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Examples)))


def trained(samples: JudgedSamples, response: LumpResponse | None = None, *, seed: int = 1) -> LearnedWeights:
    """Weights from the samples, four in five to fit and one in five for the uncertainty, and from the fast model if given.

    Raises
    ------
    InputError
        If scikit-learn is not installed, or there are too few lumps.
    """
    generator = np.random.default_rng(seed)
    examples = _examples(samples)
    lumps = int(np.isfinite(examples.targets[:, 0]).sum())
    if lumps < LEAST:
        raise InputError(f"{lumps} grasps with a lump; training needs at least {LEAST}")
    held = _held_out(samples, generator)
    fitted = _mirrored(examples.taken(~held), samples)
    parts = [fitted] * COPIES + ([_fast(samples, response, generator)] if response is not None else [])
    features, targets = _noisy(Examples.joined(parts), generator)
    middle, scale = features.mean(axis=0), features.std(axis=0) + 1e-12
    places, presence = _fitted((features - middle) / scale, targets, samples.block_size, seed)
    bare = LearnedWeights(
        samples.plain.readings.layout, samples.block_size, middle, scale, places, presence, np.zeros((4, 4)), np.zeros(2)
    )
    bare = replace(bare, trained_on=samples.cases)
    return _with_uncertainty(bare, *_noisy(_mirrored(examples.taken(held), samples), generator, exact=True))


def _held_out(samples: JudgedSamples, generator: np.random.Generator) -> Array:
    """Which samples (n,) are kept from the fit: whole specimens, for samples of one err alike."""
    groups = np.array([truth.group for truth in samples.truths])
    order = generator.permutation(np.unique(groups))
    return np.isin(groups, order[: max(4, round(HELD_OUT * len(order)))])


def _examples(samples: JudgedSamples) -> Examples:
    targets = [[np.nan] * len(OUTPUTS) if t.center is None else [*t.center, t.radius] for t in samples.truths]
    changes = samples.forces - samples.references
    return Examples(changes, samples.references, np.array(targets, dtype=float), samples.noise, samples.own_noise)


def mirror_images(size: Array, rows: int, columns: int) -> Iterator[tuple[bool, bool, bool, bool]]:
    """Whether x, y and z are reversed and x and y exchanged, for all that leave a block (3,) in m and matrices as they are."""
    square = rows == columns and bool(np.isclose(size[0], size[1], rtol=1e-9))
    yield from product((False, True), (False, True), (False, True), (False, True) if square else (False,))


def _mirrored(examples: Examples, samples: JudgedSamples) -> Examples:
    """With all mirror images; both jaws are taken to be alike and to stand over the middle of the block."""
    layout, size = samples.plain.readings.layout, samples.block_size
    parts = []
    for *reverse, exchange in mirror_images(size, layout.rows, layout.columns):
        taxels = [values[:, :: -1 if reverse[2] else 1, :: -1 if reverse[1] else 1, :: -1 if reverse[0] else 1]
                  for values in (examples.changes, examples.references)]  # fmt: skip
        targets = examples.targets.copy()
        for axis, back in enumerate(reverse):
            targets[:, axis] = size[axis] - targets[:, axis] if back else targets[:, axis]
        if exchange:
            taxels = [values.swapaxes(2, 3) for values in taxels]
            targets[:, :2] = targets[:, 1::-1]
        parts.append(replace(examples, changes=taxels[0], references=taxels[1], targets=targets))
    return Examples.joined(parts)


def _fast(samples: JudgedSamples, response: LumpResponse, generator: np.random.Generator) -> Examples:
    """Grasps of the fast forward model at random closings, with the errors that the model-based estimator expects."""
    errors, size = ModelBasedEstimator(), samples.block_size
    radii = generator.uniform(*limits_in(size, errors.radii, BALL_RADII), FAST)
    low, high = (np.array([f(axis) for axis in response.axes]) for f in (np.min, np.max))
    reach = (radii + gap_in(size, errors.gap))[:, None]
    centers = generator.uniform(np.maximum(reach, low), np.minimum(size - reach, high))
    plain = samples.plain
    closings = generator.uniform(min(t.closing for t in samples.truths), plain.closings[-1], FAST)
    references = plain.at(closings)
    strength = references.sum(axis=(1, 2, 3)) / plain.forces[-1].sum()
    contrasts = _log_uniform(CONTRASTS, FAST, generator) * (generator.random(FAST) > 0.25)
    signals = response.signal(centers, radii) * (contrasts * strength)[:, None, None, None]
    size_of = [np.sqrt((values**2).mean(axis=(1, 2, 3), keepdims=True)) for values in (signals, references)]
    white = np.hypot(errors.model_error * size_of[0], errors.background_error * size_of[1])
    scaled = errors.background_scale * generator.standard_normal((FAST, 1, 1, 1)) * references
    changes = signals + scaled + white * generator.standard_normal(signals.shape)
    targets = np.where(contrasts[:, None] > 0, np.column_stack([centers, radii]), np.nan)
    return Examples(changes, references, targets, np.resize(samples.noise, FAST), np.zeros(FAST))


def _noisy(examples: Examples, generator: np.random.Generator, *, exact: bool = False) -> tuple[Array, Array]:
    """Features and targets, with noise of a random size, or of the stated one."""
    count = len(examples.targets)
    multiples = np.ones(count) if exact else _log_uniform(NOISES, count, generator)
    added = np.sqrt(2.0) * added_noise(examples.noise, examples.own_noise, multiples)
    changes = examples.changes + added[:, None, None, None] * generator.standard_normal(examples.changes.shape)
    features = inputs(changes, examples.references, examples.noise * multiples)
    return features, examples.targets


def _log_uniform(limits: tuple[float, float], count: int, generator: np.random.Generator) -> Array:
    return np.exp(generator.uniform(np.log(limits[0]), np.log(limits[1]), count))


def _fitted(features: Array, targets: Array, size: Array, seed: int) -> tuple[tuple[Network, ...], Network]:
    """The ensemble for the place and the network for the presence, by scikit-learn."""
    try:
        from sklearn.neural_network import MLPClassifier, MLPRegressor
    except ImportError:
        raise InputError("training needs scikit-learn; install it by pip install 'tactsim[learned]'") from None
    there = np.isfinite(targets[:, 0])
    wanted = (targets[there] - np.append(size / 2, 0.0)) / size[2]
    options: dict[str, Any] = {"hidden_layer_sizes": HIDDEN, "batch_size": 200, "alpha": 1e-4}
    places = [MLPRegressor(random_state=seed + k, **options) for k in range(NETWORKS)]
    presence = MLPClassifier(random_state=seed, **options)
    for _ in range(PASSES):
        for network in places:
            network.partial_fit(features[there], wanted)
        presence.partial_fit(features, there, classes=[False, True])
    return tuple(_plain(network) for network in places), _plain(presence)


def _plain(network: Any) -> Network:
    return Network(tuple(map(np.asarray, network.coefs_)), tuple(map(np.asarray, network.intercepts_)))


def _with_uncertainty(bare: LearnedWeights, features: Array, targets: Array) -> LearnedWeights:
    """The covariance of the errors of held out grasps, whose size follows a power of the change's size.

    It is widened or narrowed so that nine in ten of them lie in their 90 % ellipsoids.
    """
    there = np.isfinite(targets[:, 0])
    if not there.any():
        raise InputError("no lump among the grasps held out; train on more")
    features, height = features[there], float(bare.block_size[2])
    away = np.array([bare.place(row)[0] for row in features]) - targets[there]
    size = np.log(np.linalg.norm(away[:, :3], axis=1) / height + 1e-6)
    slope, offset = np.polyfit(features[:, -2], size, 1)
    growth = np.array([offset, min(0.0, float(slope))])
    scaled = away / height / np.exp(growth[0] + growth[1] * features[:, -2])[:, None]
    covariance = scaled.T @ scaled / len(scaled) + FLOOR * np.eye(4)
    apart = (scaled[:, :3] * np.linalg.solve(covariance[:3, :3], scaled[:, :3].T).T).sum(axis=1)
    covariance = covariance * float(np.quantile(apart, LEVEL) / scipy.stats.chi2.ppf(LEVEL, 3))
    counted = len(features) // len(list(mirror_images(bare.block_size, bare.layout.rows, bare.layout.columns)))
    error = float(np.median(np.linalg.norm(away[:, :2], axis=1))), float(np.median(np.abs(away[:, 2])))
    return replace(bare, covariance=covariance, growth=growth, held_out=counted, held_out_error=error)


def seen_in_training(learned: LearnedWeights, samples: JudgedSamples) -> int:
    """Number of the samples that the weights were trained on, by their cases."""
    return len(set(learned.trained_on).intersection(samples.cases) - {""})
