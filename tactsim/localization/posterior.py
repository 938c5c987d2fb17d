"""Bodies as the draws of a posterior have them: place, radius and contrast with covariance, and the region of the centre."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.interfaces.estimate import EstimatedInclusion
from tactsim.localization.candidates import Candidates
from tactsim.localization.evidence import Explanation
from tactsim.localization.region import GaussianRegion


def covariance_about(mean: Array, samples: Array, weights: Array, *, spreads: Array, cell: Array) -> Array:
    """Covariance (5, 5) of place, radius and contrast about a mean (5,), of weighted samples (n, 5).

    The contrast of each has a variance ``spreads`` (n,) of its own, each coordinate that of an even distribution over a ``cell``
    (3,) in m of the grid of candidates, between whose centres nothing was tried.
    """
    away = samples - mean
    covariance = (weights[:, None] * away).T @ away
    covariance[:3, :3] += np.diag(cell**2 / 12)
    covariance[4, 4] += weights @ spreads
    return np.asarray(covariance)


def likely_bodies(explanation: Explanation, candidates: Candidates, cell: Array) -> tuple[EstimatedInclusion, ...]:
    """The bodies of a class, the one with the strongest signal first.

    ``cell`` (3,) in m is one of the grid of candidates; the region of a centre is that of a normal distribution.
    """
    bodies, geometry = [], candidates.geometry
    for numbers, contrasts, spreads in zip(explanation.bodies, explanation.contrasts, explanation.spreads, strict=True):
        samples = np.column_stack([geometry.centers[numbers], geometry.radii[numbers], contrasts])
        mean, line = explanation.weights @ samples, None
        if geometry.kind == "tube":
            best = int(numbers[explanation.weights.argmax()])
            mean[:3] = geometry.centers[best]
            (x0, y0, z0), (x1, y1, z1) = (map(float, end[best]) for end in (geometry.begins, geometry.ends))
            line = ((x0, y0, z0), (x1, y1, z1))
        covariance = covariance_about(mean, samples, explanation.weights, spreads=spreads, cell=cell)
        signal = abs(mean[4]) * float(np.linalg.norm(candidates.signals[numbers[explanation.weights.argmax()]]))
        x, y, z, radius, contrast = map(float, mean)
        region = GaussianRegion(mean[:3], covariance[:3, :3])
        body = EstimatedInclusion(geometry.kind, (x, y, z), radius, contrast, covariance, region, line)
        bodies.append((signal, body))
    return tuple(body for _, body in sorted(bodies, key=lambda pair: -pair[0]))
