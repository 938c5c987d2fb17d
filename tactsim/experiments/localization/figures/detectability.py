"""Detectability map: the smallest lump found over its depth, for each matrix of taxels."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from tactsim.array import Array
from tactsim.experiments.localization.scene import DetectabilityScene
from tactsim.plotting.canvas import SingleFigure, despined, result_figure
from tactsim.results import Result
from tactsim.units import format_quantity

PANELS = {"smallest_radius": "same noise on every taxel", "smallest_radius_by_area": "noise in proportion to the taxel's area"}
STYLES: tuple[Any, ...] = ("-", "--", ":", "-.")
FILLS: tuple[Any, ...] = ("full", "none", "left", "top")
"""Of lines and markers, by stiffness: a lump found at one depth only has no line."""
MARKERS = "osD^vP*X"
NEVER = "#d0d7de"
"""Colour of the radii that do not fit at a depth."""


class DetectabilityFigures(SingleFigure):
    """The smallest radius over the depth."""

    kind: Literal["detectability"] = "detectability"

    def can_draw(self, result: Result) -> bool:
        """Whether the result is complete."""
        return all(name in result.quantities for name in PANELS)

    def figure(self, result: Result) -> Figure:
        """Smallest radius over depth, a panel for either noise, a colour for each matrix and a line for each stiffness."""
        values: Any = {name: quantity.value for name, quantity in result.quantities.items()}
        colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(values["matrices"])))
        with result_figure(result, (10.4, 5.0), "Smallest lump found", remark=_wanted(result)) as figure:
            axes = figure.subplots(1, 2, sharey=True)
            top = _top(values)
            for axis, (name, words) in zip(axes, PANELS.items(), strict=True):
                radii = np.array(values[name], dtype=float)
                _draw(axis, radii, 1e3 * np.array(values["depths"]), colours, top)
                _name_curves(axis, radii, values, colours)
                axis.set_title(words, loc="left")
            axes[0].set_ylabel("smallest radius found in mm")
            figure.legend(handles=_legend(values, colours), loc="outside lower center", ncols=4, fontsize=8.5)
        return figure


def _top(values: Any) -> float:
    """Height in mm of both panels, above the largest radius of either."""
    finite = [radius for name in PANELS for radius in np.ravel(np.array(values[name], dtype=float)) if np.isfinite(radius)]
    return 1.15e3 * max(finite) if finite else 1.0


def _draw(axis: Axes, radii: Array, depths: Array, colours: Array, top: float) -> None:
    """Curves of radii (ratio, matrix, depth) in m over depths in mm; above the grey line a ball leaves the block."""
    for ratio, matrix in np.ndindex(*radii.shape[:2]):
        style: dict[str, Any] = {
            "color": colours[matrix],
            "linestyle": STYLES[ratio % len(STYLES)],
            "marker": MARKERS[matrix % len(MARKERS)],
            "fillstyle": FILLS[ratio % len(FILLS)],
        }
        axis.plot(depths, 1e3 * radii[ratio, matrix], markersize=5, **style)
    axis.fill_between([0.0, top, top], [0.0, top, top], top, color=NEVER, linewidth=0)
    axis.set(xlim=(0.0, float(depths.max()) * 1.04), ylim=(0.0, top), xlabel="depth of the centre below the upper jaw in mm")
    axis.grid(alpha=0.25, linewidth=0.6)
    despined(axis)


def _name_curves(axis: Axes, radii: Array, values: Any, colours: Array) -> None:
    """Taxels and stiffness of each curve above its end: few points make no line to look up in a legend.

    Those of a single point stand beside it, for above it the point of another curve may lie.
    """
    middle = sum(axis.get_xlim()) / 2
    for ratio, matrix in np.ndindex(*radii.shape[:2]):
        known = np.flatnonzero(np.isfinite(radii[ratio, matrix]))
        if not known.size:
            continue
        end = known[-1 if matrix % 2 == 0 else 0]
        place = (1e3 * values["depths"][end], 1e3 * radii[ratio, matrix, end])
        count, times = values["matrices"][matrix], values["shear_ratios"][ratio]
        style: dict[str, Any] = {"ha": "center", "va": "bottom"}
        words, offset = f"{count} × {count}, {times:g}×", (0, 5)
        if known.size == 1:
            words += ", at this depth only"
            style, offset = ({"ha": "left"}, (7, 0)) if place[0] < middle else ({"ha": "right"}, (-7, 0))
            style["va"] = "center_baseline"
        style |= {"color": 0.75 * colours[matrix][:3], "fontsize": 7.5}
        axis.annotate(words, place, offset, textcoords="offset points", annotation_clip=False, **style)


def _legend(values: Any, colours: Array) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=colour, marker=MARKERS[k % len(MARKERS)], markersize=4, label=f"{count} × {count} taxels")
        for k, (count, colour) in enumerate(zip(values["matrices"], colours, strict=True))
    ]
    handles += [
        Line2D(
            [],
            [],
            color="k",
            linestyle=STYLES[k % len(STYLES)],
            marker="o",
            markersize=4,
            fillstyle=FILLS[k % len(FILLS)],
            label=f"{ratio:g}× the tissue's shear modulus",
        )
        for k, ratio in enumerate(values["shear_ratios"])
    ]
    return [*handles, Patch(color=NEVER, label="reaches the upper face")]


def _wanted(result: Result) -> str:
    scene = result.scene_as(DetectabilityScene)
    share, alarms = 100 * scene.probability, 100 * scene.false_alarms
    return f"{share:g} % found at {alarms:g} % false alarms, noise {format_quantity(scene.noise, 'N')}"
