"""A grasp over time: the forces of the jaws, the pressure in an artery and the taxels that carry most."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import LETTERS
from tactsim.experiments.grasp.history import lumen_columns
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces.both_jaws import TAXEL_FORCE, has_taxels, jaws_over_time
from tactsim.interfaces.taxel_layout import JAWS, OUTWARD
from tactsim.plotting.canvas import despined, scale_of
from tactsim.results import Result

MOST_TAXELS, MOST_NAMED = 9, 18
"""Most taxels whose forces are drawn, beside further ones with the same force, and most that the legend names for a curve."""
ALIKE = 0.01
"""Taxels whose forces differ by less than this part of the largest one share a curve."""
ROUND_OFF = 1e-6
"""Difference of forces that count as the same, over the largest force of all taxels."""
FROM_ZERO = 0.5
"""An axis whose lowest value is positive and below this part of the highest is drawn from zero on."""
FORCE_STYLES = {"upper": ("#0072b2", "-", "o"), "lower": ("#d55e00", "--", "s")}
LUMEN_COLOURS = ("#7a0177", "#009e73", "#000000", "#e69f00")
TAXEL_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d00", "#7f7f7f")
TAXEL_MARKERS = "os^vDP*Xd"
Taxel = tuple[str, int, int]
"""Side, row and column."""


def has_history(result: Result) -> bool:
    """Whether there is more than one step to draw."""
    return len(result.steps) > 1


def panels(result: Result) -> list[str]:
    """What there is to draw over time, from above."""
    names = ["forces"]
    if lumen_columns(result):
        names.append("lumen")
    if has_taxels(result, TAXEL_FORCE, history=True):
        names.append("taxels")
    return names


def draw_histories(axes: Sequence[Axes], result: Result) -> None:
    """The panels, one under the other."""
    along, words = abscissa(result)
    for axis, panel in zip(axes, panels(result), strict=True):
        {"forces": _draw_forces, "lumen": _draw_lumen, "taxels": _draw_taxels}[panel](axis, result, along)
        axis.margins(x=0.02)
        low, high = axis.dataLim.intervaly
        if 0 < low < FROM_ZERO * high:
            axis.set_ylim(bottom=0.0)
        despined(axis)
    ends = np.array([axis.get_xlim() for axis in axes])
    for axis in axes:
        axis.set_xlim(ends[:, 0].min(), ends[:, 1].max())
    for axis in axes[:-1]:
        axis.tick_params(labelbottom=False)
    axes[-1].set_xlabel(words)


def abscissa(result: Result) -> tuple[Array, str]:
    """Values (steps,) over which to draw and their name: time, or the closing where no time passes."""
    time = result.history_values("time")
    if np.isfinite(time).all() and np.ptp(time) > 0:
        return time, "time in s"
    closing = result.history_values("displacement")
    factor, unit = scale_of(float(np.abs(closing).max()), "m")
    return factor * closing, f"closing of each jaw in {unit}"


def _draw_forces(axis: Axes, result: Result, along: Array) -> None:
    forces = {side: OUTWARD[side] * result.history_values(f"jaw_force_{side}_z") for side in JAWS}
    factor, unit = _scale(list(forces.values()), "N")
    for side, force in forces.items():
        colour, line, marker = FORCE_STYLES[side]
        course = _from_rest(along, factor * force)
        axis.plot(*course, line, marker=marker, markersize=3.5, color=colour, label=f"{side} jaw")
    axis.set_ylabel(f"force in {unit}")
    axis.set_title("force of the tissue on each jaw, outward along z; straight between the solved steps (marks)", loc="left")
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5)


def _from_rest(along: Array, values: Array) -> tuple[Array, Array]:
    """The curve with its beginning, at which nothing acts yet, unless the first step is there already, as after a jump."""
    if along[0] <= 0.0:
        return along, values
    return np.append(0.0, along), np.append(0.0, values)


def _draw_lumen(axis: Axes, result: Result, along: Array) -> None:
    names = lumen_columns(result)
    pressures = [result.history_values(name) for name in names]
    factor, unit = _scale(pressures, "Pa")
    scene = result.scene_as(GraspScene)
    for name, pressure, colour in zip(names, pressures, itertools.cycle(LUMEN_COLOURS), strict=False):
        label = scene.named_inclusion(int(name.removeprefix("lumen_pressure").strip("_") or 1))
        axis.plot(*_from_rest(along, factor * pressure), ".-", color=colour, markersize=4, label=label)
    axis.set_ylabel(f"pressure in {unit}")
    axis.set_title("pressure in the lumen", loc="left")
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5)


def _scale(curves: Sequence[Array], unit: str) -> tuple[float, str]:
    """Factor and unit in which the largest value of all curves reads well."""
    return scale_of(max(float(np.nanmax(np.abs(curve))) for curve in curves), unit)


def _draw_taxels(axis: Axes, result: Result, along: Array) -> None:
    """The taxels of both jaws that ever carry the most."""
    values = jaws_over_time(result, TAXEL_FORCE)
    forces: dict[Taxel, Array] = {
        (JAWS[jaw], row, column): values[:, jaw, row, column] for jaw, row, column in np.ndindex(*values.shape[1:])
    }
    shown = _carrying_most({taxel: float(np.abs(force).max()) for taxel, force in forces.items()})
    factor, unit = _scale([forces[shown[0]]], "N")
    for group, colour, marker in zip(_alike(forces, shown), TAXEL_COLOURS, TAXEL_MARKERS, strict=False):
        in_order = sorted(group, key=lambda taxel: (JAWS.index(taxel[0]), *taxel[1:]))
        line = FORCE_STYLES[in_order[0][0]][1]
        names = [f"{LETTERS[side]}{row + 1},{column + 1}" for side, row, column in in_order[:MOST_NAMED]]
        names += [f"and {len(in_order) - MOST_NAMED} more"] if len(in_order) > MOST_NAMED else []
        rows = [" ".join(names[k : k + 3]) for k in range(0, len(names), 3)]
        style: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.1}
        axis.plot(*_from_rest(along, factor * forces[group[0]]), line, label="\n".join(rows), **style)
    axis.set_ylabel(f"force in {unit}")
    axis.set_title(f"the {len(shown)} of {len(forces)} taxels that carry most (row, column)", loc="left")
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.5)


def _carrying_most(largest: Mapping[Taxel, float]) -> list[Taxel]:
    """The taxels with the largest forces in N, and all that carry as much as the last of them, so that round-off does not
    choose.
    """
    order = sorted(largest, key=lambda taxel: -largest[taxel])
    least = largest[order[:MOST_TAXELS][-1]] - ROUND_OFF * largest[order[0]]
    return [taxel for taxel in order if largest[taxel] >= least]


def _alike(forces: Mapping[Taxel, Array], shown: Sequence[Taxel]) -> list[list[Taxel]]:
    """The taxels in groups whose curves lie on each other, each led by the one that carries most."""
    groups: list[list[Taxel]] = []
    width = ALIKE * float(np.abs(forces[shown[0]]).max())
    for taxel in shown:
        near = (group for group in groups if np.abs(forces[group[0]] - forces[taxel]).max() <= width)
        group = next(near, None)
        if group is None:
            groups.append([taxel])
        else:
            group.append(taxel)
    return groups
