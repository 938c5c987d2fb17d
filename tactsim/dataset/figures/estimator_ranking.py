"""Figures of a ranking of estimators: errors over what varies, coverage, noise, and where each saw the lumps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.interfaces.drawing import Drawing
from tactsim.plotting.canvas import Plot, despined, titled_figure

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Of the estimators, distinguishable by the colour-blind: Okabe & Ito 2008."""
MARKERS = "osD^vP"
MILLIMETRES = 1e3
AXES = {
    "depth": "depth of the centre in mm",
    "radius": "radius in mm",
    "contrast": "shear modulus over the tissue's, at rest",
    "closing": "closing of each jaw in mm",
}
BIN_SHARE, NOISE_APART = 0.5, 0.16
"""Part of a bin, and of a multiple of the noise, over which estimators stand beside each other, so that their intervals do not
cover one another."""
NOMINAL = (0.85, 0.95)
"""Band that is drawn behind the coverage: what a region that should hold 90 % of the centres may hold."""


@dataclass(frozen=True)
class Measure:
    """A row of panels: the name of a measure, the statistic of it that is drawn, if it has several, and a heading."""

    name: str
    statistic: str | None
    heading: str

    @property
    def is_rate(self) -> bool:
        """Whether it is a part of 1, not a length."""
        return self.statistic is None

    def of(self, measures: Mapping[str, Any]) -> dict[str, float] | None:
        """Its value and interval among the measures of an estimator, None if it is not known."""
        measure = measures[self.name]
        return measure if measure is None or self.statistic is None else measure[self.statistic]


@dataclass(frozen=True)
class Style:
    """How an estimator is drawn and what it is called; ``share`` is its place among the others beside it, from 0 to 1."""

    name: str
    colour: str
    marker: str
    share: float


ROWS = (
    Measure("detection_rate", None, "detection rate"),
    Measure("lateral_error", "median", "lateral error in mm"),
    Measure("depth_error", "median", "depth error in mm"),
    Measure("coverage", None, "coverage of 90 % regions"),
)


def ranking_figures(record: Mapping[str, Any]) -> dict[str, Drawing]:
    """File name -> drawing, of the numbers of a ranking in SI."""
    estimators = record["estimators"]
    drawings: dict[str, Drawing] = {
        "errors.png": Plot(lambda: errors_figure(estimators)),
        "noise.png": Plot(lambda: noise_figure(estimators)),
        "places.png": Plot(lambda: places_figure(estimators, record["block_size"]["value"])),
    }
    present = {_present(row) for one in estimators for row in one["samples"]}
    return drawings if len(present) < 2 else drawings | {"roc.png": Plot(lambda: roc_figure(estimators))}


def roc_figure(estimators: Sequence[Mapping[str, Any]]) -> Figure:
    """Detection rate over false-alarm rate, by the threshold on the probability that anything is there.

    A mark is what an estimator decides; one that states no probability has the mark alone.
    """
    rows = estimators[0]["samples"]
    lumps = sum(map(_present, rows))
    below = f"{lumps} grasps with a lump, {len(rows) - lumps} without; marks: as decided"
    with titled_figure(5.2, 6.0, "Detection over false alarms", below) as figure:
        axis = figure.add_subplot()
        axis.plot([0, 1], [0, 1], color="0.7", linewidth=0.8, linestyle=":")
        for style, estimator in zip(_styles(estimators), estimators, strict=True):
            present = np.array([_present(row) for row in estimator["samples"]])
            decided = np.array([row["found"] for row in estimator["samples"]])
            stated = np.array([row["probability"] for row in estimator["samples"]], dtype=float)
            label = f"{style.name}: no probability stated"
            if np.isfinite(stated).all():
                alarms, detected = roc(stated, present)
                axis.plot(alarms, detected, color=style.colour)
                label = f"{style.name}: area {np.trapezoid(detected, alarms):.3f}"
            mark: dict[str, Any] = {"color": style.colour, "marker": style.marker, "markersize": 6, "linestyle": ""}
            axis.plot(decided[~present].mean(), decided[present].mean(), label=label, clip_on=False, zorder=3, **mark)
        axis.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), aspect="equal", xlabel="false-alarm rate", ylabel="detection rate")
        despined(axis)
        figure.legend(loc="outside lower center", fontsize=8)
    return figure


def roc(probability: Array, present: Array) -> tuple[Array, Array]:
    """False-alarm and detection rate, each (n,) from 0 to 1, with every probability (samples,) that occurs as the threshold from
    which on a sample counts as a lump; equal ones are taken together.

    Source: T. Fawcett 2006, doi:10.1016/j.patrec.2005.10.010, algorithm 1.
    """
    order = np.argsort(-probability, kind="stable")
    last = np.append(np.diff(probability[order]) != 0, True)
    alarms, detected = (np.append(0.0, np.cumsum(chosen[order])[last] / chosen.sum()) for chosen in (~present, present))
    return alarms, detected


def _present(row: Mapping[str, Any]) -> bool:
    """Whether there is a lump in a sample."""
    return row["truth"]["center"] is not None


def errors_figure(estimators: Sequence[Mapping[str, Any]]) -> Figure:
    """Rates and median errors, one row each, over depth, radius, contrast and closing, one column each, with 95 % intervals."""
    below = "numbers above: lumps in each bin, in which the estimators stand side by side; bars: 95 % intervals"
    with titled_figure(2.6 * len(AXES) + 0.6, 2.1 * len(ROWS) + 0.5, "Errors of the estimators", below) as figure:
        grid = figure.subplots(len(ROWS), len(AXES), squeeze=False, sharex="col", sharey="row")
        for row, measure in enumerate(ROWS):
            for column, (label, words) in enumerate(AXES.items()):
                axis = grid[row, column]
                _draw_bins(axis, estimators, label, measure)
                if column == 0:
                    axis.set_ylabel(measure.heading)
                if row == len(ROWS) - 1:
                    axis.set_xlabel(words)
        _legend(figure, grid[0, 0])
    return figure


