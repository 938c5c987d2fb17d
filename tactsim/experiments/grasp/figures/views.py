"""Front, left and top view of a grasp as colour images, in third-angle projection, with the true and estimated inclusions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import LETTERS, drawn_millimetre, moment_of, named_lines
from tactsim.experiments.grasp.figures.taxel_numbers import draw_taxel_numbers
from tactsim.experiments.grasp.figures.viewed import ViewedGrasp, estimated_bodies, outline
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.localization.views import SHAPE, views
from tactsim.plotting.canvas import PRESSURE_COLOURS, despined, result_figure, scale_of
from tactsim.results import Result

VIEWS = "views.png"
JAW, NUMBER, ROOM = 1.2, 0.3, 1.0
"""Thickness with which a jaw is drawn, room for the numbers on it, and room around the drawing, in `drawn_millimetre`."""
WIDTH, SURROUNDINGS = 10.4, 2.2
"""Width in inches of the figure, and height of its title, ticks and scales of colours."""
COLUMN, TOP_ROW, LOWER_ROW, HIGHEST = 3.9, 4.1, 1.4, 8.0
"""Width in inches of each column of pictures, height of the upper row, which the words beside it need, and least and largest
height of the lower row.
"""
MOST_INTERVALS = 5
"""Most intervals between the ticks of an axis or of the colours."""
REGION_DASHES: Any = (0, (1.5, 1.5))
"""Of the line around where an estimated centre may lie."""
INK, GREY = "#30363d", "#57606a"
ESTIMATE = "#d1242f"
MOST_NAMED, NAME = 8, 0.42
"""Taxels along a jaw up to which they are numbered, and the least pitch in inches at which each has its name in the top view."""

BEYOND = JAW + NUMBER + ROOM
"""Room above and below the block in the views that show the jaws, in `drawn_millimetre`."""
NUMBERS_TOP, LINE_HEIGHT, CLOSEST = 0.5, 0.041, 0.75
"""Top of the numbers of the taxels and height of a line of the findings, over the height of the axes, and the least part of that
height on which lines stay apart; beyond it the letters shrink.
"""


@dataclass(frozen=True, eq=False)
class View:
    """One view.

    Attributes
    ----------
    image : (M, N) in N, row 0 at the top
    away : axis along which it looks
    horizontal, vertical : axes of the picture
    factor, unit : from N to the unit in which all views show forces: 0.9 N in one and 900 mN in the next look unlike
    """

    image: Array
    away: int
    horizontal: int
    vertical: int
    what: str
    factor: float
    unit: str


def colour_table(levels: int) -> list[int]:
    """Red, green and blue, each from 0 to 255, of evenly spaced levels of the colour map, one after another."""
    return np.round(255 * colormaps[PRESSURE_COLOURS](np.arange(levels))[:, :3]).astype(int).ravel().tolist()


def views_figure(result: Result, grasp: ViewedGrasp) -> Figure:
    """The top view above the front view, the left view beside it; every picture has its colours. Between two arrays of sensors
    a picture rises to the sum of both (eq. .2.7), so that no colour is the mean pressure on a number of taxels.

    The lower middle output of the left view is the sum of row 2 of the lower matrix; section 6.3.1 prints that of row 1 (L1,1 +
    L1,2 + L1,3), while its upper left output is row 3 and Fig. 6.3c has one output per row.
    """
    pictures = views(grasp.signal, SHAPE)
    shown = scale_of(max(float(image.max()) for image in (pictures.front, pictures.left, pictures.top)), "N")
    front = View(pictures.front, 1, 0, 2, "front view: sums over the rows", *shown)
    left = View(pictures.left, 0, 1, 2, "left view: sums over the columns", *shown)
    top = View(pictures.top, 2, 0, 1, "top view: sums of both jaws", *shown)
    x, y, z = 1e3 * grasp.scene.size / drawn_millimetre(grasp.scene.size)
    scale = COLUMN / max(x, y)
    heights = max(TOP_ROW, scale * (y + 2 * ROOM)), float(np.clip(scale * (z + 2 * BEYOND), LOWER_ROW, HIGHEST))
    size, moment = (WIDTH, SURROUNDINGS + sum(heights)), moment_of(result)
    with result_figure(result, size, "Three views of the grasp", below=moment) as figure:
        axes: Any = figure.subplots(2, 2, height_ratios=heights)
        seen = {axes[1, 1]: front, axes[1, 0]: left, axes[0, 1]: top}
        for axis, view in seen.items():
            _draw(axis, view, grasp)
        axes[1, 0].invert_xaxis()
        _legend(axes[0, 0], grasp)
    return figure


def _draw(axis: Axes, view: View, grasp: ViewedGrasp) -> None:
    """The picture of a view."""
    norm = Normalize(0.0, max(view.factor * float(view.image.max()), 1e-12))
    extent = _extent(view, grasp)
    colours: dict[str, Any] = {"cmap": PRESSURE_COLOURS, "norm": norm}
    axis.imshow(view.factor * view.image, **colours, extent=extent, origin="upper", interpolation="nearest", zorder=1)
    across, up = (_edges(view, grasp, extent, k) for k in (0, 1))
    rim = [(int(len(edges) > count + 1),) * 2 for edges, count in zip((up, across), view.image.shape, strict=True)]
    axis.pcolormesh(across, up, view.factor * np.pad(view.image, rim, mode="edge"), **colours, rasterized=True, zorder=0.9)
    size = 1e3 * grasp.scene.size
    unknown: dict[str, Any] = {"facecolor": "#eceef0", "edgecolor": "#c3c8ce", "hatch": "////", "linewidth": 0.0, "zorder": 0.5}
    axis.add_patch(Rectangle((0, 0), size[view.horizontal], size[view.vertical], **unknown))
    block = Rectangle((0, 0), size[view.horizontal], size[view.vertical], fill=False, edgecolor=GREY, linewidth=0.8, zorder=3)
    block.set_linestyle((0, (4, 3)))
    axis.add_patch(block)
    if view.away == 2:
        _draw_taxels(axis, grasp)
    else:
        _draw_jaws(axis, view, grasp)
    for body in grasp.true:
        first, second, distance = outline(body, grasp.scene.size, view.away)
        axis.contour(first, second, distance, levels=[0.0], colors=["w"], linewidths=2.6, zorder=5)
        axis.contour(first, second, distance, levels=[0.0], colors=["k"], linewidths=1.1, linestyles="--", zorder=6)
    _draw_estimates(axis, view, grasp)
    unit = drawn_millimetre(grasp.scene.size)
    room, beyond = ROOM * unit, (BEYOND if view.away != 2 else ROOM) * unit
    low_x, high_x = min(0.0, extent[0]), max(size[view.horizontal], extent[1])
    axis.set(xlim=(low_x - room, high_x + room), ylim=(-beyond, size[view.vertical] + beyond), aspect="equal")
    right, above = (f"{'xyz'[along]} in mm" for along in (view.horizontal, view.vertical))
    axis.set(xlabel=f"{right} (undeformed)", ylabel=above)
    axis.locator_params(nbins=MOST_INTERVALS)
    axis.set_title(view.what, loc="left")
    despined(axis)
    _draw_scale(axis, view, grasp, norm)
    axis.set_anchor("SE" if view.away == 2 else "N")  # between the rows, whose words the layout then gives room; undoes a scale's


def _draw_scale(axis: Axes, view: View, grasp: ViewedGrasp, norm: Normalize) -> None:
    """The colours of a view."""
    location = "right" if view.away == 2 else "bottom"
    bar = axis.figure.colorbar(
        ScalarMappable(norm, PRESSURE_COLOURS), ax=axis, location=location, aspect=30, pad=0.02, shrink=0.85
    )
    bar.locator = MaxNLocator(nbins=MOST_INTERVALS)
    bar.update_ticks()
    cut = "\nreadings below 0 count as 0" if (grasp.signal < 0).any() else ""
    bar.set_label(f"{grasp.meaning} in {view.unit}{cut}")
    bar.outline.set_linewidth(0.5)


def _extent(view: View, grasp: ViewedGrasp) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of the image in mm: the outermost pixels stand at the outermost taxels' centres.

    A single row or column has the width of its taxels.
    """
    sides = []
    for axis, pixels in ((view.horizontal, view.image.shape[1]), (view.vertical, view.image.shape[0])):
        if axis == 2:
            sides += [0.0, 1e3 * float(grasp.scene.size[2])]
            continue
        borders = grasp.scene.borders("xy"[axis])
        centres = borders.mean(axis=1)
        half = (centres[-1] - centres[0]) / (pixels - 1) / 2
        sides += [centres[0] - half, centres[-1] + half] if len(centres) > 1 else list(borders[0])
    if view.horizontal == 1:
        sides[:2] = sides[1::-1]
    return sides[0], sides[1], sides[2], sides[3]


