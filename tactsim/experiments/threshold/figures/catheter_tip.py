"""The tip of a catheter over its tissues, each sensor coloured by the hardness it reports, and the hardest one marked."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Rectangle, Wedge

from tactsim.array import Array
from tactsim.experiments.threshold.scene import CatheterTipScene
from tactsim.plotting.canvas import PRESSURE_COLOURS, SingleFigure, despined, result_figure
from tactsim.results import Result

TINTS = ("#ffffff", "#d9d9d9", "#f0f0f0", "#c4c4c4", "#e4e4e4")
HATCHES = ("", "///", "..", "xx", "--")
HARDEST_COLOUR, TRUE_COLOUR = "#d62728", "#000000"
MILLIMETRES, KILOPASCALS = 1e3, 1e-3
MARGIN = 1.6
"""Half of the picture's width over the radius of the tip."""


class CatheterTipFigures(SingleFigure):
    """The map beside the thresholds around the tip; nothing unless a sensor was read."""

    kind: Literal["catheter_tip"] = "catheter_tip"

    def figure(self, result: Result) -> Figure:
        """The tip on the surface (Fig. 7.1), and the thresholds over the angle."""
        title = "Threshold sensors around the tip of a catheter"
        with result_figure(result, (11.0, 4.9), title, below=_answer(result)) as figure:
            left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
            pressures = KILOPASCALS * result.history_values("reported_pressure")
            largest = float(np.nanmax(pressures)) if np.isfinite(pressures).any() else 1.0
            colours = ScalarMappable(Normalize(0.0, largest), PRESSURE_COLOURS)
            _draw_surface(left, result)
            _draw_sensors(left, result, pressures, colours)
            bar = figure.colorbar(colours, ax=left, pad=0.02, aspect=25)
            bar.set_label("reported threshold pressure in kPa")
            _draw_thresholds(right, result, pressures)
        return figure


def _answer(result: Result) -> str:
    """The hardest sensor in words."""
    quantities = result.quantities
    if "hardest_sensor" not in quantities:
        return "no sensor found a threshold"
    angle = np.degrees(quantities["hardest_angle"].value)
    words = f"hardest at sensor {quantities['hardest_sensor'].value}, {angle:.0f}°"
    if "margin_relative" in quantities:
        words += f", the second reads {100 * quantities['margin_relative'].value:.2g} % less"
    candidates = quantities["possible_hardest"].value
    if len(candidates) > 1:
        words += f"; sensors {', '.join(map(str, candidates))} may be the hardest"
    return f"{words}; wrong in {100 * quantities['chance_of_wrong'].value:.2g} % of the touches"


def _draw_surface(axis: Axes, result: Result) -> None:
    """Bands of tissue, the tip's outline and the middle it keeps free."""
    scene = result.scene_as(CatheterTipScene)
    middle = MILLIMETRES * np.array(scene.place)
    tip = MILLIMETRES * (scene.ring.radius + scene.ring.outer_radius)
    reach = MARGIN * tip
    names = scene.tissues
    looks: list[dict[str, Any]] = [
        {"facecolor": TINTS[k % len(TINTS)], "hatch": HATCHES[k % len(HATCHES)], "edgecolor": "0.6", "linewidth": 0.6}
        for k in range(len(names))
    ]
    axis.add_patch(Rectangle(middle - reach, 2 * reach, 2 * reach, zorder=0, **looks[-1]))
    for k in reversed(range(len(scene.borders))):
        axis.add_patch(Circle((0.0, 0.0), MILLIMETRES * scene.borders[k], zorder=1, **looks[k]))
    axis.add_patch(Circle(tuple(middle), tip, fill=False, edgecolor="black", linewidth=1.2, zorder=3))
    axis.set(xlim=middle[0] + np.array([-reach, reach]), ylim=middle[1] + np.array([-reach, reach]), aspect="equal")
    axis.set(xlabel="x from the middle of the valve in mm", ylabel="y in mm")
    handles = [Patch(label=name, **look) for name, look in zip(names, looks, strict=True)]
    axis.legend(handles=handles, loc="lower left", fontsize=8, frameon=True, framealpha=0.9)


