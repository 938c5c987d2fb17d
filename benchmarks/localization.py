"""Speed of the three views of two 32 x 32 matrices at 60 x 100 pixels, and of the thesis's estimator; prints JSON."""

from __future__ import annotations

import json
import sys
from functools import partial

import numpy as np
from timing import median_seconds

from tactsim.interfaces.readings import Readings
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.views import SHAPE, views, volume

SIDES = (3, 8, 16, 32)
CALLS = 100


def measure() -> dict[str, float]:
    """Median of 100 calls in seconds by the number of rows and columns of each matrix."""
    generator = np.random.default_rng(1)
    figures: dict[str, float] = {"rows": float(SHAPE[0]), "columns": float(SHAPE[1])}
    for side in SIDES:
        forces = generator.uniform(0.1, 1.0, (2, side, side))
        layout = TaxelLayout(rows=side, columns=side, pitch=30e-3 / side, size=27e-3 / side)
        readings = Readings(forces, layout, np.array([40e-3, 40e-3, 20e-3]))
        figures[f"views_{side}_seconds"] = median_seconds(partial(views, forces), CALLS)
        figures[f"estimate_{side}_seconds"] = median_seconds(partial(ThesisEstimator().estimate, readings), CALLS)
        figures[f"volume_{side}_seconds"] = median_seconds(partial(volume, forces, (20, 40, 40)), CALLS)
    return figures


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured."""
    return [("three views of two 32 x 32 matrices at 60 x 100 pixels", "1 ms", f"{1e3 * taken['views_32_seconds']:.2f} ms")]


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(), indent=2) + "\n")
