"""The confusion table: how often each class is taken for which."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.localization.scene import ConfusionScene
from tactsim.plotting.canvas import SMALL_TITLE, SingleFigure, encoded, result_figure, titled_figure
from tactsim.results import Result

DARK = 0.6
"""Share from which a cell is so dark that its number is white."""


class ConfusionFigures(SingleFigure):
    """The table in colours."""

    kind: Literal["confusion"] = "confusion"

    def can_draw(self, result: Result) -> bool:
        """Whether anything was counted."""
        return "confusion" in result.quantities

    def figure(self, result: Result) -> Figure:
        """The table, with the share of what was recognised in its title."""
        counts, classes = np.array(result.quantities["confusion"].value), result.scene_as(ConfusionScene).classes
        with result_figure(result, _size(counts), "Confusion table", remark=result.reason, title_size=SMALL_TITLE) as figure:
            _draw(figure.subplots(), counts, classes)
        return figure


def confusion_png(table: Sequence[Sequence[int]], classes: Sequence[str], title: str) -> bytes:
    """The same as PNG for a table (true, estimated) that is no result."""
    counts = np.array(table)
    with titled_figure(*_size(counts), title, title_size=SMALL_TITLE) as figure:
        _draw(figure.subplots(), counts, classes)
    return encoded(figure)


def _size(counts: Array) -> tuple[float, float]:
    """Width and height in inches: a true class that does not occur has no row."""
    return 6.4, 1.9 + 0.62 * int(counts.any(axis=1).sum())


def _draw(axis: Axes, counts: Array, classes: Sequence[str]) -> None:
    """Counts (true, estimated) in shades of their share of the true class."""
    rows, names = np.flatnonzero(counts.any(axis=1)), [str(name).replace("_", " ") for name in classes]
    shares = counts[rows] / counts[rows].sum(axis=1, keepdims=True)
    axis.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for (row, column), share in np.ndenumerate(shares):
        colour = "w" if share > DARK else "k"
        axis.text(column, row, str(counts[rows[row], column]), ha="center", va="center", color=colour, fontsize=12)
    axis.set_xticks(range(len(names)), names)
    axis.set_yticks(range(len(rows)), [names[k] for k in rows])
    axis.set(xlabel="estimated (colour: share of the true class)", ylabel="true")
    axis.tick_params(length=0)
