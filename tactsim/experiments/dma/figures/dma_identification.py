"""Identification from dynamic mechanical analysis: compliances over the frequency with fits and bands, and the errors below."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from tactsim.array import Array
from tactsim.experiments.dma.figures.signals import signals_figure
from tactsim.experiments.dma.scene import DmaScene
from tactsim.identification.dma_data import PARTS
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import Plot, despined, result_figure
from tactsim.results import Result

METHODS = {"least_squares": ("least squares", "#1f4e79", "-"), "genetic": ("genetic algorithm", "#b8540a", "--")}
PER_MEGAPASCAL = 1e6
DATA_COLOUR, TRUE_COLOUR = "#000000", "#4d9221"
TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500)
"""Frequencies that are labelled, in Hz."""


class DmaIdentificationFigures(ResultFigures):
    """Curves with their bands, and the signals where there are some."""

    kind: Literal["dma_identification"] = "dma_identification"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``dma_identification.png``, unless no fit was made; ``dma_signals.png`` if signals were analysed."""
        drawn: dict[str, Drawing] = {}
        if result.steps:
            drawn["dma_identification.png"] = Plot(lambda: dma_identification_figure(result))
            if result.scene_as(DmaScene).signals:
                drawn["dma_signals.png"] = Plot(lambda: signals_figure(result))
        return drawn


def dma_identification_figure(result: Result) -> Figure:
    """Curves with bands above, relative differences of data and curves from the first fit below."""
    with result_figure(result, (10.0, 6.0), "Generalized Kelvin model from dynamic mechanical analysis") as figure:
        axes = figure.subplots(2, 2, sharex=True, sharey="row", height_ratios=(1.7, 1), squeeze=False)
        for column, part in enumerate(PARTS):
            _draw_curves(axes[0, column], result, part)
            _draw_differences(axes[1, column], result, part)
            axes[1, column].set_xlabel("frequency in Hz")
        axes[0, 0].set_ylabel("compliance in 1/MPa")
        axes[1, 0].set_ylabel(f"relative to {METHODS[_first(result)][0]}, %")
        axes[0, 1].legend(loc="lower left", handlelength=2.6)
        _draw_foot(figure, result)
    return figure


def _first(result: Result) -> str:
    """The method that differences are taken from."""
    return _made(result)[0]


def _made(result: Result) -> list[str]:
    """The methods that the result has curves of."""
    return [method for method in METHODS if f"{method}_elastic_compliance" in result.steps[0].values]


def _draw_curves(axis: Axes, result: Result, part: str) -> None:
    """Data, fits, bands and, of synthetic data, the true curve, in logarithmic axes."""
    frequency = result.history_values("frequency")
    for order, method in enumerate(_made(result)):
        words, colour, line = METHODS[method]
        lower, centre, upper = (
            PER_MEGAPASCAL * result.history_values(f"{method}_{part}_compliance{end}") for end in ("_lower", "", "_upper")
        )
        axis.fill_between(
            frequency, lower, upper, color=colour, alpha=0.22, linewidth=0, zorder=2 - order, label=_band(result, method)
        )
        axis.plot(frequency, centre, line, color=colour, zorder=4 + order, label=words)
    true = result.history_values(f"true_{part}_compliance")
    synthetic = bool(np.isfinite(true).any())
    if synthetic:
        axis.plot(frequency, PER_MEGAPASCAL * true, ":", color=TRUE_COLOUR, zorder=6, label="true model")
    measured = PER_MEGAPASCAL * result.history_values(f"measured_{part}_compliance")
    words = "synthetic data" if synthetic else "data"
    axis.plot(frequency, measured, "o", color=DATA_COLOUR, markersize=4, zorder=7, label=words)
    axis.set(xscale="log", yscale="log")
    axis.set_title(f"{part} compliance", loc="left")
    axis.xaxis.set_major_locator(FixedLocator([tick for tick in TICKS if frequency.min() <= tick <= frequency.max()]))
    for which in (axis.xaxis, axis.yaxis):
        which.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    despined(axis)


def _band(result: Result, method: str) -> str:
    """The label of a band."""
    fit = result.scene_as(DmaScene).fits[method]
    return f"{METHODS[method][0]}, {100 * fit.confidence:.3g} % band, {fit.band}"


def _draw_differences(axis: Axes, result: Result, part: str) -> None:
    """Relative differences in percent from the first fit, whose band is then symmetric about zero."""
    frequency = result.history_values("frequency")
    reference = result.history_values(f"{_first(result)}_{part}_compliance")

    def percent(name: str) -> Array:
        return 100 * (result.history_values(name) / reference - 1)

    for order, method in enumerate(_made(result)):
        _, colour, line = METHODS[method]
        name = f"{method}_{part}_compliance"
        axis.fill_between(
            frequency, percent(f"{name}_lower"), percent(f"{name}_upper"), color=colour, alpha=0.22, linewidth=0, zorder=2 - order
        )
        axis.plot(frequency, percent(name), line, color=colour, zorder=4 + order)
    axis.plot(frequency, percent(f"true_{part}_compliance"), ":", color=TRUE_COLOUR, zorder=6)
    axis.plot(frequency, percent(f"measured_{part}_compliance"), "o", color=DATA_COLOUR, markersize=4, zorder=7)
    despined(axis)


def _draw_foot(figure: Figure, result: Result) -> None:
    """How many constants the data determine; the mark of a run that did not end well takes its place."""
    combinations = result.quantities.get("determined_combinations")
    if combinations is not None:
        words = f"the data determine {combinations.value} {combinations.description.removesuffix(' that the data determine')}"
        figure.supxlabel(words, x=0.01, ha="left", fontsize=8.5)
