"""Reported thresholds: their errors over speed, noise and cut-off with what makes them, and one recording with its capture."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

from tactsim.array import Array, evenly_spaced
from tactsim.errors import InputError
from tactsim.experiments.threshold.scene import ThresholdCapture, ThresholdTrialScene
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import Plot, despined, ink_on, result_figure, scale_of, with_minus
from tactsim.results import Result
from tactsim.units import format_quantity

PARTS = {
    "level_error": ("level of the trigger", "#1f4e79", "o-"),
    "film_error": ("film against its line", "#555555", "D-"),
    "filter_error": ("lag of the filter", "#b8540a", "s--"),
    "sampling_error": ("sampling", "#4d9221", "^:"),
    "noise_error": ("noise", "#7b3294", "v-."),
}
LARGE_COLOUR, SMALL_COLOUR, CAPTURE_COLOUR = "#1f4e79", "#b8540a", "#000000"
MOST_LABELS = 60
"""Combinations of a map that are labelled with their numbers."""
MOST_MAPS = 4
"""Noises that are shown; of more the first, some between and the last."""
AFTER = 0.15
"""Time that is shown after the capture, as a part of that before it."""
TICKS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)
"""Relative errors that are labelled on the scale of colours."""
LEAST_ERROR = 1e-3
"""Relative error below which all share a colour."""


class ThresholdTrialFigures(ResultFigures):
    """Two figures: the errors over the combinations, and one recording."""

    kind: Literal["threshold_trial"] = "threshold_trial"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``threshold_errors.png`` and ``threshold_signals.png``, as far as there is something to draw."""
        drawings: dict[str, Drawing] = {}
        if "force_error" in result.quantities:
            drawings["threshold_errors.png"] = Plot(lambda: threshold_error_figure(result))
        if result.steps:
            drawings["threshold_signals.png"] = Plot(lambda: threshold_signal_figure(result))
        return drawings


def threshold_error_figure(result: Result) -> Figure:
    """For each noise a map of the error over speed and cut-off, and below what makes the mean error at the middle cut-off."""
    noises = result.scene_as(ThresholdTrialScene).noises
    shown = evenly_spaced(len(noises), MOST_MAPS)
    force = result.quantities["threshold_force"].value
    true_force = " to ".join(dict.fromkeys(format_quantity(float(f"{f:.3g}"), "N") for f in (min(force), max(force))))
    words = f"true threshold {true_force}; in the squares: mean ± standard deviation of the error in %"
    with result_figure(result, (max(8.5, 1.6 + 3.7 * len(shown)), 7.2), below=words) as figure:
        axes = figure.subplots(2, len(shown), squeeze=False, sharey="row", height_ratios=(1.15, 1))
        norm = _norm(result)
        for column, noise in enumerate(shown):
            drawn = _draw_map(axes[0, column], result, int(noise), norm)
            axes[0, column].set_title(f"white noise {format_quantity(noises[noise], 'V')} rms", loc="left")
            axes[0, column].set_xlabel("speed in mm/s")
            _draw_parts(axes[1, column], result, int(noise))
        axes[0, 0].set_ylabel("cut-off of the low pass in Hz")
        handles = axes[1, 0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower left", ncols=len(PARTS) + 1, fontsize=8)
        bar = figure.colorbar(drawn, ax=list(axes[0]), pad=0.01, aspect=22, extend="min")
        bar.set_label("error of the threshold, root mean square, %")
        low, high = norm.vmin or 0.0, norm.vmax or np.inf
        bar.ax.yaxis.set_major_locator(FixedLocator([tick for tick in TICKS if low <= tick <= high]))
        bar.ax.yaxis.set_minor_locator(NullLocator())
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g}"))
    return figure


def _grid(result: Result, name: str) -> Array:
    """Values [speed, noise, cut-off], NaN where there are none."""
    return result.quantities[name].numbers


def _total(result: Result) -> Array:
    """Root mean square of the relative error."""
    return np.hypot(_grid(result, "relative_error"), np.nan_to_num(_grid(result, "relative_deviation")))


