"""The confusion table: how often each class is taken for which."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from tactsim.experiments.localization.scene import ConfusionScene
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import Plot, entitle, new_figure, png, styled
from tactsim.results import Result

DARK = 0.6
"""Share from which a cell is so dark that its number is white."""


class ConfusionFigures(ResultFigures):
    """One figure."""

    kind: Literal["confusion"] = "confusion"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``confusion.png``, if anything was counted."""
        if "confusion" not in result.quantities:
            return {}
        title = f"{result.title or 'Confusion table'}: {result.reason}"
        counts, classes = result.quantities["confusion"].value, result.scene_as(ConfusionScene).classes
        return {"confusion.png": Plot(lambda: confusion_figure(counts, classes, title))}


def confusion_png(table: Sequence[Sequence[int]], classes: Sequence[str], title: str) -> bytes:
    """``confusion_figure`` as PNG."""
    return png(confusion_figure(table, classes, title))


def confusion_figure(table: Sequence[Sequence[int]], classes: Sequence[str], title: str) -> Figure:
    """Counts (true, estimated) in shades of their share of the true class; a true class that does not occur has no row."""
    counts, names = np.array(table), [str(name).replace("_", " ") for name in classes]
    rows = np.flatnonzero(counts.sum(axis=1))
    shares = counts[rows] / counts[rows].sum(axis=1, keepdims=True)
    with styled():
        figure = new_figure(6.4, 1.9 + 0.62 * len(rows))
        axis = figure.subplots()
        axis.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
        for (row, column), share in np.ndenumerate(shares):
            colour = "w" if share > DARK else "k"
            axis.text(column, row, str(counts[rows[row], column]), ha="center", va="center", color=colour, fontsize=12)
        axis.set_xticks(range(len(names)), names)
        axis.set_yticks(range(len(rows)), [names[k] for k in rows])
        axis.set(xlabel="estimated", ylabel="true")
        axis.tick_params(length=0)
        entitle(figure, title, size=10.5)
    return figure
