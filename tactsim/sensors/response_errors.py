"""How far a sensor's reading is from the force: by range of force, over loading and unloading, in steps of the converter."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tactsim.array import Array


@dataclass(frozen=True)
class ForceRange:
    """Errors in N of the samples whose force lies from ``low`` on below ``high``, both in N; 0 where there is none."""

    low: float
    high: float
    samples: int
    rms: float
    largest: float


def root_mean_square(values: Array) -> float:
    """Root of the mean of the squares, in the unit of the values, which have any shape."""
    return float(np.sqrt(np.mean(np.square(values))))


def range_errors(force: Array, reading: Array, borders: Sequence[float]) -> tuple[ForceRange, ...]:
    """Errors of readings (n,) of forces (n,) in N, for each interval between borders in N; the last one includes its end."""
    ranges = []
    for low, high in itertools.pairwise(borders):
        chosen = (force >= low) & ((force <= high) if high == borders[-1] else (force < high))
        error = (reading - force)[chosen]
        rms, largest = (root_mean_square(error), float(np.abs(error).max())) if error.size else (0.0, 0.0)
        ranges.append(ForceRange(low, high, int(error.size), rms, largest))
    return tuple(ranges)


def hysteresis(force: Array, reading: Array, *, points: int = 200) -> float:
    """Largest difference in N between readings of equal forces, one while the force rises and one while it falls.

    The samples (n,) are sorted into ``points`` equal intervals of force; their means are compared where both exist.
    """
    change = np.sign(np.diff(force, append=force[-1:]))
    spread = float(np.ptp(force))
    if spread == 0:
        return 0.0
    number = np.minimum(((force - force.min()) / spread * points).astype(int), points - 1)
    means = []
    for direction in (1, -1):
        chosen = change == direction
        count = np.bincount(number[chosen], minlength=points)
        total = np.bincount(number[chosen], (reading - force)[chosen], points)
        means.append(np.divide(total, count, where=count > 0, out=np.full(points, np.nan)))
    difference = np.abs(means[0] - means[1])
    return 0.0 if np.isnan(difference).all() else float(np.nanmax(difference))