def _norm(result: Result) -> LogNorm:
    total = _total(result)
    largest = float(np.nanmax(total)) if np.isfinite(total).any() else 1.0
    least = max(LEAST_ERROR, float(np.nanmin(total)) if np.isfinite(total).any() else LEAST_ERROR)
    return LogNorm(min(least, largest / 2), max(largest, 2 * LEAST_ERROR))


def _draw_map(axis: Axes, result: Result, noise: int, norm: LogNorm) -> Any:
    """Coloured and labelled errors; grey where no trial was valid."""
    total = _total(result)[:, noise].T
    speeds, cutoffs = 1e3 * np.array(result.scene_as(ThresholdTrialScene).speeds), result.scene_as(ThresholdTrialScene).cutoffs
    axis.set_facecolor("0.8")
    drawn = axis.pcolormesh(np.clip(total, norm.vmin, None), norm=norm, cmap="cividis", edgecolors="white", linewidth=0.5)
    axis.set_xticks(np.arange(len(speeds)) + 0.5, [f"{value:.3g}" for value in speeds])
    axis.set_yticks(np.arange(len(cutoffs)) + 0.5, [f"{value:.3g}" for value in cutoffs])
    if total.size <= MOST_LABELS:
        for row, column in np.ndindex(*total.shape):
            words = _label(result, (column, noise, row))
            known = np.isfinite(total[row, column])
            ink = ink_on(drawn.cmap(norm(max(float(total[row, column]), norm.vmin or 0.0)))) if known else "k"
            axis.text(column + 0.5, row + 0.5, words, ha="center", va="center", fontsize=7, color=ink)
    return drawn


def _label(result: Result, place: tuple[int, int, int]) -> str:
    """Mean and standard deviation in percent, and what went wrong."""
    mean, deviation = (100 * _grid(result, name)[place] for name in ("relative_error", "relative_deviation"))
    spread = np.isfinite(deviation) and deviation > 0
    digits = max(0, 1 - int(np.floor(np.log10(deviation)))) if spread else 0
    plain = f"{mean:+.{digits}f}" if spread else f"{mean:+.3g}"
    lines = [with_minus(plain) if np.isfinite(mean) else "none"]
    if spread:
        lines.append(f"± {deviation:.{digits}f}")
    for name, words in (("false_rate", "false"), ("missed_rate", "missed"), ("saturated_rate", "saturated")):
        rate = _grid(result, name)[place]
        if rate > 0:
            lines.append(f"{100 * rate:.2g} % {words}")
    return "\n".join(lines)


def _draw_parts(axis: Axes, result: Result, noise: int) -> None:
    """The parts of the mean error over the speed, at the middle cut-off."""
    scene = result.scene_as(ThresholdTrialScene)
    cutoff, speeds = len(scene.cutoffs) // 2, 1e3 * np.array(scene.speeds)
    true = result.quantities["threshold_force"].numbers
    for name, (words, colour, line) in PARTS.items():
        if name == "film_error" and not np.nan_to_num(_grid(result, name)).any():
            continue
        part = 100 * _grid(result, name)[: len(true), noise, cutoff] / true
        axis.plot(speeds[: len(true)], part, line, color=colour, markersize=4, label=words)
    whole = 100 * _grid(result, "relative_error")[:, noise, cutoff]
    axis.plot(speeds, whole, "x-", color="black", linewidth=2.2, alpha=0.8, label="sum: mean error", zorder=1)
    axis.axhline(0.0, color="0.6", linewidth=0.6)
    if len(speeds) > 1:
        axis.set_xscale("log")
    axis.xaxis.set_major_locator(FixedLocator(list(speeds)))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("speed in mm/s")
    chosen = format_quantity(scene.cutoffs[cutoff], "Hz")
    axis.set_title(f"what makes it at a cut-off of {chosen}", loc="left")
    if axis.get_subplotspec() and axis.get_subplotspec().is_first_col():  # type: ignore[union-attr]
        axis.set_ylabel("part of the mean error, % of the threshold")
    despined(axis)


