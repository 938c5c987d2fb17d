"""What each taxel reads, as numbers on small maps of both matrices: what the three views are made of."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Normalize

from tactsim.experiments.grasp.figures.viewed import ViewedGrasp
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import PRESSURE_COLOURS, ink_on, scale_of, with_minus

PLACES = ((0.0, 0.0), (0.5, 0.0))
"""Lower left corners of the two maps in the axes."""
SIDE, LARGEST, SMALLEST = 0.38, 9.0, 4.5
"""Side of a map over that of the axes, and sizes of the letters in points."""
DIGITS = 5
"""Of the largest number, down to which the others are given: round-off is 0, and no number is wider than its taxel."""


def draw_taxel_numbers(axis: Axes, grasp: ViewedGrasp) -> None:
    """Both matrices in the lower half of empty axes, row 1 at the bottom as in the top view."""
    largest = max(float(grasp.signal.max()), 1e-12)
    (factor, unit), norm = scale_of(largest, "N"), Normalize(min(0.0, float(grasp.signal.min())), largest)
    colours, count = colormaps[PRESSURE_COLOURS], max(grasp.signal.shape[1:])
    decimals = DIGITS - 1 - int(np.floor(np.log10(factor * max(largest, -float(grasp.signal.min())))))
    size = float(np.clip(27 / count, SMALLEST, LARGEST))
    for side, place, signal in zip(JAWS, PLACES, grasp.signal, strict=True):
        small: Any = axis.inset_axes((*place, SIDE, SIDE))
        small.imshow(signal, cmap=PRESSURE_COLOURS, norm=norm, origin="lower")
        small.set_anchor("N")
        for (row, column), value in np.ndenumerate(signal):
            style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": size, "color": ink_on(colours(norm(value)))}
            small.text(column, row, with_minus(f"{round(factor * value, decimals) + 0.0:.3g}"), in_layout=False, **style)
        small.set_xticks(range(signal.shape[1]), [f"{k + 1}" for k in range(signal.shape[1])], fontsize=7)
        small.set_yticks(range(signal.shape[0]), [f"{k + 1}" for k in range(signal.shape[0])], fontsize=7)
        small.tick_params(length=0)
        small.set_xlabel("column", fontsize=8)
        small.set_ylabel("row" if side == JAWS[0] else "", fontsize=8)
        small.set_title(f"{side} jaw in {unit}", loc="left", fontsize=8.5)
        small.spines[:].set_visible(False)
    words = f"what each taxel reads: {grasp.meaning}"
    axis.text(0.0, SIDE + 0.07, words, transform=axis.transAxes, va="bottom", fontsize=8.5)
