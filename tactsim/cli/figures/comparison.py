"""Several results in one figure: a curve for each over what grows during the run, or a bar for each; and maps of taxels."""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase

from tactsim.cli.figures.compared_maps import TaxelMaps, draw_maps, taxel_maps
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.outcome.contact_history import CONTACT_UNITS
from tactsim.outside.text import first_names
from tactsim.plotting.canvas import despined, encoded, entitle, new_figure, scale_of, styled
from tactsim.results import Result
from tactsim.results.compared_numbers import LARGEST, OF_ARRAYS, Column
from tactsim.results.comparison import Comparison

CURVES = (("displacement", "reaction_force"), ("displacement", "force"), ("time", "force"))
"""What is drawn over what, the first pair that every result has."""
MOST_BARS, BARS_ABOVE_MAPS = 6, 3
ASKED_FOR = ("reaction_force", "threshold_pressure", "threshold_force", *(f"{LARGEST}{TAXEL_FORCE}_{side}" for side in JAWS))
"""Numbers that bars show first, whether they differ or not."""
OF_THE_SOLVER = frozenset({*CONTACT_UNITS, "unknowns", "mirror_asymmetry"} - {"max_pressure"})
"""Numbers that tell how a result was computed and not what it is: bars show them only where nothing else differs."""
DASHES = ("-", "--", "-.", ":")
MARKS = ("", "o", "s", "^", "D", "v")
"""Dashes of the curves, one after the other, and marks of their ends, another with every round: told apart without colour.
The first have none: in a legend a mark hides the middle of the dashes."""
FEW_STEPS = 12
"""Up to which each step of a curve is marked: straight lines between a few are not what was computed."""
MOST_NAMED, TITLE_WIDTH = 4, 66
"""Parts in which the cases differ that the title names, and characters of its lines."""


@dataclass(frozen=True)
class Shared:
    """What several results have in common that a figure shows: values of their histories, or numbers, and maps of taxels."""

    pair: tuple[str, str] | None
    columns: list[Column]
    maps: TaxelMaps | None

    @classmethod
    def of(cls, results: Mapping[str, Result], comparison: Comparison) -> Self:
        """Values of the histories before numbers."""
        pair, maps = next((pair for pair in CURVES if _have(results, pair)), None), taxel_maps(results)
        return cls(pair, [] if pair else _bars(comparison, maps is not None), maps)

    @property
    def nothing(self) -> bool:
        """Whether there is nothing to show."""
        return self.pair is None and self.maps is None and not self.columns


def drawn_comparison(results: Mapping[str, Result], comparison: Comparison, form: str = "png") -> bytes | None:
    """`comparison_figure` as PNG, SVG or PDF; None if the results share nothing that it shows."""
    with styled():
        figure = comparison_figure(results, comparison)
        return None if figure is None else encoded(figure, form)


def comparison_figure(results: Mapping[str, Result], comparison: Comparison) -> Figure | None:
    """A curve for each result, or bars of numbers where there is no history in common; below them what taxels read; None if there
    is nothing of it."""
    shared = Shared.of(results, comparison)
    if shared.nothing:
        return None
    pair, maps = shared.pair, shared.maps
    width, height = 6.4, 4.2 if pair else 1.2 + (0.5 + 0.3 * len(results)) * max(1, len(shared.columns))
    if maps is None:
        figure = new_figure(width, height)
        parts: Any = [figure]
    else:
        height = 3.4 if pair else height
        figure = new_figure(max(width, maps.size[0]), height + maps.size[1])
        parts = figure.subfigures(2, 1, squeeze=False, height_ratios=(height, maps.size[1]))[:, 0]
    if pair is not None:
        _draw_curves(parts[0].subplots(), results, pair)
    else:
        _draw_bars(parts[0], comparison, shared.columns)
    if maps is not None:
        draw_maps(parts[1], maps, [_labelled(name, result) for name, result in results.items()])
    first, *rest = _title(comparison)
    entitle(figure, first, " ".join(rest))
    return figure


def _bars(comparison: Comparison, above_maps: bool) -> list[Column]:
    """The numbers that bars show, of those that two results have: what people ask for first, then those that differ most; what
    tells of the solver last.
    """
    shared = [c for c in comparison.columns if sum(value is not None for value in c.values) > 1]
    wanted = [c for c in shared if c.name in ASKED_FOR and not (above_maps and c.name.startswith(OF_ARRAYS))]
    others = [c for c in comparison.differing if c in shared and not c.name.startswith(OF_ARRAYS) and c not in wanted]
    others.sort(key=lambda column: (column.name in OF_THE_SOLVER, -_spread(column)))
    no_solver = [c for c in others if c.name not in OF_THE_SOLVER]
    return [*wanted, *(no_solver if no_solver or wanted else others)][: BARS_ABOVE_MAPS if above_maps else MOST_BARS]


