"""The switch probe: the panel of its switches (Fig. 5.5) and force over depth for rates and tissues (Fig. 5.7 and 5.8)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from tactsim.experiments.switch_probe.scene import RecordedTouch, SwitchProbeScene
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import LINE_COLOURS, SMALL_TITLE, Plot, despined, result_figure
from tactsim.results import Result
from tactsim.units import format_quantity

COLOURS = (*LINE_COLOURS, "#795548")
LINES, MARKS = ("-", "--", "-.", ":"), ("o", "s", "^", "D", "v")
"""Lines and marks of the curves, which differ in a grey print, too."""
CLOSED, OPEN = "#2e7d32", "#d5d8dc"
FACE, HEIGHT, LEAN = 2.0, 5.6, np.tan(np.radians(20))
"""Drawn half width of the face and height in pitches; the picture of the probe is a scheme."""


@dataclass(frozen=True)
class Curve:
    """A curve by its name, and the tissue and the rate in m/s that it is of."""

    name: str
    tissue: str
    rate: float

    def steps(self, result: Result) -> list[dict[str, float]]:
        """Values of the steps that it joins."""
        names, of = result.scene_as(SwitchProbeScene).tissues, (self.tissue, self.rate)
        return [step.values for step in result.steps if (names[int(step.values["tissue"]) - 1], step.values["rate"]) == of]


@dataclass(frozen=True)
class CurveStyle:
    """How a curve is drawn: its colour, its line, and the marks of the switches on it, by matplotlib's names."""

    colour: str
    line: str
    mark: str

    @classmethod
    def cycled(cls) -> Iterator[CurveStyle]:
        """Those of the curves of a panel, one after another, without end."""
        yield from map(cls, cycle(COLOURS), cycle(LINES), cycle(MARKS))


@dataclass(frozen=True)
class Panel:
    """A panel of curves."""

    title: str
    curves: list[Curve]


