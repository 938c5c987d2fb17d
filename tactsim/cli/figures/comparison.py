"""Several results in one figure: a curve for each over what grows during the run, or a bar for each."""

from __future__ import annotations

import itertools
import textwrap
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
MARKS = ("", "o", "s", "^", "D", "v")
"""Dashes of the curves, one after the other, and marks of their ends, another with every round: told apart without colour.
The first have none: in a legend a mark hides the middle of the dashes."""
MOST_NAMED, TITLE_WIDTH = 4, 66
"""Parts in which the cases differ that the title names, and characters of its lines."""


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
        first, *rest = _title(comparison)
        entitle(figure, first, " ".join(rest))
    return figure


def comparison_png(results: Mapping[str, Result], comparison: Comparison) -> bytes:
    """`comparison_figure` as PNG."""
    return png(comparison_figure(results, comparison))


def _title(comparison: Comparison) -> list[str]:
    """In what the cases differ, or whose results are compared if that is not known or nothing, in lines."""
    groups: dict[str, list[str]] = {}
    for key in comparison.inputs:
        plain = key.partition(" [")[0].removeprefix("experiment.").split(".")
        groups[plain[0]] = _shared(groups.get(plain[0], plain), plain)
    if not groups:
        return [" and ".join(comparison.names) if len(comparison.names) == 2 else f"{len(comparison.names)} results of one case"]
    names = [".".join(group) for group in groups.values()]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return textwrap.wrap(f"{len(comparison.names)} results that differ in {', '.join(names[:MOST_NAMED])}{more}", TITLE_WIDTH)


def _shared(first: list[str], second: list[str]) -> list[str]:
    """The beginning that two key paths have in common."""
    return [one for one, _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False))]


def _has(result: Result, pair: tuple[str, str]) -> bool:
    return len(result.steps) > 1 and all(name in result.units and np.isfinite(result.history_values(name)).any() for name in pair)


def _draw_curves(axis: Axes, results: Mapping[str, Result], pair: tuple[str, str]) -> None:
    series = {name: [result.history_values(one) for one in pair] for name, result in results.items()}
    units = next(iter(results.values())).units
    scales = [scale_of(max(np.nanmax(np.abs(values[k])) for values in series.values()), units[pair[k]]) for k in (0, 1)]
    for number, (name, (x, y)) in enumerate(series.items()):
        label = name if results[name].status == "converged" else f"{name} ({results[name].status})"
        dash, mark = DASHES[number % len(DASHES)], MARKS[number // len(DASHES) % len(MARKS)]
        axis.plot(scales[0][0] * x, scales[1][0] * y, dash, marker=mark, markevery=[-1], markersize=5, label=label)
    reached = [place for result in results.values() if (place := _threshold(result, pair)) is not None]
    if reached:
        x, y = (factor * np.array(values) for (factor, _), values in zip(scales, zip(*reached, strict=True), strict=True))
        axis.plot(x, y, "*", color="white", markeredgecolor="black", markersize=11, label="threshold", zorder=3)
    axis.set_xlabel(f"{pair[0].replace('_', ' ')} in {scales[0][1]}")
    axis.set_ylabel(f"{pair[1].replace('_', ' ')} in {scales[1][1]}")
    axis.legend()
    despined(axis)


def _threshold(result: Result, pair: tuple[str, str]) -> tuple[float, float] | None:
    """Where a result has its threshold, in the values that are drawn; None if it has none or has not reached it."""
    quantities = [result.quantities.get(f"threshold_{name.removeprefix('reaction_')}") for name in pair]
    x, y = (one.value if one is not None and isinstance(one.value, int | float) else None for one in quantities)
    return None if x is None or y is None else (x, y)


def _spread(column: object) -> float:
    values = np.array([value for value in column.values if value is not None and np.isfinite(value)])  # type: ignore[attr-defined]
    return float(np.ptp(values) / np.abs(values).max()) if values.size > 1 and np.abs(values).max() > 0 else 0.0