def _draw_bars(figure: FigureBase, comparison: Comparison, columns: Sequence[Column]) -> None:
    axes = figure.subplots(max(1, len(columns)), squeeze=False)[:, 0]
    if not columns:
        axes[0].text(0.5, 0.5, "no two of the results share a number", ha="center", va="center")
        axes[0].set_axis_off()
    for axis, column in zip(axes, columns, strict=False):
        heights = [np.nan if value is None else value for value in column.values]
        axis.barh(comparison.names, heights, height=0.6)
        axis.invert_yaxis()
        axis.set_xlabel(column.head)
        despined(axis)


def _title(comparison: Comparison) -> list[str]:
    """In what the cases differ, or whose results are compared if that is not known or nothing, in lines."""
    groups: dict[str, list[str]] = {}
    for key in comparison.inputs:
        plain = key.partition(" [")[0].removeprefix("experiment.").split(".")
        groups[plain[0]] = _shared(groups.get(plain[0], plain), plain)
    if not groups:
        return [" and ".join(comparison.names) if len(comparison.names) == 2 else f"{len(comparison.names)} results of one case"]
    names = [".".join(group) for group in groups.values()]
    return textwrap.wrap(f"{len(comparison.names)} results that differ in {first_names(names, MOST_NAMED)}", TITLE_WIDTH)


def _shared(first: list[str], second: list[str]) -> list[str]:
    """The beginning that two key paths have in common."""
    return [one for one, _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(first, second, strict=False))]


def _have(results: Mapping[str, Result], pair: tuple[str, str]) -> bool:
    """Whether every result has both values at some step, and one of them a curve."""
    return all(map(partial(_has, pair=pair), results.values())) and any(len(result.steps) > 1 for result in results.values())


def _has(result: Result, pair: tuple[str, str]) -> bool:
    return all(name in result.units and np.isfinite(result.history_values(name)).any() for name in pair)


def _labelled(name: str, result: Result) -> str:
    return name if result.status == "converged" else f"{name} ({result.status})"


def _draw_curves(axis: Axes, results: Mapping[str, Result], pair: tuple[str, str]) -> None:
    series = {name: [result.history_values(one) for one in pair] for name, result in results.items()}
    units = next(iter(results.values())).units
    scales = [scale_of(max(np.nanmax(np.abs(values[k])) for values in series.values()), units[pair[k]]) for k in (0, 1)]
    shortest_last = sorted(series, key=lambda name: -np.nanmax(np.abs(series[name][0])))
    for number, (name, (x, y)) in enumerate(series.items()):
        dash, mark = DASHES[number % len(DASHES)], MARKS[number // len(DASHES) % len(MARKS)]
        if len(x) == 1:
            dash, mark = "none", mark or "o"
        few = len(x) <= FEW_STEPS
        mark = mark or ("." if few else "")
        label = _labelled(name, results[name])
        above = 2 + shortest_last.index(name) / len(series)  # where two coincide, both are seen
        style: dict[str, Any] = {"linestyle": dash, "marker": mark, "markevery": None if few else [-1], "zorder": above}
        style["markersize"] = 9 if mark == "." else 5
        axis.plot(scales[0][0] * x, scales[1][0] * y, label=label, **style)
    reached = [place for result in results.values() if (place := _threshold(result, pair)) is not None]
    if reached:
        x, y = (factor * np.array(values) for (factor, _), values in zip(scales, zip(*reached, strict=True), strict=True))
        axis.plot(x, y, "*", color="none", markeredgecolor="black", markersize=13, label="threshold", zorder=3)
    axis.set_xlabel(f"{pair[0].replace('_', ' ')} in {scales[0][1]}")
    axis.set_ylabel(f"{pair[1].replace('_', ' ')} in {scales[1][1]}")
    axis.legend()
    despined(axis)


def _threshold(result: Result, pair: tuple[str, str]) -> tuple[float, float] | None:
    """Where a result has its threshold, in the values that are drawn; None if it has none or has not reached it."""
    quantities = [result.quantities.get(f"threshold_{name.removeprefix('reaction_')}") for name in pair]
    x, y = (one.value if one is not None and isinstance(one.value, int | float) else None for one in quantities)
    return None if x is None or y is None else (x, y)


def _spread(column: Column) -> float:
    values = np.array([value for value in column.values if value is not None and np.isfinite(value)])
    return float(np.ptp(values) / np.abs(values).max()) if values.size > 1 and np.abs(values).max() > 0 else 0.0