class SwitchProbeFigures(ResultFigures):
    """The panel of a touch, force over depth by tissue, and by rate."""

    kind: Literal["switch_probe"] = "switch_probe"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``force_over_depth.png`` and ``switch_panel.png``, and ``ranking.png`` for several tissues."""
        if not result.steps:
            return {}
        drawn: dict[str, Drawing] = {"force_over_depth.png": Plot(lambda: force_over_depth_figure(result))}
        drawn["switch_panel.png"] = Plot(lambda: switch_panel_figure(result))
        if len(result.scene_as(SwitchProbeScene).tissues) > 1:
            drawn["tissues_by_rate.png"] = Plot(lambda: tissues_by_rate_figure(result))
        return drawn


def force_over_depth_figure(result: Result) -> Figure:
    """One panel per tissue, one curve per rate (Fig. 5.7); dots are what was read when switches closed."""
    scene = result.scene_as(SwitchProbeScene)
    rates = sorted({touch.rate for touch in scene.touches})
    panels = [Panel(tissue, [Curve(_rate(rate), tissue, rate) for rate in rates]) for tissue in scene.tissues]
    return _curves_figure(result, panels, "Force over depth", narrowest=6.4)


def tissues_by_rate_figure(result: Result) -> Figure:
    """One panel per rate, one curve per tissue (Fig. 5.8)."""
    scene = result.scene_as(SwitchProbeScene)
    panels = [Panel(_rate(rate), [Curve(tissue, tissue, rate) for tissue in scene.tissues]) for rate in sorted(scene.rates)]
    return _curves_figure(result, panels, "Tissues at the same rate")


def _rate(rate: float) -> str:
    return f"{1e3 * rate:g} mm/s"


def _curves_figure(result: Result, panels: list[Panel], title: str, *, narrowest: float = 0.0) -> Figure:
    size, words = (max(narrowest, 1.6 + 3.1 * len(panels)), 3.8), f"{title}; marks: read as each switch closed"
    with result_figure(result, size, below=words, title_size=SMALL_TITLE) as figure:
        axes = np.atleast_1d(figure.subplots(1, len(panels), sharey=True))
        for axis, panel in zip(axes, panels, strict=True):
            for style, curve in zip(CurveStyle.cycled(), panel.curves, strict=False):
                _draw_curve(axis, result, curve, style)
            _finish(axis, result, panel.title)
    return figure


def switch_panel_figure(result: Result) -> Figure:
    """The display of the array (Fig. 5.5): each switch with its force and time, the force over time, and the mean rate."""
    scene = result.scene_as(SwitchProbeScene)
    touch = scene.touches[0]
    rate = touch.mean_rate
    words = "no mean rate: not every switch closed" if rate is None else f"mean rate {1e3 * rate:.4g} mm/s"
    which = f"touch 1 of {len(scene.touches)}, " if len(scene.touches) > 1 else ""
    words = f"{which}{touch.tissue} at {_rate(touch.rate)}; {words}"
    with result_figure(result, (9.4, 3.7), below=words, title_size=SMALL_TITLE) as figure:
        probe, record = figure.subplots(1, 2, width_ratios=(1.1, 1))
        _draw_probe(probe, scene.switch_sides, touch)
        _draw_record(record, result, touch)
    return figure


def _draw_probe(axis: Axes, sides: tuple[str, ...], touch: RecordedTouch) -> None:
    """The section of the probe with its switches, lit if they closed, and what was read then."""
    corners = [(-FACE, 0), (FACE, 0), (FACE + HEIGHT * LEAN, HEIGHT), (-FACE - HEIGHT * LEAN, HEIGHT)]
    axis.add_patch(Polygon(corners, closed=True, facecolor="#eceff1", edgecolor="#30363d"))
    axis.add_patch(Rectangle((-0.7 * FACE, -0.3), 1.4 * FACE, 0.25, facecolor="#1f4e79"))
    axis.text(0, -0.55, "force sensor", ha="center", va="top", color="#1f4e79", fontsize=8)
    closed, start = {closing.switch: closing for closing in touch.closings}, touch.start or 0.0
    for number, side in enumerate(sides, 1):
        sign, closing = (1 if side == "right" else -1), closed.get(number)
        place = sign * (FACE + number * LEAN)
        axis.plot(place, number, "o", markersize=13, color=OPEN if closing is None else CLOSED, markeredgecolor="#30363d")
        axis.text(place, number, str(number), ha="center", va="center", color="k" if closing is None else "w", fontsize=8)
        words = "open" if closing is None else f"{closing.force:.3f} N\n{closing.time - start:.3f} s"
        axis.text(place + sign * 0.6, number, words, ha="left" if sign > 0 else "right", va="center", fontsize=8)
    axis.set(xlim=(-6.4, 6.4), ylim=(-1.1, HEIGHT + 0.2), aspect="equal")
    axis.set_axis_off()
    axis.set_title("switches: force and time since the touch", loc="left")


def _draw_record(axis: Axes, result: Result, touch: RecordedTouch) -> None:
    """The force of the first touch over time, with the moments at which switches closed."""
    steps = Curve(_rate(touch.rate), touch.tissue, touch.rate).steps(result)
    time, force = (np.array([values[name] for values in steps]) for name in ("time", "read_force"))
    start = touch.start or 0.0
    axis.plot(time - start, force, color=COLOURS[0], label="force sensor")
    for closing in touch.closings:
        axis.axvline(closing.time - start, color=CLOSED, linewidth=0.8, linestyle=":")
        axis.plot(closing.time - start, closing.force, "o", color=CLOSED, markersize=5)
        axis.annotate(str(closing.switch), (closing.time - start, closing.force), (-9, 4), textcoords="offset points", fontsize=8)
    axis.set(
        xlabel="time since the touch in s", ylabel="force in N", ylim=(min(0.0, 1.05 * force.min()), 1.1 * max(force.max(), 1e-9))
    )
    threshold = float(f"{result.scene_as(SwitchProbeScene).touch_threshold:.3g}")
    axis.set_title(f"threshold of the touch {format_quantity(threshold, 'N')}", loc="left")
    despined(axis)


def _draw_curve(axis: Axes, result: Result, curve: Curve, style: CurveStyle) -> None:
    steps = curve.steps(result)
    depth, force = (np.array([values[name] for values in steps]) for name in ("depth", "force"))
    loading = np.arange(len(depth)) <= int(depth.argmax()) if len(depth) else np.zeros(0, bool)
    axis.plot(1e3 * depth[loading], force[loading], style.line, color=style.colour, label=curve.name)
    time = np.array([values["time"] for values in steps])
    for touch in result.scene_as(SwitchProbeScene).touches:
        if (touch.tissue, touch.rate) == (curve.tissue, curve.rate):
            # where the probe was then: beside a tissue that yields, far deeper than the height of the switch
            at = 1e3 * np.interp([closing.time for closing in touch.closings], time[loading], depth[loading])
            axis.plot(at, [closing.force for closing in touch.closings], style.mark, color=style.colour, markersize=4)


def _finish(axis: Axes, result: Result, title: str) -> None:
    axis.set(xlabel="depth in mm", xlim=(0, 1e3 * result.scene_as(SwitchProbeScene).depth * 1.02))
    axis.set_title(title, loc="left")
    axis.set_ylim(0, 1.08 * max(step.values["force"] for step in result.steps))
    axis.legend(fontsize=8, loc="upper left")
    if axis.get_subplotspec().is_first_col():  # type: ignore[union-attr]
        axis.set_ylabel("force in N")
    despined(axis)