def noise_figure(estimators: Sequence[Mapping[str, Any]]) -> Figure:
    """The same over the noise."""
    with titled_figure(2.7 * len(ROWS), 2.7, "Estimators under noise") as figure:
        for axis, measure in zip(figure.subplots(1, len(ROWS)), ROWS, strict=True):
            for style, estimator in zip(_styles(estimators), estimators, strict=True):
                multiples = np.array([measures["multiple"] for measures in estimator["noise"]])
                at = multiples * (1 + NOISE_APART * (style.share - 0.5))
                _draw_line(axis, at, [measure.of(measures) for measures in estimator["noise"]], style, measure)
            axis.set_xscale("log", base=2)
            axis.xaxis.set_major_formatter("{x:g}")
            axis.set_xlabel("noise over the stated noise")
            axis.set_title(measure.heading, loc="left")
            _finish(axis, measure)
        _legend(figure, figure.axes[0])
    return figure


def places_figure(estimators: Sequence[Mapping[str, Any]], block_size: Sequence[float]) -> Figure:
    """Estimated over true x, y and height of the lumps that were detected."""
    names = ("x", "y", "height")
    with titled_figure(2.6 * len(estimators) + 0.3, 7.4, "Estimated over true places") as figure:
        grid = figure.subplots(3, len(estimators), squeeze=False, sharex="row", sharey="row")
        for column, one in enumerate(estimators):
            hits = [row for row in one["samples"] if row["found"] and row["truth"]["center"] is not None]
            true = MILLIMETRES * np.array([row["truth"]["center"] for row in hits]).reshape(-1, 3)
            estimated = MILLIMETRES * np.array([row["center"] for row in hits]).reshape(-1, 3)
            for row, name in enumerate(names):
                axis, side = grid[row, column], MILLIMETRES * float(block_size[row])
                axis.plot([0, side], [0, side], color="0.6", linewidth=0.8)
                axis.plot(true[:, row], estimated[:, row], ".", color=COLOURS[column % len(COLOURS)], markersize=4)
                axis.set(xlim=(0, side), ylim=(0, side), aspect="equal", xlabel=f"true {name} in mm")
                if column == 0:
                    axis.set_ylabel(f"estimated {name} in mm")
            grid[0, column].set_title(f"{_shown(one['name'])}\n{len(hits)} detected", loc="left", fontsize=8)
    return figure


def _shown(name: str) -> str:
    """The name of an estimator in words."""
    return name.replace("_", " ")


def _styles(estimators: Sequence[Mapping[str, Any]]) -> list[Style]:
    return [
        Style(
            _shown(estimator["name"]),
            COLOURS[number % len(COLOURS)],
            MARKERS[number % len(MARKERS)],
            (number + 0.5) / len(estimators),
        )
        for number, estimator in enumerate(estimators)
    ]


def _draw_bins(axis: Axes, estimators: Sequence[Mapping[str, Any]], label: str, measure: Measure) -> None:
    factor = 1.0 if label == "contrast" else MILLIMETRES
    if label == "contrast":
        ends = [part[end] for one in estimators for part in one["bins"][label] for end in ("low", "high")]
        axis.set_xscale("log")
        low, high = min(ends, default=1.0), max(ends, default=10.0)
        axis.set_xlim(low / 1.2, high * 1.2)
        axis.xaxis.set_major_formatter("{x:g}")
        if high < 10 * low:  # ticks between powers of ten would be written over each other
            axis.set_xticks(sorted({float(f"{end:.2g}") for end in (low, high)}))
        axis.xaxis.set_minor_formatter("")
    for style, estimator in zip(_styles(estimators), estimators, strict=True):
        bins = estimator["bins"][label]
        within = 0.5 + BIN_SHARE * (style.share - 0.5)
        places = np.array([part["low"] ** (1 - within) * part["high"] ** within for part in bins])
        _draw_line(axis, factor * places, [measure.of(part) for part in bins], style, measure)
    if measure is ROWS[0] and estimators:
        for part in estimators[0]["bins"][label]:
            middle = factor * (part["low"] * part["high"]) ** 0.5
            axis.text(middle, 1.04, f"{part['lumps']}", ha="center", va="bottom", fontsize=7, color="0.4")
    _finish(axis, measure)


def _draw_line(axis: Axes, at: Array, values: Sequence[dict[str, float] | None], style: Style, measure: Measure) -> None:
    """One estimator's values with their intervals; those that are not known are left out."""
    factor = 1.0 if measure.is_rate else MILLIMETRES
    known = [(place, value) for place, value in zip(at, values, strict=True) if value is not None]
    places = [place for place, _ in known]
    drawn = factor * np.array([[value[key] for key in ("value", "low", "high")] for _, value in known]).reshape(-1, 3)
    axis.plot(places, drawn[:, 0], f"-{style.marker}", color=style.colour, markersize=4, label=style.name)
    axis.vlines(places, drawn[:, 1], drawn[:, 2], color=style.colour, linewidth=0.8, alpha=0.6)


def _finish(axis: Axes, measure: Measure) -> None:
    if measure.name == "coverage":
        axis.axhspan(*NOMINAL, color="0.9", zorder=0)
    axis.set_ylim(bottom=0, top=1.05 if measure.is_rate else None)
    despined(axis)


def _legend(figure: Figure, axis: Axes) -> None:
    """Below all panels: above them stands the title, which may have two lines."""
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=max(1, len(labels)), fontsize=8)
