"""Elastomers by durometer, hand and sensor: predicted against printed readings, and the ranks side by side."""

from __future__ import annotations

from typing import Literal

import numpy as np
import scipy
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.durometer.elastomers import Elastomer
from tactsim.experiments.durometer.scene import ElastomerRankingScene
from tactsim.plotting.canvas import FAILED_COLOUR, SingleFigure, despined, result_figure
from tactsim.results import Result

LINE_COLOUR = "0.6"
MARKERS = "os^Dv<>P"
KILO = 1e3
NEAR = 4.0
"""Readings this near to each other have their names one above the other."""
BESIDE = 0.08
"""Offset of the names beside the ends of the ranks."""


class ElastomerRankingFigures(SingleFigure):
    """Readings, moduli and ranks."""

    kind: Literal["elastomer_ranking"] = "elastomer_ranking"

    def can_draw(self, result: Result) -> bool:
        """Whether a shape was finished."""
        return _finished(result) > 0

    def figure(self, result: Result) -> Figure:
        """Predicted against printed reading, the two moduli of each elastomer, and the ranks by every test."""
        with result_figure(result, (13.0, 4.6), "Elastomers by durometer, hand and sensor") as figure:
            axes = figure.subplots(1, 3, width_ratios=(1, 1, 1.35))
            colours = colormaps["viridis"](np.linspace(0.0, 0.92, len(_names(result))))
            _draw_readings(axes[0], result, colours)
            _draw_moduli(axes[1], result, colours)
            _draw_ranks(axes[2], result, colours)
        return figure


def _draw_readings(axis: Axes, result: Result, colours: Array) -> None:
    """One marker per shape and elastomer; on the line the durometer would have read what the sensor predicts."""
    printed = np.array([one.durometer for one in _elastomers(result)])
    readings = _by_shape(result, "predicted_reading")
    best = np.nan_to_num(np.fmax.reduce(readings, axis=0))
    top = 1.12 * max(printed.max(), best.max())
    axis.plot([0, top], [0, top], color=LINE_COLOUR, linewidth=0.9)
    for shape, (name, marker) in enumerate(zip(_shapes(result), MARKERS, strict=False)):
        predicted = readings[shape]
        axis.scatter(printed, predicted, c=colours, marker=marker, s=34, edgecolor="0.3", linewidth=0.5, clip_on=False, zorder=3)
        axis.plot([], [], marker, color="0.5", markersize=5, label=name)
    for name, across, up in zip(_names(result), printed, best, strict=True):
        crowded = np.sum((np.abs(printed - across) < NEAR) & (np.abs(best - up) < NEAR) & (printed < across)) % 2
        at, side = (0, 15 if crowded else 6), "left" if across < NEAR / 2 else "center"
        axis.annotate(name, (across, up), at, textcoords="offset points", fontsize=7.5, ha=side)
    short = (printed - readings)[np.isfinite(readings) & (readings > 0)]
    if short.size and (short > 0).all():
        words = f"each prediction is below\nits reading, those above 0\nby {short.min():.0f} to {short.max():.0f}"
        axis.text(0.45, 0.2, words, transform=axis.transAxes, ha="center", va="center", fontsize=8, color="#57606a")
    axis.set(xlabel="printed Shore OO", ylabel="Shore OO predicted from the sensor's threshold", xlim=(0, top), ylim=(0, top))
    axis.set_title("predicted over printed; a reading of 0: bottomed out", loc="left")
    axis.legend(loc="upper left", fontsize=8)
    despined(axis)


def _draw_moduli(axis: Axes, result: Result, colours: Array) -> None:
    """From the modulus of the sensor (left end) to that of the durometer, with every shape a line."""
    from_sensor, from_reading = (_by_shape(result, name) / KILO for name in ("modulus_of_threshold", "modulus_of_reading"))
    names, count = _names(result), len(_shapes(result))
    for shape, marker in zip(range(count), MARKERS, strict=False):
        height = np.arange(len(names)) + 0.22 * (shape - (count - 1) / 2)
        axis.hlines(height, from_sensor[shape], from_reading[shape], color=colours, linewidth=1.2)
        axis.scatter(from_sensor[shape], height, c=colours, marker=marker, s=22, zorder=3)
        hollow = axis.scatter(from_reading[shape], height, marker=marker, s=22, facecolor="white", edgecolor=colours, zorder=3)
        hollow.set_linewidth(1.2)
    axis.set(xscale="log", yticks=range(len(names)), yticklabels=names, xlabel="Young's modulus in kPa")
    axis.invert_yaxis()
    axis.set_title("by the sensor (full), by the durometer (hollow)", loc="left")
    despined(axis)


def _draw_ranks(axis: Axes, result: Result, colours: Array) -> None:
    """Ranks by each test, ties at their mean, joined from test to test."""
    elastomers = _elastomers(result)
    columns = {
        "durometer": np.array([one.durometer for one in elastomers]),
        "hand": np.array([one.hand for one in elastomers]),
        "sensor": np.array([one.threshold_pressure for one in elastomers]),
    }
    for name, values in zip(_shapes(result), _by_shape(result, "predicted_reading"), strict=True):
        columns["predicted,\n" + name.replace(" ", "\n")] = values
    ranks = np.array([scipy.stats.rankdata(values) for values in columns.values()])
    for number, (name, colour) in enumerate(zip(_names(result), colours, strict=True)):
        axis.plot(range(len(columns)), ranks[:, number], "o-", color=colour, markersize=8, linewidth=2)
        axis.text(-2.5 * BESIDE, ranks[0, number], name, ha="right", va="center", color=colour)
    _mark_ties(axis, ranks)
    axis.set(
        xticks=range(len(columns)), xticklabels=columns, yticks=range(1, ranks.shape[1] + 1), xlim=(-1.1, len(columns) - 0.5)
    )
    axis.tick_params(axis="x", labelsize=8, length=0)
    axis.set_ylabel("rank, 1 is the softest")
    axis.set_title("ranks; elastomers that share one lie on each other", loc="left")
    despined(axis)


def _mark_ties(axis: Axes, ranks: Array) -> None:
    """How many elastomers share a rank, beside it."""
    for column, values in enumerate(ranks):
        for rank, count in zip(*np.unique(values, return_counts=True), strict=True):
            if count > 1 and np.isfinite(rank):
                axis.text(column + BESIDE, rank - 0.3, f"{count} tied", fontsize=7.5, color=FAILED_COLOUR)


def _elastomers(result: Result) -> tuple[Elastomer, ...]:
    return result.scene_as(ElastomerRankingScene).elastomers


def _names(result: Result) -> list[str]:
    return [one.name for one in _elastomers(result)]


def _shapes(result: Result) -> list[str]:
    """Names of the shapes of which every elastomer has its step."""
    return [one.name for one in result.scene_as(ElastomerRankingScene).shapes][: _finished(result)]


def _finished(result: Result) -> int:
    """Number of shapes of which every elastomer has its step."""
    return len(result.steps) // max(1, len(_elastomers(result))) if result.steps else 0


def _by_shape(result: Result, name: str) -> Array:
    """A history value, shape (shapes, elastomers); NaN where it is absent."""
    values = result.history_values(name)
    count = len(_elastomers(result))
    return values[: _finished(result) * count].reshape(-1, count)