def _edges(view: View, grasp: ViewedGrasp, extent: tuple[float, float, float, float], along: int) -> np.ndarray:
    """Borders in mm of the columns (0) or rows (1) of the image, with the outer halves of the outer taxels as one more each."""
    first, last = (extent[0], extent[1]) if along == 0 else (extent[3], extent[2])
    edges = np.linspace(first, last, view.image.shape[1 - along] + 1)
    axis = (view.horizontal, view.vertical)[along]
    if axis == 2:
        return edges
    borders = grasp.scene.borders("xy"[axis])
    outer = (borders[0, 0], borders[-1, 1]) if first < last else (borders[-1, 1], borders[0, 0])
    return np.concatenate([[outer[0]], edges, [outer[1]]]) if len(borders) > 1 else edges


def _draw_taxels(axis: Axes, grasp: ViewedGrasp) -> None:
    """Thin borders of the taxels, hatched where one of a place is interpolated."""
    columns, rows = grasp.scene.borders("x"), grasp.scene.borders("y")
    side, valid = 1e3 * grasp.scene.matrix.size, grasp.valid.all(axis=0)
    places = [(columns[column, 0], rows[row, 0]) for row, column in np.ndindex(len(rows), len(columns))]
    squares = [Rectangle(corner, side, side) for corner in places]
    none: dict[str, Any] = {"facecolor": "none", "edgecolor": INK, "linewidth": 0.5, "zorder": 4}
    axis.add_collection(PatchCollection(squares, facecolor="none", edgecolor="w", linewidth=1.4, zorder=3.5, alpha=0.7))
    for chosen, hatch in ((valid.ravel(), None), (~valid.ravel(), "xxx")):
        axis.add_collection(PatchCollection([squares[k] for k in np.flatnonzero(chosen)], hatch=hatch, **none))
    if max(valid.shape) <= MOST_NAMED:
        beside = 0.8 * drawn_millimetre(grasp.scene.size)
        named: dict[str, Any] = {"fontsize": 7, "color": GREY, "zorder": 9}
        named["bbox"] = {"boxstyle": "round,pad=0.1", "facecolor": "w", "edgecolor": "none", "alpha": 0.8}
        every = COLUMN / float(np.max(grasp.scene.size)) * grasp.scene.matrix.pitch > NAME
        for number in named_lines(len(rows), every=every):
            axis.text(columns[-1, 1] + beside, rows[number - 1].mean(), f"row {number}", ha="left", va="center", **named)
        for number in named_lines(len(columns), every=every):
            axis.text(columns[number - 1].mean(), rows[-1, 1] + beside, f"col. {number}", ha="center", va="bottom", **named)


