"""Indentation: the deformed section under the body with its pressure, and the force against the displacement."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pydantic import TypeAdapter

from tactsim.display.canvas import despined, new_figure, png, scale_of, styled, weighted_percentiles
from tactsim.display.result_figures import Drawing, ResultFigures
from tactsim.display.section import Section, draw_body, draw_field, draw_mesh
from tactsim.interfaces import RigidBody
from tactsim.registry import tagged_union
from tactsim.results import Result, Status
from tactsim.units import format_quantity

Array = np.ndarray

SHOWN_RADII = 2.4
"""Half width of the picture in radii of the body: farther out the tissue is at rest."""

FORCE_COLOUR, RISE_COLOUR, SENSOR_COLOUR, FAILED_COLOUR = "#1f4e79", "#b8540a", "#d62728", "#b00020"
GRID = 700
"""Points per direction on which a body's outline is traced."""


class IndentationFigures(ResultFigures):
    """One figure: section and curve side by side."""

    kind: Literal["indentation"] = "indentation"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``indentation.png``, unless no step was accepted."""
        return {"indentation.png": lambda: png(indentation_figure(result))} if result.steps else {}


def indentation_figure(result: Result) -> Figure:
    """Section (if the result has fields) and force-displacement curve of an indentation."""
    with styled():
        has_section = bool(result.frames)
        figure = new_figure(11.0 if has_section else 6.0, 4.4)
        axes = figure.subplots(1, 2 if has_section else 1, squeeze=False, width_ratios=(1.5, 1) if has_section else None)[0]
        if has_section:
            _draw_section(axes[0], result)
        _draw_curve(axes[-1], result)
        figure.suptitle(_title(result), x=0.01, ha="left", fontsize=11, fontweight="bold")
        if result.status is not Status.CONVERGED:
            _mark_failure(figure, result)
    return figure


def _title(result: Result) -> str:
    given = str(result.details.get("title") or "")
    return given or f"Indentation by a rigid {result.details.get('body', {}).get('kind', 'body')}"


def _mark_failure(figure: Figure, result: Result) -> None:
    """The status and its reason across the foot of the figure, and a coloured frame."""
    last = format_quantity(result.steps[-1].values["displacement"], "m")
    words = f"{str(result.status).upper()} after a displacement of {last}: {result.reason}"
    figure.supxlabel(_shortened(words, 150), color=FAILED_COLOUR, fontsize=9.5, fontweight="bold")
    figure.patch.set(edgecolor=FAILED_COLOUR, linewidth=5)


def _shortened(words: str, most: int) -> str:
    return words if len(words) <= most else f"{words[: most - 1]}…"


def _draw_section(axis: Axes, result: Result) -> None:
    frame = result.frames[-1]
    section = Section(frame)
    pressure = np.asarray(frame.point_data["pressure [Pa]"]).ravel() / 1e3
    body: RigidBody | None = _body(result)
    height = 1e3 * (result.details.get("starting_height", 0.0) - frame.time)
    limits = _window(section, body, height)
    _draw_pressure(axis, section, pressure, limits)
    draw_mesh(axis, section)
    if body is not None:
        r, z = np.meshgrid(np.linspace(0, limits[0], GRID), np.linspace(limits[1], limits[2], GRID))
        points = np.stack([r.ravel(), z.ravel() - height]) * 1e-3
        draw_body(axis, body.signed_distance(points)[0].reshape(r.shape), (r, z))
        _draw_sensor(axis, result, body, height)
    axis.set(xlim=(-limits[0], limits[0]), ylim=limits[1:], aspect="equal", xlabel="radius in mm", ylabel="height in mm")
    axis.set_title(f"at a displacement of {format_quantity(frame.time, 'm')} (elements shown on the left)", loc="left")
    axis.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")
    despined(axis)


def _draw_pressure(axis: Axes, section: Section, pressure: Array, limits: tuple[float, float, float]) -> None:
    """The pressure in kPa with robust limits, so that the singular edges do not take all the colours."""
    seen = section.places[:, 0] <= limits[0]
    low, high = weighted_percentiles(pressure[seen], section.weights()[seen], (1, 99))
    low, high = (low, high) if high > low else (low - 0.5, high + 0.5)
    drawn = draw_field(axis, section, pressure, cmap="viridis", vmin=low, vmax=high)
    beyond = (bool(pressure[seen].min() < low), bool(pressure[seen].max() > high))
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[beyond]
    bar = axis.figure.colorbar(drawn, ax=axis, extend=extend, location="bottom", shrink=0.6, aspect=32, pad=0.02)
    bar.set_label(f"pressure in kPa (colours from the 1st to the 99th percentile of the area; largest {pressure.max():.4g} kPa)")
    bar.outline.set_linewidth(0.5)


def _window(section: Section, body: RigidBody | None, height: float) -> tuple[float, float, float]:
    """Half width, bottom and top of the picture in mm."""
    radius = 1e3 * float(getattr(body, "outer_radius", getattr(body, "radius", np.inf)))
    widest = float(section.places[:, 0].max())
    half = min(1.03 * widest, SHOWN_RADII * radius)
    bottom, top = section.places[:, 1].min(), section.places[section.places[:, 0] <= half, 1].max()
    margin = 0.03 * (top - bottom)
    return half, float(bottom - margin), float(max(top, height) + 0.2 * min(half, radius) + margin)


def _body(result: Result) -> Any:
    """The rigid body that the result describes, None in a result of a version that did not."""
    described = result.details.get("body")
    return TypeAdapter(tagged_union("tactsim.contact", RigidBody)).validate_python(described) if described else None


def _draw_sensor(axis: Axes, result: Result, body: RigidBody, height: float) -> None:
    """The inner sensor's plane across the hole."""
    recess, inner = result.details.get("recess"), getattr(body, "inner_radius", None)
    if recess is None or inner is None:
        return
    level, edge = height + 1e3 * recess, 1e3 * inner
    axis.plot([-edge, edge], [level, level], color=SENSOR_COLOUR, linewidth=1.8, zorder=4)
    axis.annotate(
        f"inner sensor\n{format_quantity(recess, 'm')} above\nthe face",
        (0.0, level),
        (0.0, 3.0),
        textcoords="offset points",
        ha="center",
        va="bottom",
        color=SENSOR_COLOUR,
        fontsize=7,
        zorder=5,
    )


