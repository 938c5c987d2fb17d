"""The forms of figures from plain data: brackets of runs beside printed numbers, curves, maps, pictures, surfaces, sections."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from tactsim.errors import UnknownName
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import (
    PRESSURE_COLOURS,
    despined,
    encoded,
    entitle,
    new_figure,
    scale_of,
    styled,
    weighted_percentiles,
)
from tactsim.units import format_quantity

RUN_COLOUR, PRINTED_COLOURS = "#1f4e79", ("#b8540a", "#8a1c7c", "#2e7d32")
LINE_STYLES = ("C0-", "C1-.", "C2:", "C3--", "C4-", "C5-.", "C6:", "C7--", "C8-", "C9-.")
POINTS_SHOWN, FEW_POINTS = 40, 12
"""About how many points of a curve of points are drawn, and up to how many those of a line, straight between them, are marked."""
MARKERS = ("o", "s", "^", "v", "D")
LETTERS_OF_TITLE, LETTERS_OF_LEGEND = 11.5, 15.0  # letters in an inch
LETTERS_BESIDE = 30
"""Letters in a line beside a panel; there may be two panels, one above the other."""
SHOWN_REACH = 2.4
"""Radius up to which a section is shown, in radii of the body: farther out the tissue is at rest."""


def validation_figure(data: dict[str, Any]) -> bytes:
    """PNG of a figure from its plain data, whose ``form`` says how it is drawn.

    Raises
    ------
    UnknownName
        If no figure has this form.
    """
    forms = {
        "ranges": ranges_figure,
        "curves": curves_figure,
        "maps": maps_figure,
        "images": images_figure,
        "surfaces": surfaces_figure,
        "sections": sections_figure,
    }
    if data["form"] not in forms:
        raise UnknownName("form of a figure", str(data["form"]), forms)
    with styled():
        return encoded(forms[data["form"]](data))


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
    write_title(figure, data["title"])
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
            axis.text(0.5, place, "failed", transform=axis.get_yaxis_transform(), ha="center", va="center", fontsize=8)
    for place in np.cumsum(panel.get("groups", ()))[:-1]:
        axis.axhline(place - 0.5, color="0.7", linewidth=0.6)
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
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14 * 14 / max(len(labels), 14)), fontsize=8)
    despined(axis)


def curves_figure(data: dict[str, Any]) -> Figure:
    """Panels one above the other over the same quantity; ``even_panels`` and ``x_logarithmic`` are optional."""
    panels = data["panels"]
    figure = new_figure(7.0, 4.2 if len(panels) == 1 else 6.0)
    ratios = [1.0 if data.get("even_panels") else 2.2, *[1.0] * (len(panels) - 1)]
    axes = figure.subplots(len(panels), 1, squeeze=False, sharex=True, height_ratios=ratios)[:, 0]
    factor, unit = _scale_along(panels, data["x_unit"])
    for place, (axis, panel) in enumerate(zip(axes, panels, strict=True)):
        _draw_curves(axis, panel, factor)
        labels = [curve["label"] for curve in panel["curves"]]
        if place == 0 or not set(labels) <= {curve["label"] for curve in panels[0]["curves"]}:
            columns = max(1, min(len(labels), int(LETTERS_OF_LEGEND * figure.get_figwidth() / (max(map(len, labels)) + 8))))
            axis.legend(fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)  # above: over no curve
    if data.get("x_logarithmic"):
        axes[-1].set_xscale("log")
        axes[-1].xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[-1].set_xlabel(" in ".join(part for part in (data["x_axis"], unit) if part))
    write_title(figure, data["title"])
    return figure


def _scale_along(panels: Sequence[dict[str, Any]], unit: str) -> tuple[float, str]:
    """Factor and unit of the horizontal axis: a prefix where everything is small, such as mm."""
    largest = max(float(np.abs(curve["x"]).max()) for panel in panels for curve in panel["curves"])
    return scale_of(largest, unit) if unit and largest < 1 else (1.0, unit)


def _draw_curves(axis: Axes, panel: dict[str, Any], along: float) -> None:
    largest = max(float(np.abs(curve["y"]).max()) for curve in panel["curves"])
    factor, unit = scale_of(largest, panel["unit"]) if panel["unit"] else (1.0, "")
    styles = iter(LINE_STYLES * len(panel["curves"]))
    count = sum(curve["style"] == "points" for curve in panel["curves"])
    points = iter([(MARKERS[k % len(MARKERS)], f"C{k}" if count > 1 else "0.6") for k in range(count)])
    for curve in panel["curves"]:
        x, y = along * np.array(curve["x"]), factor * np.array(curve["y"])
        if curve["style"] == "points":
            marker, colour = next(points)  # the colours of the lines, in the same order
            every = max(1, x.size // POINTS_SHOWN)
            axis.plot(x, y, marker, color=colour, markersize=4, markevery=every, label=curve["label"])
        else:
            axis.plot(x, y, next(styles), marker="." if x.size <= FEW_POINTS else "", label=curve["label"])
    axis.set_yscale("log" if panel.get("logarithmic") else "linear")
    if panel.get("logarithmic"):
        label_decades(axis)
    axis.set_ylabel(textwrap.fill(f"{panel['y_axis']} in {unit}" if unit else panel["y_axis"], LETTERS_BESIDE))
    despined(axis)


def maps_figure(data: dict[str, Any]) -> Figure:
    """Two rows of matrices with the force on each taxel, upper jaw above; each column has colours of its own from zero on."""
    columns = data["columns"]
    figure = new_figure(1.0 + 1.75 * len(columns), 4.4)
    axes = figure.subplots(len(JAWS), len(columns), squeeze=False)
    for place, column in enumerate(columns):
        largest = max(float(np.max(column[side])) for side in JAWS)
        for axis, side in zip(axes[:, place], JAWS, strict=True):
            forces = np.array(column[side])
            rows, width = forces.shape
            axis.imshow(
                forces, origin="lower", cmap=PRESSURE_COLOURS, vmin=0.0, vmax=largest, extent=(0.5, width + 0.5, 0.5, rows + 0.5)
            )
            for (row, number), force in np.ndenumerate(forces):
                colour = "white" if force < 0.6 * largest else "black"
                axis.text(number + 1, row + 1, f"{force:.3g}", ha="center", va="center", fontsize=7, color=colour)
            axis.set_xticks(range(1, width + 1))
            axis.set_yticks(range(1, rows + 1))
        axes[0, place].set_title(column["title"], fontsize=9)
    for axis, side in zip(axes[:, 0], JAWS, strict=True):
        axis.set_ylabel(f"{side} jaw, row")
    write_title(figure, f"{data['title']} in {data['unit']}; colours from 0 to the largest of each column")
    return figure


def images_figure(data: dict[str, Any]) -> Figure:
    """Grey pictures one above the other, as Appendix A draws them: black without signal, white at the normalising one."""
    panels = data["panels"]
    heights = [1.0 if np.ndim(panel["grey"]) == 1 else 2.4 for panel in panels]
    figure = new_figure(7.0, 0.8 + sum(heights))
    axes = figure.subplots(len(panels), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axis, panel in zip(axes, panels, strict=True):
        grey = np.atleast_2d(np.array(panel["grey"], dtype=float))
        axis.imshow(
            grey, cmap="gray", vmin=0, vmax=255, aspect="auto", interpolation="nearest", extent=(0.5, grey.shape[1] + 0.5, 0, 1)
        )
        axis.set_yticks([])
        axis.set_title(panel["title"], fontsize=9, loc="left")
    axes[-1].set_xlabel(data["axis"])
    write_title(figure, data["title"])
    return figure


def surfaces_figure(data: dict[str, Any]) -> Figure:
    """A value over two axes, a panel in 3D for each surface."""
    panels = data["panels"]
    x, y = np.meshgrid(data["x"], data["y"])
    figure = new_figure(1.0 + 4.6 * len(panels), 4.6)
    for place, panel in enumerate(panels, 1):
        axis: Any = figure.add_subplot(1, len(panels), place, projection="3d")
        z = np.array(panel["z"])
        factor, unit = scale_of(float(np.abs(z).max()), data["unit"])
        axis.plot_surface(x, y, factor * z, cmap=PRESSURE_COLOURS, linewidth=0, rcount=len(x), ccount=len(x))
        axis.set(xlabel=data["x_axis"], ylabel=data["y_axis"], zlabel=f"{data['z_axis']} in {unit}", title=panel["title"])
    write_title(figure, data["title"])
    return figure


def sections_figure(data: dict[str, Any]) -> Figure:
    """Deformed sections in mm in the colours of an element's value, with lines of the body; each panel has colours of its own."""
    panels = data["panels"]
    figure = new_figure(1.0 + 4.6 * len(panels), 3.9)
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for axis, panel in zip(axes, panels, strict=True):
        points, triangles = 1e3 * np.array(panel["points"]), np.array(panel["triangles"])
        corners = points[triangles]
        (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        lines = 1e3 * np.array(panel["lines"])
        reach = SHOWN_REACH * lines[..., 0].max()
        seen = corners[..., 0].max(axis=1) <= max(reach, corners[..., 0].min())
        values = np.array(panel["values"])
        low, high = weighted_percentiles(values[seen], np.abs(ax * by - ay * bx)[seen], (1, 99))
        factor, unit = scale_of(max(abs(low), abs(high)), data["unit"])
        style: dict[str, Any] = {"cmap": PRESSURE_COLOURS, "vmin": factor * low, "vmax": factor * high, "rasterized": True}
        drawn = axis.tripcolor(*points.T, triangles=triangles, facecolors=factor * values, **style)
        for line, colour in zip(lines, ("k", "#d62728"), strict=False):
            axis.plot(*line.T, color=colour, linewidth=2)
        axis.set(xlim=(0, min(reach, points[:, 0].max())), aspect="equal", xlabel="radius in mm", ylabel="height in mm")
        axis.set_title(panel["title"], loc="left", fontsize=9)
        label = f"{data['label']} in {unit}\n(colours: 1st to 99th percentile of the area)"
        figure.colorbar(drawn, ax=axis, location="bottom", extend="both", label=label)
        despined(axis)
    write_title(figure, data["title"])
    return figure


def write_title(figure: Figure, title: str) -> None:
    """Writes the title above a figure, in two lines if one is too short."""
    first, *rest = textwrap.wrap(title, int(LETTERS_OF_TITLE * figure.get_figwidth()))
    entitle(figure, first, " ".join(rest))


def label_decades(axis: Axes) -> None:
    """Plain numbers along a logarithmic vertical axis, between the decades too where there are less than two."""
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    some = FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else "")
    low, high = axis.get_ylim()
    axis.yaxis.set_major_formatter(plain)
    axis.yaxis.set_minor_formatter(plain if high < 10 * low else some if high < 100 * low else NullFormatter())