def _draw_jaws(axis: Axes, view: View, grasp: ViewedGrasp) -> None:
    """Both jaws with the sums of their taxels in colours of their own scale, numbered as in thesis Fig. 6.3."""
    along, summed = ("x", 1) if view.horizontal == 0 else ("y", 2)
    sums, missing = grasp.signal.sum(axis=summed), (~grasp.valid).sum(axis=summed)
    norm = Normalize(0.0, max(float(view.image.max()), 1e-12))
    colours, borders = colormaps[PRESSURE_COLOURS], grasp.scene.borders(along)
    unit = drawn_millimetre(grasp.scene.size)
    thick, apart = JAW * unit, 0.1 * unit
    for jaw, side in enumerate(JAWS):
        bottom = 1e3 * grasp.scene.size[2] if side == "upper" else -thick
        for number, (low, high) in enumerate(borders):
            shade = colours(float(norm(sums[jaw, number])))
            hatch = None if missing[jaw, number] == 0 else "xxx"
            axis.add_patch(
                Rectangle((low, bottom), high - low, thick, facecolor=shade, edgecolor=INK, linewidth=0.6, zorder=4, hatch=hatch)
            )
            if len(borders) <= MOST_NAMED:
                middle = (low + high) / 2, bottom + thick + apart if side == "upper" else bottom - apart
                align = "bottom" if side == "upper" else "top"
                axis.text(*middle, f"{LETTERS[side]}{number + 1}", ha="center", va=align, fontsize=6.5, color=GREY)


