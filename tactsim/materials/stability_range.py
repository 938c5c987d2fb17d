"""Where a material is stable: intervals of stretch of strong ellipticity and of Drucker's condition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.interfaces import Material
from tactsim.materials.homogeneous import PATHS
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.stability import drucker_margin, ellipticity_margin

SCANNED = (0.2, 5.0)
"""Stretches that are looked at: beyond any that a converged contact case has reached."""

SAMPLES = 1001
"""Scan points, evenly spaced in the logarithm: a lost interval narrower than 0.3 % of its stretch can be overlooked."""

DIRECTIONS = 121
"""Directions of logarithmic strain from uniaxial tension through pure shear to uniaxial compression: every state, by isotropy."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class PathStability:
    """Stability along one loading path; stretches, dimensionless."""

    elliptic: Interval
    """Strongly elliptic around the rest state between these stretches."""
    elliptic_lost: tuple[Interval, ...]
    """Every scanned interval in which strong ellipticity is lost."""
    drucker: Interval
    """Drucker stable around the rest state between these stretches."""
    drucker_lost: tuple[Interval, ...]
    """Every scanned interval in which Drucker stability is lost."""


@dataclass(frozen=True)
class StabilityReport:
    """Stability over the scanned stretches."""

    paths: dict[str, PathStability]
    """By the name of the loading path."""
    elliptic_everywhere_within: float
    """Largest s so that every state with all principal stretches within [1/s, s] is strongly elliptic."""
    scanned: Interval = SCANNED
    """Stretches that were looked at."""

    @property
    def strongly_elliptic(self) -> bool:
        """Whether every state with all principal stretches among the scanned ones is strongly elliptic.

        A path may lose it further out: an equibiaxial stretch of 0.2 is a third stretch of 25.
        """
        return self.elliptic_everywhere_within >= self.scanned[1]


def stability_range(material: Material) -> StabilityReport:
    """Intervals of stretch in which the incompressible material is strongly elliptic and Drucker stable.

    Ends are located to 1e-10 of the stretch. A law without an energy of the invariants is judged along its axes, in sampled
    directions of the tangent; linear elasticity is stable at every stretch.
    """
    if isinstance(material, LinearElastic):
        return StabilityReport(dict.fromkeys(PATHS, PathStability(SCANNED, (), SCANNED, ())), SCANNED[1])
    paths = {name: _path_stability(material, stretches) for name, stretches in PATHS.items()}
    return StabilityReport(paths, _elliptic_everywhere_within(material))


def _path_stability(material: Material, stretches: Callable[[Array], Array]) -> PathStability:
    """Both conditions along one path."""
    elliptic_lost = lost_intervals(lambda stretch: ellipticity_margin(material, stretches(stretch)))
    drucker_lost = lost_intervals(lambda stretch: drucker_margin(material, stretches(stretch)))
    return PathStability(around_rest(elliptic_lost), elliptic_lost, around_rest(drucker_lost), drucker_lost)


def lost_intervals(margin: Callable[[Array], Array]) -> tuple[Interval, ...]:
    """Intervals of the scanned stretches in which a margin, of the shape of its stretches, is not positive.

    Their ends are located by root finding.
    """
    stretch = np.geomspace(*SCANNED, SAMPLES)
    lost = ~(margin(stretch) > 0)
    ends = [
        float(scipy.optimize.brentq(lambda x: float(margin(np.array(x))), stretch[k], stretch[k + 1], xtol=1e-12, rtol=1e-10))
        for k in np.flatnonzero(lost[1:] != lost[:-1])
    ]
    ends = [SCANNED[0]] * bool(lost[0]) + ends + [SCANNED[1]] * bool(lost[-1])
    return tuple(zip(ends[::2], ends[1::2], strict=True))


def around_rest(lost: tuple[Interval, ...]) -> Interval:
    """The interval around stretch 1 that is free of lost ones; only 1 itself if that is lost."""
    below = [min(high, 1.0) for low, high in lost if low <= 1]
    above = [max(low, 1.0) for low, high in lost if high >= 1]
    return max(below, default=SCANNED[0]), min(above, default=SCANNED[1])


def _elliptic_everywhere_within(material: Material) -> float:
    """Largest s with strong ellipticity for all principal stretches in [1/s, s], along rays of logarithmic strain; 1 if the rest
    state has none."""
    angle = np.linspace(0, np.pi / 3, DIRECTIONS)
    direction = np.stack([np.cos(angle - k * 2 * np.pi / 3) for k in range(3)])
    direction /= np.abs(direction).max(axis=0)

    def margin(logarithm: Array, rays: Array) -> Array:
        return ellipticity_margin(material, np.exp(rays * logarithm))

    logarithm = np.linspace(0, np.log(SCANNED[1]), SAMPLES // 2)
    lost = ~(margin(logarithm[:, None], direction[:, None, :]) > 0)
    first = np.where(lost.any(axis=0), lost.argmax(axis=0), len(logarithm))
    ray = int(first.argmin())
    if first[ray] in (0, len(logarithm)):
        return SCANNED[1] if first[ray] else 1.0
    ends = [
        scipy.optimize.brentq(
            lambda t, k=k: float(margin(np.array(t), direction[:, k])), logarithm[first[k] - 1], logarithm[first[k]]
        )
        for k in np.flatnonzero(first == first[ray])
    ]
    return float(np.exp(min(ends)))
