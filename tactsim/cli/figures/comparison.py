"""Several results in one figure: a curve for each over what grows during the run, or a bar for each."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.plotting.canvas import despined, entitle, new_figure, png, scale_of, styled
from tactsim.results import Result
from tactsim.results.comparison import Comparison

CURVES = (("displacement", "reaction_force"), ("displacement", "force"), ("time", "force"))
"""What is drawn over what, the first pair that every result has."""
MOST_BARS = 6
DASHES = ("-", "--", "-.", ":")
"""Told apart without colour, too."""


def comparison_figure(results: Mapping[str, Result], comparison: Comparison) -> Figure:
    """A curve for each result, or bars of the numbers in which they differ most where there is no history in common."""
    with styled():
        pair = next((pair for pair in CURVES if all(_has(result, pair) for result in results.values())), None)
        if pair is not None:
            figure = new_figure(6.4, 4.2)
            _draw_curves(figure.subplots(), results, pair)
        else:
            columns = sorted(comparison.differing, key=_spread, reverse=True)[:MOST_BARS]
            figure = new_figure(6.4, 1.2 + (0.5 + 0.3 * len(results)) * max(1, len(columns)))
            for axis, column in zip(figure.subplots(max(1, len(columns)), squeeze=False)[:, 0], columns, strict=False):
                heights = [np.nan if value is None else value for value in column.values]
                axis.barh(comparison.names, heights, height=0.6)
                axis.invert_yaxis()
                axis.set_xlabel(column.head)
                despined(axis)
        entitle(figure, f"{len(results)} results compared")
    return figure


def comparison_png(results: Mapping[str, Result], comparison: Comparison) -> bytes:
    """`comparison_figure` as PNG."""
    return png(comparison_figure(results, comparison))


def _has(result: Result, pair: tuple[str, str]) -> bool:
    return len(result.steps) > 1 and all(name in result.units and np.isfinite(result.history_values(name)).any() for name in pair)


def _draw_curves(axis: Axes, results: Mapping[str, Result], pair: tuple[str, str]) -> None:
    series = {name: [result.history_values(one) for one in pair] for name, result in results.items()}
    units = next(iter(results.values())).units
    scales = [scale_of(max(np.nanmax(np.abs(values[k])) for values in series.values()), units[pair[k]]) for k in (0, 1)]
    for number, (name, (x, y)) in enumerate(series.items()):
        label = name if results[name].status == "converged" else f"{name} ({results[name].status})"
        axis.plot(scales[0][0] * x, scales[1][0] * y, DASHES[number // 10 % len(DASHES)], label=label)
        axis.plot(scales[0][0] * x[-1], scales[1][0] * y[-1], "o", color=axis.lines[-1].get_color(), markersize=4)
    axis.set_xlabel(f"{pair[0].replace('_', ' ')} in {scales[0][1]}")
    axis.set_ylabel(f"{pair[1].replace('_', ' ')} in {scales[1][1]}")
    axis.legend()
    despined(axis)


def _spread(column: object) -> float:
    values = np.array([value for value in column.values if value is not None and np.isfinite(value)])  # type: ignore[attr-defined]
    return float(np.ptp(values) / np.abs(values).max()) if values.size > 1 and np.abs(values).max() > 0 else 0.0
