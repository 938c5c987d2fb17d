"""Signals of a dynamic mechanical analysis with their sines, and the moduli that they give: thesis Fig. 4.8 to 4.10."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.dma.scene import DmaScene, ShownSignals
from tactsim.plotting.canvas import despined, result_figure
from tactsim.results import Result

LOAD, DISPLACEMENT, TANGENT = "#1f4e79", "#b8540a", "#4d9221"
TRUE_LINE: dict[str, Any] = {"linestyle": ":", "linewidth": 1.2}


def signals_figure(result: Result) -> Figure:
    """Signals at the lowest and at the highest frequency above; below the moduli with two standard errors, and the tangent."""
    scene = result.scene_as(DmaScene)
    below = "" if _true_modulus(result) is None else "Synthetic signals (points) and their fits (lines)"
    with result_figure(result, (10.0, 6.4), "Signals and moduli of a dynamic mechanical analysis", below=below) as figure:
        axes = figure.subplots(2, 2)
        for axis, shown in zip(axes[0], scene.signals, strict=True):
            _draw_signals(axis, shown)
        _draw_moduli(axes[1, 0], result, np.array(scene.data_frequencies))
        _draw_tangent(axes[1, 1], result, np.array(scene.data_frequencies))
        for axis in axes[1]:
            despined(axis)
    return figure


def _draw_signals(axis: Axes, shown: ShownSignals) -> None:
    """Load on the left, displacement on the right axis, each with its fit."""
    time, other = np.array(shown.time), axis.twinx()
    columns = (
        (axis, shown.load, shown.fitted_load, 1e3, LOAD, "load in mN"),
        (other, shown.displacement, shown.fitted_displacement, 1e6, DISPLACEMENT, "displacement in µm"),
    )
    for side, values, fitted, scale, colour, words in columns:
        side.plot(time, scale * np.array(values), ".", color=colour, markersize=2.5, alpha=0.6)
        side.plot(time, scale * np.array(fitted), "-", color=colour, linewidth=1)
        side.set_ylabel(words, color=colour)
        side.tick_params(axis="y", colors=colour)
    axis.set(xlabel="time in s")
    axis.set_title(f"{shown.frequency:g} Hz: the displacement lags by {np.degrees(shown.lag):.1f}°", loc="left")


def _draw_moduli(axis: Axes, result: Result, frequency: Array) -> None:
    storage, loss = (result.quantities[f"{name}_modulus"].numbers for name in ("storage", "loss"))
    errors = [result.quantities[f"{name}_modulus_error"].numbers for name in ("storage", "loss")]
    for values, error, colour, words in zip((storage, loss), errors, (LOAD, DISPLACEMENT), ("storage", "loss"), strict=True):
        axis.errorbar(frequency, values / 1e3, 2 * error / 1e3, fmt="o", color=colour, markersize=4, capsize=3, label=words)
    axis.plot(frequency, np.hypot(storage, loss) / 1e3, "s", color="#555555", markersize=3, label="magnitude")
    true = _true_modulus(result)
    if true is not None:
        curves, modulus = true
        for values, colour in ((modulus.real, LOAD), (modulus.imag, DISPLACEMENT)):
            axis.plot(curves, values / 1e3, color=colour, label="true" if colour == LOAD else None, **TRUE_LINE)
    axis.set(xlabel="frequency in Hz", ylabel="modulus in kPa", ylim=(0, None))
    axis.set_title("moduli with two standard errors", loc="left")
    axis.legend(loc="upper left")


def _draw_tangent(axis: Axes, result: Result, frequency: Array) -> None:
    axis.plot(frequency, result.quantities["loss_tangent"].numbers, "o", color=TANGENT, markersize=4, label="signals")
    true = _true_modulus(result)
    if true is not None:
        axis.plot(true[0], true[1].imag / true[1].real, color=TANGENT, label="true", **TRUE_LINE)
    axis.set(xlabel="frequency in Hz", ylabel="loss over storage modulus", ylim=(0, None))
    axis.set_title("loss tangent", loc="left")
    axis.legend(loc="lower right")


def _true_modulus(result: Result) -> tuple[Array, Array] | None:
    """Frequencies in Hz and complex moduli in Pa of the model that synthetic signals were made of."""
    parts = [result.history_values(f"true_{part}_compliance") for part in ("elastic", "viscous")]
    return (result.history_values("frequency"), 1 / (parts[0] - 1j * parts[1])) if np.isfinite(parts[0]).any() else None