def threshold_signal_figure(result: Result) -> Figure:
    """Both sensors over time, the large one with the captured threshold, and below the small one with its level (Fig. 3.6b).

    Raises
    ------
    InputError
        If the result holds no captured touch.
    """
    capture = _capture(result)
    result = _around(capture, result)
    time = result.history_values("time")
    touch = ((capture.speed, "m/s"), (capture.noise, "V"), (capture.cutoff, "Hz"))
    speed, noise, cutoff = (format_quantity(value, unit) for value, unit in touch)
    words = f"One touch at {speed}, white noise {noise} rms, low pass {cutoff}"
    with result_figure(result, (8.0, 5.6), below=words) as figure:
        axes = figure.subplots(2, 1, sharex=True, height_ratios=(1.4, 1))
        large, unit = scale_of(float(result.history_values("large_reading").max()), "N")
        small, small_unit = scale_of(float(result.history_values("small_reading").max()), "N")
        _draw_signal(axes[0], result, "large", large, LARGE_COLOUR)
        axes[0].plot(time, large * result.history_values("plate_force"), ":", color="black", label="force on the plate")
        _draw_signal(axes[1], result, "small", small, SMALL_COLOUR)
        axes[1].plot(time, small * result.history_values("small_force"), ":", color="black", label="force on it")
        level: dict[str, Any] = {"color": SMALL_COLOUR, "linewidth": 0.9, "linestyle": "--", "label": "level of the trigger"}
        axes[1].axhline(small * capture.trigger_level, **level)
        for axis in axes:
            axis.axvline(capture.touch_time, color="0.45", linewidth=0.9, linestyle="-.")
            despined(axis)
        _mark_capture(axes, capture, large)
        axes[0].set_ylabel(f"large sensor in {unit}")
        axes[1].set(xlabel="time in s", ylabel=f"small sensor in {small_unit}", xlim=(time[0], time[-1]))
        for axis in axes:
            axis.legend(fontsize=8, loc="upper left")
    return figure


def _capture(result: Result) -> ThresholdCapture:
    """The touch whose steps the result holds."""
    capture = result.scene_as(ThresholdTrialScene).capture
    if capture is None:
        raise InputError("the result has steps of a touch but no capture")
    return capture


def _around(capture: ThresholdCapture, result: Result) -> Result:
    """The result without the time long after the capture."""
    trigger = np.inf if capture.trigger_time is None else capture.trigger_time
    begin, last = result.steps[0].values["time"], max(capture.touch_time, trigger)
    kept = tuple(step for step in result.steps if step.values["time"] <= last + AFTER * (last - begin))
    return replace(result, steps=kept)


def _draw_signal(axis: Axes, result: Result, name: str, factor: float, colour: str) -> None:
    time = result.history_values("time")
    plain, filtered = (factor * result.history_values(f"{name}_reading{end}") for end in ("_unfiltered", ""))
    axis.plot(time, plain, color=colour, alpha=0.3, linewidth=0.7, label="reading, unfiltered")
    axis.plot(time, filtered, color=colour, label="reading, filtered")
    spread = float(np.ptp(filtered))
    axis.set_ylim(min(-0.05 * spread, float(filtered.min()) - 0.1 * spread), float(filtered.max()) + 0.05 * spread)


def _mark_capture(axes: Any, capture: ThresholdCapture, factor: float) -> None:
    """The captured threshold and, beside it, the true one."""
    true = format_quantity(float(f"{capture.threshold_force:.3g}"), "N")
    axes[0].plot(capture.touch_time, factor * capture.threshold_force, "s", color="0.45", markersize=6, fillstyle="none")
    if capture.trigger_time is None or capture.captured_force is None:
        axes[0].set_title(f"no threshold captured; true threshold {true}", loc="left")
        return
    for axis in axes:
        axis.axvline(capture.trigger_time, color=CAPTURE_COLOUR, linewidth=0.9)
    axes[0].plot(capture.trigger_time, factor * capture.captured_force, "o", color=CAPTURE_COLOUR, markersize=8, zorder=5)
    captured = format_quantity(float(f"{capture.captured_force:.3g}"), "N")
    late = format_quantity(float(f"{capture.trigger_time - capture.touch_time:.2g}"), "s")
    when = f"{late} after the touch (dash-dotted)" if capture.trigger_time >= capture.touch_time else "before the touch: false"
    axes[0].set_title(f"captured threshold {captured} (dot), {when}; true threshold {true} (square)", loc="left")
