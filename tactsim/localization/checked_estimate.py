"""The answer of an estimator, held against what an estimator must give: the one place that asks one."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from tactsim.errors import InvalidQuantity
from tactsim.interfaces.estimate import Estimate
from tactsim.interfaces.readings import Readings


class Estimating(Protocol):
    """An estimator, or what repeats the estimate of one."""

    def estimate(self, readings: Readings) -> Estimate:
        """What it locates in readings."""


def estimate_of(estimator: Estimating, readings: Readings) -> Estimate:
    """What an estimator locates in readings.

    Raises
    ------
    InvalidQuantity
        If it returns anything else, or a place farther from the block than the block is large, as one in mm is.
    InputError
        As the estimator.
    """
    estimate: Any = estimator.estimate(readings)
    name = f"the estimator {type(estimator).__name__}"
    if not isinstance(estimate, Estimate):
        raise InvalidQuantity(f"{name} returned a {type(estimate).__name__}; needed: an Estimate")
    size = readings.block_size
    for one in estimate.inclusions:
        if (np.abs(np.asarray(one.center) - size / 2) > 1.5 * size).any():
            block = ", ".join(f"{length:g}" for length in size)
            raise InvalidQuantity(f"{name} puts an inclusion at {one.center} m, far from the block of ({block}) m")
    return estimate
