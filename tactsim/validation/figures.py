"""Figures of the validation report from plain data: brackets of runs beside printed numbers, and curves."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from tactsim.errors import UnknownName
from tactsim.plotting.canvas import despined, entitle, new_figure, png, scale_of, styled
from tactsim.units import format_quantity

RUN_COLOUR, PRINTED_COLOURS = "#1f4e79", ("#b8540a", "#8a1c7c", "#2e7d32")
LINE_STYLES = ("C0-", "C1-.", "C2:", "C3--", "C4-", "C5-.", "C6:", "C7--", "C8-", "C9-.")
POINTS_SHOWN = 40


def validation_figure(data: dict[str, Any]) -> bytes:
    """PNG of a figure; ``form`` says which.

    Raises
    ------
    UnknownName
        If no figure has this form.
    """
    forms = {"ranges": ranges_figure, "curves": curves_figure}
    if data["form"] not in forms:
        raise UnknownName("form of a figure", str(data["form"]), forms)
    with styled():
        return png(forms[data["form"]](data))


def ranges_figure(data: dict[str, Any]) -> Figure:
    """One panel per study: a bar from the smallest to the largest value of each run, printed numbers as lines."""
    panels = data["panels"]
    figure = new_figure(2.6 + 3.8 * len(panels), 1.9 + 0.25 * max(len(panel["bars"]) for panel in panels))
    alike = all([bar["label"] for bar in panel["bars"]] == [bar["label"] for bar in panels[0]["bars"]] for panel in panels)
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for place, (axis, panel) in enumerate(zip(axes, panels, strict=True)):
        _draw_ranges(axis, panel, data["unit"])
        axis.set_xlabel(data["axis"])
        axis.tick_params(axis="y", labelleft=place == 0 or not alike)
    entitle(figure, data["title"])
    return figure


def _draw_ranges(axis: Axes, panel: dict[str, Any], unit: str) -> None:
    labels = [bar["label"] for bar in panel["bars"]]
    values = [value for bar in panel["bars"] for value in bar["values"]]
    for place, bar in enumerate(panel["bars"]):
        if bar["values"]:
            ends = min(bar["values"]), max(bar["values"])
            axis.plot(ends, [place, place], "-", color=RUN_COLOUR, linewidth=3, solid_capstyle="butt")
            axis.plot(ends, [place, place], "|", color=RUN_COLOUR, markersize=9)
        else:
            axis.text(0.5, place, "no threshold", transform=axis.get_yaxis_transform(), ha="center", va="center", fontsize=8)
    for line, colour in zip(panel["lines"], PRINTED_COLOURS, strict=False):
        label = f"{line['label']}: {format_quantity(line['value'], unit)}"
        axis.axvline(line["value"], color=colour, linestyle="--", label=label)
    if values:
        axis.axvspan(min(values), max(values), color=RUN_COLOUR, alpha=0.1, zorder=0, label="bracket of all runs, both areas")
    axis.set_xscale("log")
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: format_quantity(float(f"{value:.6g}"), unit)))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_yticks(range(len(labels)), labels)
    axis.invert_yaxis()
    axis.set_title(panel["title"], loc="left")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), fontsize=8)
    despined(axis)


def curves_figure(data: dict[str, Any]) -> Figure:
    """Panels one above the other over the same quantity; ``even_panels`` and ``x_logarithmic`` are optional."""
    panels = data["panels"]
    figure = new_figure(7.0, 4.2 if len(panels) == 1 else 6.0)
    ratios = [1.0 if data.get("even_panels") else 2.2, *[1.0] * (len(panels) - 1)]
    axes = figure.subplots(len(panels), 1, squeeze=False, sharex=True, height_ratios=ratios)[:, 0]
    for axis, panel in zip(axes, panels, strict=True):
        _draw_curves(axis, panel)
    if data.get("x_logarithmic"):
        axes[-1].set_xscale("log")
        axes[-1].xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[0].legend(fontsize=8)
    axes[-1].set_xlabel(" in ".join(part for part in (data["x_axis"], data["x_unit"]) if part))
    entitle(figure, data["title"])
    return figure


def _draw_curves(axis: Axes, panel: dict[str, Any]) -> None:
    largest = max(float(np.abs(curve["y"]).max()) for curve in panel["curves"])
    factor, unit = scale_of(largest, panel["unit"]) if panel["unit"] else (1.0, "")
    styles = iter(LINE_STYLES * len(panel["curves"]))
    for curve in panel["curves"]:
        x, y = np.array(curve["x"]), factor * np.array(curve["y"])
        if curve["style"] == "points":
            axis.plot(x, y, "o", color="0.6", markersize=4, markevery=max(1, x.size // POINTS_SHOWN), label=curve["label"])
        else:
            axis.plot(x, y, next(styles), label=curve["label"])
    axis.set_yscale("log" if panel.get("logarithmic") else "linear")
    if panel.get("logarithmic"):
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        low, high = axis.get_ylim()
        axis.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}") if high < 10 * low else NullFormatter())
    axis.set_ylabel(f"{panel['y_axis']} in {unit}" if unit else panel["y_axis"])
    despined(axis)
