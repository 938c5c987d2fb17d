"""Design of the annular sensor: the force with which the tissue touches, over the ratio of the radii and the recess."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter
from scipy.interpolate import RectBivariateSpline

from tactsim.array import Array
from tactsim.experiments.annulus.scene import AnnulusDesignScene
from tactsim.plotting.canvas import SingleFigure, plain_decades, result_figure
from tactsim.results import Result
from tactsim.units import format_quantity

PANELS = 3
"""Times that are shown: the shortest, the middle and the longest of more."""
LIMIT_COLOURS, POINT_COLOUR = ("#000000", "#ff9d5c"), "#d62728"
RIM = 1.25
"""Hatched part beyond the end of linear theory, over that end."""
FINE, FEWEST = 200, 4
"""Points of a fine map along each side, and the fewest of a map that cubic splines take."""
ABOVE_POINT = 0.17
"""Height, as a part of the panel, above the words of the design point."""
DECADES = 4
"""Decades of the force that are coloured below the largest one."""


class AnnulusDesignFigures(SingleFigure):
    """A map for each of up to three times."""

    kind: Literal["annulus_design"] = "annulus_design"

    def can_draw(self, result: Result) -> bool:
        """Whether the map is complete, and a sensor is touched."""
        force = result.quantities.get("force_to_touch")
        return force is not None and bool(np.isfinite(force.numbers).any())

    def figure(self, result: Result) -> Figure:
        """Maps of the force to touch with the limits of force, the end of linear theory and the design point."""
        times = result.scene_as(AnnulusDesignScene).times
        shown = list(range(len(times))) if len(times) <= PANELS else [0, len(times) // 2, len(times) - 1]
        force = result.quantities["force_to_touch"].numbers
        largest = 10.0 ** np.ceil(np.log10(np.nanmax(force[:, :, shown])))
        smallest = max(largest / 10**DECADES, float(np.nanmin(force[:, :, shown])))
        norm = LogNorm(smallest, largest)
        with result_figure(result, (1.6 + 3.4 * len(shown), 4.9), "Annular sensor: where the tissue touches") as figure:
            axes = figure.subplots(1, len(shown), squeeze=False, sharey=True)[0]
            for axis, index in zip(axes, shown, strict=True):
                drawn = _draw_map(axis, result, force[:, :, index].T, norm)
                _draw_point(axis, result, times[index])
                axis.set_title(f"after {format_quantity(times[index], 's')}", loc="left")
                axis.set_xlabel("ratio of the radii ri/ro")
            axes[0].set_ylabel("recess L in mm")
            extend = "min" if np.nanmin(force[:, :, shown]) < smallest * (1 - 1e-9) else "neither"
            bar = figure.colorbar(drawn, ax=list(axes), pad=0.01, aspect=30, extend=extend)
            bar.set_label("constant force with which the tissue touches, in N")
            bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            columns = 2 if len(shown) > 1 else 1
            figure.legend(handles=_legend(result), loc="outside lower left", ncols=columns, fontsize=8)
        return figure


def _draw_map(axis: Axes, result: Result, force: Array, norm: LogNorm) -> Any:
    """The coloured force (recess, ratio), the contours of its limits, and hatching outside small displacements."""
    scene = result.scene_as(AnnulusDesignScene)
    ratio, recess = np.array(scene.ratios), 1e3 * np.array(scene.recesses)
    coloured = np.ma.masked_invalid(force)
    shading: Literal["nearest", "gouraud"] = "nearest" if np.ma.is_masked(coloured) else "gouraud"  # no cell with a masked corner
    drawn = axis.pcolormesh(ratio, recess, coloured, norm=norm, cmap="viridis", shading=shading, rasterized=True)
    if shading == "nearest" and min(force.shape) > 1:  # whose cells reach half of one beyond
        axis.set(xlim=(ratio[0], ratio[-1]), ylim=(recess[0], recess[-1]))
    for limit, colour in zip(_limits(result), LIMIT_COLOURS, strict=True):
        if np.nanmin(force) < limit < np.nanmax(force):
            axis.contour(*_finer(ratio, recess, force), levels=[np.log(limit)], colors=[colour], linewidths=2)
    relative = result.quantities["touch_displacement_over_radius"].numbers.T
    end = scene.small_displacement
    if np.nanmin(relative) < end < np.nanmax(relative):
        fine = _finer(ratio, recess, relative)
        hatched = axis.contourf(*fine, levels=np.log([end, RIM * end]), colors="none", hatches=["////"])
        hatched.set_edgecolor((1, 1, 1, 0.6))
        hatched.set_linewidth(0)
        axis.contour(*fine, levels=[np.log(end)], colors="white", linewidths=1.4, linestyles="dashed")
    elif np.nanmin(relative) >= end:
        axis.text(0.03, ABOVE_POINT, "all outside small-displacement theory", transform=axis.transAxes, color="w", fontsize=8)
    axis.set_yscale("log")
    plain_decades(axis)
    return drawn


def _finer(ratio: Array, recess: Array, values: Array) -> tuple[Array, Array, Array]:
    """Ratios, recesses and the logarithm of positive values between those of a map, by cubic splines if all are finite."""
    logarithms = np.log(values)
    if min(values.shape) < FEWEST or not np.isfinite(logarithms).all():
        return ratio, recess, logarithms
    fine = np.linspace(ratio[0], ratio[-1], FINE), np.geomspace(recess[0], recess[-1], FINE)
    return *fine, RectBivariateSpline(np.log(recess), ratio, logarithms)(np.log(fine[1]), fine[0])


def _draw_point(axis: Axes, result: Result, time: float) -> None:
    """The design point; with its own force to touch where the time is its own."""
    point = result.scene_as(AnnulusDesignScene).design_point
    axis.plot(
        point.ratio, 1e3 * point.recess, "*", color=POINT_COLOUR, markeredgecolor="white", markersize=13, zorder=5, clip_on=False
    )
    if time != point.time:
        return
    needed, rise = (_three_digits(result, name) for name in ("point_force_to_touch", "point_rise"))
    lifted = f"lifts it by {rise}" if rise else "presses to the base"
    touches = f"touches at {needed}" if needed else "never touched"
    axis.annotate(
        f"design point: {touches};\n{format_quantity(point.force, 'N')} {lifted}",
        (0.97, 0.03),
        xycoords="axes fraction",
        ha="right",
        va="bottom",
        fontsize=8,
        color="black",
        bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
    )


def _three_digits(result: Result, name: str) -> str:
    """A quantity as text, empty where it has no value."""
    quantity = result.quantities[name]
    return "" if quantity.value is None else format_quantity(float(f"{quantity.value:.3g}"), quantity.unit)


def _limits(result: Result) -> tuple[float, float]:
    scene = result.scene_as(AnnulusDesignScene)
    return scene.recommended_force, scene.largest_force


def _legend(result: Result) -> list[Any]:
    names = ("recommended force", "largest force")
    lines: list[Any] = [
        Line2D([], [], color=colour, linewidth=2, label=f"{name}, {format_quantity(limit, 'N')}: touched below the line")
        for name, limit, colour in zip(names, _limits(result), LIMIT_COLOURS, strict=True)
    ]
    scene = result.scene_as(AnnulusDesignScene)
    point = scene.design_point
    where = f"ri/ro = {point.ratio:g}, L = {format_quantity(point.recess, 'm')}"
    star = Line2D([], [], linestyle="none", marker="*", color=POINT_COLOUR, markersize=11, label=f"design point, {where}")
    end = f"above the dashed line: displacement at touch beyond {scene.small_displacement:g} ro, not small"
    relative = result.quantities["touch_displacement_over_radius"].numbers
    crossed = np.nanmin(relative) < scene.small_displacement < np.nanmax(relative)
    patches = [Patch(facecolor="0.6", edgecolor="white", hatch="///", label=end)] if crossed else []
    if np.isnan(relative).any():
        never = "white: pressed to the base of the layer before it is touched"
        patches.append(Patch(facecolor="white", edgecolor="0.6", label=never))
    return [*lines, star, *patches]
