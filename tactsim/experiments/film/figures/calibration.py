"""Calibration of a force sensor: conductance over force with its line, the force errors below."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.film.scene import CalibrationScene
from tactsim.plotting.canvas import SingleFigure, despined, result_figure, with_minus
from tactsim.results import Result
from tactsim.sensors.electronics.calibration import MILLISIEMENS

LINE_COLOUR, DATA_COLOUR, LIMIT_COLOUR = "#1f4e79", "#000000", "#b8540a"
PER_SIEMENS = 1 / MILLISIEMENS
DENSE = 200
"""Forces at which the bands are compared."""
COLUMNS = ("force", "line", "line_lower", "line_upper", "conductance", "used")


class ForceCalibrationFigures(SingleFigure):
    """After Fig. 3.4 of the thesis."""

    kind: Literal["calibration"] = "calibration"

    def figure(self, result: Result) -> Figure:
        """Readings, line and band above; force errors with the two limits of linearity below."""
        with result_figure(result, (6.6, 5.6), "Calibration of a force sensor") as figure:
            upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
            _draw_line(upper, result)
            _draw_errors(lower, result)
        return figure


def _draw_line(axis: Axes, result: Result) -> None:
    """Conductance in mS over force in N, one line per sensor."""
    many = np.ndim(result.quantities["slope"].value) > 0
    share = f"{100 * result.scene_as(CalibrationScene).confidence:.3g} % band"
    confidence = f"{share} of each line; below, all as one" if many else f"{share} of the line"
    for number, sensor in enumerate(_sensors(result)):
        force, line, low, high, conductance, used = (sensor.history_values(name) for name in COLUMNS)
        order = np.argsort(force, kind="stable")
        labels = (confidence, _equation(result), "readings") if number == 0 else (None, None, None)
        low, line, high, conductance = (PER_SIEMENS * values for values in (low, line, high, conductance))
        axis.fill_between(force[order], low[order], high[order], color=LINE_COLOUR, alpha=0.3, linewidth=0, label=labels[0])
        axis.plot(force[order], line[order], color=LINE_COLOUR, linewidth=_width(result), label=labels[1])
        axis.plot(force, conductance, "o", color=DATA_COLOUR, markersize=_size(result), label=labels[2])
        out = used == 0
        if out.any():
            axis.plot(force[out], line[out], "x", color=LIMIT_COLOUR, label="saturated, left out (on the line)")
    axis.set_ylabel("conductance in mS")
    handles = dict(zip(*reversed(axis.get_legend_handles_labels()), strict=True))
    axis.legend(handles.values(), handles.keys(), loc="upper left", fontsize=8.5)
    despined(axis)


def _equation(result: Result) -> str:
    """The line in the form that the thesis prints, or how many there are."""
    slope, intercept = (PER_SIEMENS * np.atleast_1d(result.quantities[name].value) for name in ("slope", "intercept"))
    if slope.size > 1:
        return f"lines of {slope.size} sensors, of {1 / slope.max():.2f} to {1 / slope.min():.2f} N/mS"
    return f"F = {1 / slope[0]:.2f} C {'−' if intercept[0] >= 0 else '+'} {abs(intercept[0] / slope[0]):.3f} (N, mS)"


def _draw_errors(axis: Axes, result: Result) -> None:
    """Force read less force applied, and the bands of the lines in force, in percent of full scale."""
    scale = result.scene_as(CalibrationScene).full_scale
    slopes = np.atleast_1d(result.quantities["slope"].value)
    _draw_bands(axis, result, slopes * scale / 100)
    for sensor in _sensors(result):
        force = sensor.history_values("force")
        axis.plot(force, 100 * sensor.history_values("force_error") / scale, "o", color=DATA_COLOUR, markersize=_size(result))
    axis.axhline(0.0, color=LINE_COLOUR, linewidth=1)
    for name, extreme in (("linearity_positive", np.max), ("linearity_negative", np.min)):
        _draw_limit(axis, 100 * float(extreme(result.quantities[name].value)))
    axis.set(xlabel="force in N", ylabel=f"read − applied,\n% of {scale:g} N")
    despined(axis)


def _draw_bands(axis: Axes, result: Result, scales: Array) -> None:
    """The bands of the lines over scales (sensors,), as one between the widest of them: many on each other hide the readings."""
    force = result.history_values("force")
    along, ends = np.linspace(force.min(), force.max(), DENSE), []
    for scale, sensor in zip(scales, _sensors(result), strict=True):
        force, line, low, high = (sensor.history_values(name) for name in COLUMNS[:4])
        order = np.argsort(force, kind="stable")
        ends += [np.interp(along, force[order], (end - line)[order] / scale) for end in (low, high)]
    axis.fill_between(along, np.min(ends, axis=0), np.max(ends, axis=0), color=LINE_COLOUR, alpha=0.3, linewidth=0)


def _draw_limit(axis: Axes, limit: float) -> None:
    """A limit of linearity in percent, with its number at the right."""
    axis.axhline(limit, color=LIMIT_COLOUR, linewidth=1, linestyle="--")
    axis.annotate(
        with_minus(f"{limit:+.3g} %"),
        (1.0, limit),
        xycoords=("axes fraction", "data"),
        xytext=(3, 0),
        textcoords="offset points",
        va="center",
        color=LIMIT_COLOUR,
        fontsize=8.5,
    )


def _sensors(result: Result) -> list[Result]:
    """The result of each sensor alone."""
    numbers = sorted({step.values["sensor"] for step in result.steps})
    return [replace(result, steps=tuple(step for step in result.steps if step.values["sensor"] == k)) for k in numbers]


def _width(result: Result) -> float:
    return 1.5 if np.ndim(result.quantities["slope"].value) == 0 else 0.7


def _size(result: Result) -> float:
    return 3.5 if np.ndim(result.quantities["slope"].value) == 0 else 1.5
