"""Timed indentation: the deformed section, and force, displacement and the difference from the closed form over time."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.indentation.figures.contact_section import draw_contact_section
from tactsim.experiments.indentation.figures.indentation import PressedFigures
from tactsim.experiments.indentation.scene import TimedIndentationScene
from tactsim.plotting.canvas import despined, result_figure, scale_of
from tactsim.results import Result

COMPUTED_COLOUR, CLOSED_COLOUR = "#1f4e79", "#b8540a"
HISTORIES = (("reaction_force", "force", "N"), ("displacement", "displacement", "m"))
ROOM = 0.06
"""Part of an axis above its largest value, so that a force that is constant is not drawn on its end."""
DECADES = 1e3
"""Time is drawn on a logarithmic scale when half of the steps end before this part of the whole."""


class TimedIndentationFigures(PressedFigures):
    """Section beside the histories."""

    kind: Literal["timed_indentation"] = "timed_indentation"

    def figure(self, result: Result) -> Figure:
        """Section (if the result has fields) and histories of a timed indentation."""
        last, has_section = result.steps[-1].values, bool(result.frames)
        compared = "closed_form_difference" in last
        size, where = (11.0 if has_section else 6.0, 5.6 if compared else 4.6), f" at {last['time']:.4g} s"
        with result_figure(result, size, _title(result), where=where) as figure:
            rows = len(HISTORIES) + compared
            grid = figure.add_gridspec(rows, 1 + has_section, width_ratios=(1.3, 1) if has_section else None)
            if has_section:
                draw_contact_section(figure.add_subplot(grid[:, 0]), result, last["displacement"])
            axes = [figure.add_subplot(grid[row, -1]) for row in range(rows)]
            for axis, (name, words, unit) in zip(axes, HISTORIES, strict=False):
                _draw_history(axis, result, name, words, unit)
            if compared:
                _draw_difference(axes[-1], result)
            axes[-1].set_xlabel("time in s")
            for axis in axes[:-1]:
                axis.tick_params(labelbottom=False)
        return figure


def _title(result: Result) -> str:
    scene = result.scene_as(TimedIndentationScene)
    return f"Prescribed {scene.control} on a rigid {scene.body.kind}"


def _draw_history(axis: Axes, result: Result, name: str, words: str, unit: str) -> None:
    time, values = result.history_values("time"), result.history_values(name)
    factor, prefixed = scale_of(float(np.abs(values).max()), unit)
    axis.plot(time, factor * values, ".-", color=COMPUTED_COLOUR, markersize=4, linewidth=1, label="finite elements")
    other = "closed_form_force" if name == "reaction_force" else "closed_form_displacement"
    if other in result.steps[-1].values:
        axis.plot(time, factor * result.history_values(other), "--", color=CLOSED_COLOUR, label="closed form")
        axis.legend(fontsize=8)
    axis.set_ylabel(f"{words}\nin {prefixed}")
    _scale_time(axis, time)
    positive = values[values > 0]
    if axis.get_xscale() == "log" and positive.size and values.min() >= 0 and positive.max() > DECADES * positive.min():
        axis.set_yscale("log")
    else:
        bottom, top = min(0.0, float(factor * values.min())), axis.get_ylim()[1]
        axis.set_ylim(bottom, top + ROOM * (top - bottom))
    despined(axis)


def _draw_difference(axis: Axes, result: Result) -> None:
    time, difference = result.history_values("time"), 100 * result.history_values("closed_form_difference")
    axis.plot(time, difference, ".-", color=COMPUTED_COLOUR, markersize=4, linewidth=1)
    axis.axhline(0.0, color="0.5", linewidth=0.7)
    widest = max(1.2 * float(np.nanmax(np.abs(difference))), 1e-6)
    axis.set_ylim(-widest, widest)
    axis.set_ylabel("difference from\nclosed form in %")
    _scale_time(axis, time)
    despined(axis)


def _scale_time(axis: Axes, time: Array) -> None:
    """A logarithmic axis where most of what happens is early."""
    later = time[time > 0]
    if later.size and np.median(later) < later.max() / DECADES**0.5:
        axis.set_xscale("log")
    else:
        axis.set_xlim(0, float(time.max()))
