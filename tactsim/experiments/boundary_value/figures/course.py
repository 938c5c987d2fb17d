"""What was asked of a boundary value problem over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from tactsim.array import Array
from tactsim.experiments.boundary_value.scene import BoundaryValueScene
from tactsim.plotting.canvas import LINE_COLOURS, despined, scale_of, with_minus
from tactsim.results import Result
from tactsim.units import format_quantity

MARKS = (".-", "s--", "^:", "d-.", "x-", "v--")
"""Marks and lines of the curves, which differ in a grey print, too."""
ALIKE = 5e-3
"""Curves of a largest magnitude of one that differ by less are drawn as one."""
LONGEST_LINEAR = 1e3
"""Ratio of the last to the first positive time above which the time is drawn on a logarithmic axis."""
Named = dict[str, Array]
"""Values over time by the names of the quantities."""


def draw_course(axis: Axes, result: Result, scene: BoundaryValueScene) -> None:
    """What was asked for over time: one course in its unit, of several each over its largest magnitude; of a single time, the
    numbers themselves.
    """
    time = result.history_values("time")
    if len(time) == 1:
        _write_numbers(axis, result, scene)
        return
    asked = {name: result.history_values(name) for name in list(scene.asked)[: len(MARKS)]}
    groups = _alike(asked)
    if len(groups) == 1 and len({format_quantity(_most(values), scene.asked[name]) for name, values in asked.items()}) == 1:
        name = next(iter(asked))
        factor, unit = scale_of(_most(asked[name]), scene.asked[name])
        axis.plot(time, factor * asked[name], MARKS[0], color=LINE_COLOURS[0], markersize=3, label="\n".join(asked))
        axis.set_ylabel(f"{name} in {unit}" if len(asked) == 1 else f"value in {unit}")
        if len(asked) > 1:
            axis.legend(fontsize=7)
    else:
        for group, style, colour in zip(groups, MARKS, LINE_COLOURS, strict=False):
            label = "\n".join(f"{name} / {format_quantity(_most(values), scene.asked[name])}" for name, values in group.items())
            axis.plot(time, _normalized(next(iter(group.values()))), style, color=colour, markersize=3, label=label)
        axis.set_ylabel("quantity / its largest magnitude")
        axis.legend(fontsize=7)
    positive = time[time > 0]
    if len(positive) and positive[-1] > LONGEST_LINEAR * positive[0]:
        axis.set_xscale("log")
    axis.axhline(0.0, color="k", linewidth=0.5)
    axis.set_xlabel("time in s")
    despined(axis)


def _alike(asked: Named) -> list[Named]:
    """The quantities in groups that share the course over their largest magnitude."""
    groups: list[Named] = []
    for name, values in asked.items():
        for group in groups:
            if np.abs(_normalized(next(iter(group.values()))) - _normalized(values)).max() < ALIKE:
                group[name] = values
                break
        else:
            groups.append({name: values})
    return groups


def _most(values: Array) -> float:
    """The largest magnitude."""
    return float(np.abs(values).max())


def _normalized(values: Array) -> Array:
    """Values over their largest magnitude; zero of what is zero."""
    return values / (_most(values) or 1.0)


def _write_numbers(axis: Axes, result: Result, scene: BoundaryValueScene) -> None:
    """What was asked for at the only time there is, a line each."""
    last = result.steps[-1].values
    lines = [with_minus(f"{name}: {format_quantity(last[name], unit)}") for name, unit in scene.asked.items()]
    axis.text(0.0, 1.0, "\n".join(lines), transform=axis.transAxes, ha="left", va="top", linespacing=1.7)
    axis.set_title(f"at {format_quantity(last['time'], 's')}", loc="left")
    axis.set_axis_off()