def _draw_estimates(axis: Axes, view: View, grasp: ViewedGrasp) -> None:
    rim = [withStroke(linewidth=3.4, foreground="w")]
    for body in estimated_bodies(grasp):
        first, second, distance = outline(body, grasp.scene.size, view.away)
        axis.contour(first, second, distance, levels=[0.0], colors=["w"], linewidths=3.4, zorder=7)
        axis.contour(first, second, distance, levels=[0.0], colors=[ESTIMATE], linewidths=1.4, zorder=8)
    regions = [estimate.region for estimate in grasp.estimates if estimate.region is not None]
    for line in (1e3 * line for region in regions for line in region.shadow(view.away)):
        axis.plot(*line.T, color="w", linewidth=2.4, zorder=7)
        axis.plot(*line.T, color=ESTIMATE, linewidth=1.1, linestyle=REGION_DASHES, zorder=8)
    for estimate in grasp.estimates:
        place = 1e3 * estimate.center[view.horizontal], 1e3 * estimate.center[view.vertical]
        axis.plot(*place, "+", color=ESTIMATE, markersize=13, markeredgewidth=1.8, zorder=8, path_effects=rim)


def _legend(axis: Axes, grasp: ViewedGrasp) -> None:
    """What the lines mean, and the estimates."""
    axis.axis("off")
    handles: list[Any] = [
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 3)), label="undeformed block; hatched: no taxel reads there"),
        Line2D([], [], color=INK, linewidth=0.6, label=f"{grasp.taxels_in_words} their sums in colour on the jaws"),
    ]
    if not grasp.valid.all():
        handles.append(Rectangle((0, 0), 1, 1, fill=False, edgecolor=INK, linewidth=0.5, hatch="xxx", label="dead or saturated"))
    if grasp.true:
        handles.append(Line2D([], [], color="k", linewidth=1.1, linestyle="--", label="true inclusions"))
    if grasp.estimates:
        sized = any(estimate.radius is not None for estimate in grasp.estimates)
        plus: dict[str, Any] = {"marker": "+", "markersize": 11, "markeredgewidth": 1.8, "linewidth": 1.4}
        words = "estimated centre and outline" if sized else "estimated centre"
        handles.append(Line2D([], [], color=ESTIMATE, linestyle="-" if sized else "", label=words, **plus))
    if any(estimate.region is not None for estimate in grasp.estimates):
        words = "its centre lies in here with a probability of 90 %"
        handles.append(Line2D([], [], color=ESTIMATE, linewidth=1.1, linestyle=REGION_DASHES, label=words))
    axis.legend(handles=handles, loc="upper left", borderaxespad=0.0)
    below = 0.98 - 0.046 * len(handles)
    numbered = max(grasp.signal.shape[1:]) <= MOST_NAMED
    room = (below - (NUMBERS_TOP if numbered else 0.0)) / max(LINE_HEIGHT * len(grasp.findings), LINE_HEIGHT)
    style: dict[str, Any] = {"fontsize": 8.5 * min(1.0, room / CLOSEST), "linespacing": 1.5 * float(np.clip(room, CLOSEST, 1.0))}
    axis.text(0.0, below, "\n".join(grasp.findings), transform=axis.transAxes, va="top", **style)
    if numbered:
        draw_taxel_numbers(axis, grasp)