def _draw_sensors(axis: Axes, result: Result, pressures: Array, colours: ScalarMappable) -> None:
    """Rings coloured by the reported pressure; grey without one; the hardest outlined."""
    scene = result.scene_as(CatheterTipScene)
    outer, inner = MILLIMETRES * scene.ring.outer_radius, MILLIMETRES * scene.ring.inner_radius
    hardest = result.quantities["hardest_sensor"].value if "hardest_sensor" in result.quantities else 0
    for number, (step, pressure, state) in enumerate(zip(result.steps, pressures, scene.state, strict=True), 1):
        x, y = (MILLIMETRES * step.values[name] for name in "xy")
        known = np.isfinite(pressure)
        colour = colours.to_rgba(pressure) if known else "0.75"
        axis.add_patch(
            Wedge((x, y), outer, 0, 360, width=outer - inner, facecolor=colour, edgecolor="black", linewidth=0.7, zorder=4)
        )
        axis.add_patch(Circle((x, y), inner, facecolor="white", edgecolor="black", linewidth=0.5, zorder=4))
        axis.text(x, y, str(number), ha="center", va="center", fontsize=8, zorder=6)
        if number == hardest:
            axis.add_patch(Circle((x, y), 1.25 * outer, fill=False, edgecolor=HARDEST_COLOUR, linewidth=2.5, zorder=5))
        if not known:
            axis.text(x, y - 1.15 * outer, state, ha="center", va="top", fontsize=7, zorder=6)
    if hardest:
        _name_hardest(axis, result, hardest)


def _name_hardest(axis: Axes, result: Result, hardest: int) -> None:
    """The word beside the hardest sensor, outside the tip."""
    scene, values = result.scene_as(CatheterTipScene), result.steps[hardest - 1].values
    outward = np.array([np.cos(values["angle"]), np.sin(values["angle"])])
    reach = MILLIMETRES * (scene.ring.radius + 1.35 * scene.ring.outer_radius)
    x, y = MILLIMETRES * np.array(scene.place) + reach * outward
    side = "left" if outward[0] > 0.4 else "right" if outward[0] < -0.4 else "center"
    level = "bottom" if outward[1] > 0.4 else "top" if outward[1] < -0.4 else "center"
    box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
    axis.text(x, y, "hardest", ha=side, va=level, color=HARDEST_COLOUR, fontweight="bold", bbox=box, zorder=7)


def _draw_thresholds(axis: Axes, result: Result, pressures: Array) -> None:
    """Reported and true thresholds of every sensor, those over two tissues named."""
    angle = np.degrees(result.history_values("angle"))
    deviation = KILOPASCALS * result.history_values("reported_deviation")
    true = KILOPASCALS * result.history_values("threshold_pressure")
    bars = np.nan_to_num(deviation)
    axis.errorbar(angle, pressures, yerr=bars, fmt="o", color="#1f4e79", capsize=3, label="reported, ± standard deviation")
    lowest, highest = (KILOPASCALS * result.history_values(f"threshold_{end}") for end in ("lowest", "highest"))
    axis.vlines(angle, lowest, highest, color="0.75", linewidth=7, zorder=0, label="within the error of the model")
    axis.plot(angle, true, "_", color=TRUE_COLOUR, markersize=16, markeredgewidth=1.8, label="true threshold")
    straddling = np.array(result.scene_as(CatheterTipScene).straddles)[: len(angle)]
    if straddling.any():
        axis.plot(angle[straddling], true[straddling], "D", color="0.5", markersize=9, fillstyle="none", label="over two tissues")
    if "hardest_sensor" in result.quantities:
        best = result.quantities["hardest_sensor"].value - 1
        ring: dict[str, Any] = {"markersize": 13, "fillstyle": "none", "markeredgewidth": 2}
        axis.plot(angle[best], pressures[best], "o", color=HARDEST_COLOUR, label="hardest", **ring)
    axis.set(xlabel="angle of the sensor around the tip in degrees", ylabel="threshold pressure in kPa", ylim=(0, None))
    axis.set_title("reported as the trigger fires, which is after the touch", loc="left")
    axis.set_xticks(angle)
    axis.set_xticklabels([f"{value:.0f}" for value in angle], rotation=45 if len(angle) > 12 else 0)
    axis.set_ylim(0, 1.45 * float(np.nanmax(np.append(highest, pressures + bars))))
    axis.legend(fontsize=8, loc="upper right", ncols=2)
    despined(axis)
