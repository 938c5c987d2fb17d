"""Voltages of both matrices over time, and the forces read from them beside those applied."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, VOLTAGE, jaws_at_end, jaws_over_time
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import Plot, despined, result_figure, scale_of
from tactsim.results import Result

VOLTAGES = "taxel_voltages.png"
MOST_NAMED = 16
"""Taxels of a matrix up to which each curve is named."""
MOST_DOTTED = 40
"""Solved steps up to which each is drawn as a dotted line: more would be a grey ground."""
NAMES_IN_A_LINE, LINE_OF_NAMES = 3, 0.065
"""Of the taxels, and the height of such a line over that of the axes: curves that rise at once would run through the names."""
READ, APPLIED = "#1f4e79", "#b8540a"


class MatrixReadoutFigures(ResultFigures):
    """The voltages."""

    kind: Literal["matrix_readout"] = "matrix_readout"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``taxel_voltages.png``."""
        return {VOLTAGES: Plot(lambda: voltages_figure(result))}


def voltages_figure(result: Result) -> Figure:
    """Upper jaw in the upper row: its voltages over time, and the force of each taxel at the end, read and applied.

    Raises
    ------
    InputError
        If the result does not hold voltages and forces of taxels as numbers in arrays of one shape.
    """
    with result_figure(result, (10.5, 6.4), "Voltages of the matrices") as figure:
        axes: Any = figure.subplots(2, 2, width_ratios=(1.5, 1), sharex="col", sharey="col")
        voltages = jaws_over_time(result, VOLTAGE)
        applied, read = (jaws_at_end(result, name) for name in (TAXEL_FORCE, READ_FORCE))
        factor, unit = scale_of(float(voltages.max()), "V")
        for jaw, (row, side) in enumerate(zip(axes, JAWS, strict=True)):
            _draw_voltages(row[0], result, factor * voltages[:, jaw])
            _draw_forces(row[1], applied[jaw], read[jaw])
            row[0].set_ylabel(f"voltage in {unit}")
            row[0].set_title(f"{side} jaw; straight between {_solved(result)}", loc="left")
        axes[1, 0].set_xlabel("time in s")
        axes[1, 1].set_xlabel("taxel, row and column")
        if (names := applied[0].size) <= MOST_NAMED:
            _make_room(axes[0, 0], LINE_OF_NAMES * (2 + math.ceil(names / NAMES_IN_A_LINE)))  # with a title
        _make_room(axes[0, 1], 2 * LINE_OF_NAMES)
        axes[0, 1].legend(loc="upper right", ncols=2)
        for axis in axes.flat:
            despined(axis)
    return figure


def _make_room(axis: Axes, share: float) -> None:
    """A share of the height above what is drawn, for a legend."""
    low, high = axis.get_ylim()
    axis.set_ylim(low, low + (high - low) / (1 - share))


def _solved(result: Result) -> str:
    """The solved steps in words; of a stored grasp that is read once more, whose history holds readings, without their number."""
    if len(result.steps) == len(result.quantities["readout_time"].numbers):
        return "the solved steps of the grasp"
    return f"the {len(result.steps)} solved steps{' (dotted)' if len(result.steps) <= MOST_DOTTED else ''}"


def _draw_voltages(axis: Axes, result: Result, voltage: Array) -> None:
    time, (rows, columns) = result.quantities["readout_time"].numbers, voltage.shape[1:]
    colours = colormaps["viridis"](np.linspace(0, 0.9, rows * columns))
    for (row, column), colour in zip(np.ndindex(rows, columns), colours, strict=True):
        style = ("-", "--", "-.", ":")[column % 4]
        axis.plot(time, voltage[:, row, column], style, color=colour, linewidth=1.0, label=f"{row + 1},{column + 1}")
    for moment in result.history_values("time") if len(result.steps) <= MOST_DOTTED else ():
        axis.axvline(moment, color="0.6", linewidth=0.7, linestyle=":", zorder=0)
    if rows * columns <= MOST_NAMED:
        axis.legend(loc="upper left", ncols=NAMES_IN_A_LINE, title="row, column", fontsize=7, title_fontsize=7)


def _draw_forces(axis: Axes, applied: Array, read: Array) -> None:
    places = np.arange(applied.size)
    axis.bar(places, applied.ravel(), width=0.8, color="#fdd0a2", edgecolor=APPLIED, linewidth=0.6, label="applied")
    axis.plot(places, read.ravel(), "o", color=READ, markersize=4, label="read")
    axis.set_ylabel("force at the end in N")
    axis.set_title("applied and read", loc="left")
    if applied.size <= MOST_NAMED:
        axis.set_xticks(places, [f"{row + 1},{column + 1}" for row, column in np.ndindex(*applied.shape)], fontsize=7)
    else:
        axis.set_xticks([])