def _draw_curve(axis: Axes, result: Result) -> None:
    displacement, force, rise = (_history(result, name) for name in ("displacement", "reaction_force", "tissue_rise"))
    along, length = scale_of(float(displacement.max()), "m")
    up, unit = scale_of(float(np.abs(force).max()), "N")
    axis.plot(displacement * along, force * up, ".-", color=FORCE_COLOUR, markersize=4)
    axis.set(xlabel=f"displacement in {length}", xlim=(0, None), ylim=(0, None))
    axis.set_ylabel(f"force on the body in {unit}", color=FORCE_COLOUR)
    axis.set_title(f"{len(result.steps)} accepted steps", loc="left")
    axis.margins(x=0.03, y=0.08)
    if np.isfinite(rise).all():
        _draw_rise(axis.twinx(), displacement * along, rise * 1e3, result)
    else:
        despined(axis)
    _mark_threshold(axis, result, along, up)
    _mark_last(axis, result, along, up)


def _draw_rise(axis: Axes, displacement: Array, rise: Array, result: Result) -> None:
    axis.plot(displacement, rise, "--", color=RISE_COLOUR)
    axis.set_ylabel("tissue rise in the hole in mm", color=RISE_COLOUR)
    axis.set_ylim(0, None)
    axis.spines["top"].set_visible(False)
    recess = result.details.get("recess")
    if recess is not None:
        axis.set_ylim(0, max(1.12e3 * recess, rise.max() * 1.05))
        axis.axhline(1e3 * recess, color=SENSOR_COLOUR, linewidth=0.9, linestyle=":")


def _mark_threshold(axis: Axes, result: Result, along: float, up: float) -> None:
    """A ring where the tissue touches the inner sensor, labelled with pressure and force."""
    names = ("threshold_displacement", "threshold_force", "threshold_pressure")
    if not all(name in result.quantities for name in names):
        return
    at, force, pressure = (result.quantities[name] for name in names)
    axis.plot(at.value * along, force.value * up, "o", color=FORCE_COLOUR, markersize=9, fillstyle="none", markeredgewidth=1.8)
    told = [format_quantity(q.value, q.unit) for q in (pressure, force, at)]
    axis.text(
        0.04,
        0.86,
        f"threshold\n{told[0]} on the annulus\n{told[1]} at {told[2]}",
        transform=axis.transAxes,
        va="top",
        color=FORCE_COLOUR,
    )


def _mark_last(axis: Axes, result: Result, along: float, up: float) -> None:
    """A cross on the last accepted step of a run that did not end as it should."""
    if result.status is Status.CONVERGED:
        return
    last = result.steps[-1].values
    at = (last["displacement"] * along, last["reaction_force"] * up)
    axis.plot(*at, "X", color=FAILED_COLOUR, markersize=9)
    words = "interrupted here" if result.status is Status.INTERRUPTED else "stopped here"
    _label(axis, at, f"{words}\n{format_quantity(last['displacement'], 'm')}", FAILED_COLOUR)


def _label(axis: Axes, at: tuple[float, float], text: str, colour: str) -> None:
    """Text beside a point, toward the middle of the axes."""
    x, y = axis.transLimits.transform(at)
    shift = (-26 if x > 0.5 else 12, -4 if y > 0.5 else 12)
    sides: dict[str, Any] = {"ha": "right" if x > 0.5 else "left", "va": "top" if y > 0.5 else "bottom"}
    axis.annotate(text, at, shift, textcoords="offset points", color=colour, zorder=6, **sides)


def _history(result: Result, name: str) -> Array:
    return np.array([step.values.get(name, np.nan) for step in result.steps])
