"""Indentation: the deformed section under the body with its pressure, and the force against the displacement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.experiments.indentation.figures.contact_section import SENSOR_COLOUR, draw_contact_section
from tactsim.experiments.indentation.scene import IndentationScene, PressedBodyScene
from tactsim.interfaces import Drawing
from tactsim.plotting.canvas import (
    FAILED_COLOUR,
    SKETCH,
    Plot,
    SingleFigure,
    despined,
    result_figure,
    scale_of,
    weighted_percentiles,
)
from tactsim.results import Result, Status
from tactsim.units import format_quantity

FORCE_COLOUR, RISE_COLOUR = "#1f4e79", "#b8540a"
PERCENTILE = 99
"""Of the touched area, up to which the contact pressure is shown."""


class PressedFigures(SingleFigure):
    """The one figure of a kind, or of what is at rest a sketch: its section."""

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """The one figure, or ``sketch.png``."""
        return {SKETCH: Plot(lambda: self._sketch(result))} if result.at_rest else super().drawings(result)

    def draw_at_rest(self, axis: Axes, result: Result) -> None:
        """The section of a sketch."""
        draw_contact_section(axis, result)

    def _sketch(self, result: Result) -> Figure:
        with result_figure(result, (8.0, 4.8), f"A rigid {result.scene_as(PressedBodyScene).body.kind} on tissue") as figure:
            self.draw_at_rest(figure.add_subplot(), result)
        return figure


class IndentationFigures(PressedFigures):
    """Section and curve side by side."""

    kind: Literal["indentation"] = "indentation"

    def figure(self, result: Result) -> Figure:
        """Section (if the result has fields), force-displacement curve, and contact pressure over the radius."""
        scene = result.scene_as(IndentationScene)
        draw = [draw_curve] if scene.contact is None else [draw_curve, _draw_contact]
        return section_beside(result, draw, f"Indentation by a rigid {scene.body.kind}")


def section_beside(result: Result, draw: Sequence[Callable[[Axes, Result], None]], title: str, remark: str = "") -> Figure:
    """The section of the last frame with a remark, if there is one, and below each other the one or two curves of ``draw``."""
    has_section, rows = bool(result.frames), len(draw)
    size = (11.0 if has_section else 6.0, 4.4 if rows == 1 else 5.8)
    with result_figure(result, size, title, where=after(result)) as figure:
        ratios = (1.5, 1) if has_section else None
        grid = figure.add_gridspec(rows, 1 + has_section, width_ratios=ratios, height_ratios=(1.6, 1)[:rows])
        if has_section:
            draw_contact_section(figure.add_subplot(grid[:, 0]), result, result.frames[-1].time, remark)
        for row, draw_one in enumerate(draw):
            draw_one(figure.add_subplot(grid[row, -1]), result)
    return figure


def _draw_contact(axis: Axes, result: Result) -> None:
    """The contact pressure over the radius, up to a percentile of what touches: at edges it is singular, or nearly."""
    scene = result.scene_as(IndentationScene)
    assert scene.contact is not None
    radius, pressure, area = (np.array(values) for values in (scene.contact.radius, scene.contact.pressure, scene.contact.area))
    touching = pressure > 0
    high = float(weighted_percentiles(pressure[touching], area[touching], (PERCENTILE,))[0])
    factor, unit = scale_of(high, "Pa")
    axis.plot(1e3 * radius, factor * pressure, ".-", color=FORCE_COLOUR, linewidth=1.0, markersize=2.5)
    axis.fill_between(1e3 * radius, factor * pressure, color=FORCE_COLOUR, alpha=0.15, linewidth=0)
    top, most = 1.15 * factor * high, int(pressure.argmax())
    axis.set(xlim=(0, 1.3e3 * float(radius[touching].max())), ylim=(0, top), xlabel="radius in mm")
    axis.set_ylabel(f"contact pressure\nin {unit}")
    words = "mean on each element"
    if factor * pressure[most] > top:
        largest, place = format_quantity(float(f"{pressure[most]:.3g}"), "Pa"), format_quantity(float(f"{radius[most]:.3g}"), "m")
        words += f", to the {PERCENTILE}th percentile; {largest} at {place}"
    axis.set_title(words, loc="left")
    despined(axis)


def after(result: Result) -> str:
    """How far a run came, as its failure is marked."""
    return f" after a displacement of {format_quantity(result.steps[-1].values['displacement'], 'm')}"


def draw_curve(axis: Axes, result: Result) -> None:
    """Force and rise against the displacement, with the threshold, and a cross where a run stopped short."""
    displacement, force, rise = (result.history_values(name) for name in ("displacement", "reaction_force", "tissue_rise"))
    along, length = scale_of(float(displacement.max()), "m")
    up, unit = scale_of(float(np.abs(force).max()), "N")
    axis.plot(displacement * along, force * up, ".-", color=FORCE_COLOUR, markersize=4)
    axis.set(xlabel=f"displacement in {length}", xlim=(0, None), ylim=(0, None))
    axis.set_ylabel(f"force on the body in {unit}", color=FORCE_COLOUR)
    axis.set_title(f"{len(result.steps)} accepted steps", loc="left")
    axis.margins(x=0.03, y=0.08)
    if np.isfinite(rise).all():
        right = axis.twinx()
        _draw_rise(right, displacement * along, rise * 1e3, result)
        axis.set_zorder(right.get_zorder() + 1)  # its words stand on white, not under the dotted line
        axis.patch.set_visible(False)
    else:
        despined(axis)
    _mark_threshold(axis, result, along, up)
    _mark_last(axis, result, along, up)


def _draw_rise(axis: Axes, displacement: Array, rise: Array, result: Result) -> None:
    axis.plot(displacement, rise, "--", color=RISE_COLOUR)
    axis.set_ylabel("tissue rise in the hole in mm", color=RISE_COLOUR)
    axis.set_ylim(0, None)
    axis.spines["top"].set_visible(False)
    recess = result.scene_as(PressedBodyScene).recess
    if recess is not None:
        axis.set_ylim(0, max(1.12e3 * recess, rise.max() * 1.05))
        axis.axhline(1e3 * recess, color=SENSOR_COLOUR, linewidth=0.9, linestyle=":")
        words, place = f"inner sensor: a rise of {format_quantity(recess, 'm')}", (0.01, 1e3 * recess)
        axis.text(*place, words, transform=axis.get_yaxis_transform(), ha="left", va="bottom", color=SENSOR_COLOUR, fontsize=7.5)


def _mark_threshold(axis: Axes, result: Result, along: float, up: float) -> None:
    """A ring where the tissue touches the inner sensor; pressure and force begin the title."""
    names = ("threshold_displacement", "threshold_force", "threshold_pressure")
    if not all(name in result.quantities for name in names):
        return
    at, force, pressure = (result.quantities[name] for name in names)
    axis.plot(at.value * along, force.value * up, "o", color=FORCE_COLOUR, markersize=9, fillstyle="none", markeredgewidth=1.8)
    formatted = [format_quantity(q.value, q.unit) for q in (pressure, force, at)]
    # Above the curves, which leave no place between them that is free in every run.
    words = f"threshold (ring): {formatted[0]} on the annulus,\n{formatted[1]} at {formatted[2]}; {axis.get_title(loc='left')}"
    axis.set_title(words, loc="left")


def _mark_last(axis: Axes, result: Result, along: float, up: float) -> None:
    """A cross on the last accepted step of a run that did not end as it should."""
    if result.status is Status.CONVERGED:
        return
    last = result.steps[-1].values
    at = (last["displacement"] * along, last["reaction_force"] * up)
    axis.plot(*at, "X", color=FAILED_COLOUR, markersize=9)
    words = "interrupted" if result.status is Status.INTERRUPTED else "stopped"
    # Above the curves: force and rise leave no corner between them that is free in every run.
    words = f"{words} (cross) at {format_quantity(last['displacement'], 'm')}; {axis.get_title(loc='left')}"
    axis.set_title(words, loc="left", color=FAILED_COLOUR)
