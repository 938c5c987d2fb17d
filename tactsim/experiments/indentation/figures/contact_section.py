"""The deformed section under a rigid body, with its pressure and the inner sensor."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tactsim.array import Array
from tactsim.experiments.indentation.figures.section import (
    Section,
    draw_body,
    draw_field,
    draw_mesh,
    pressure_bar,
    pressure_scale,
)
from tactsim.experiments.indentation.scene import PressedBodyScene
from tactsim.interfaces import RigidBody
from tactsim.plotting.canvas import PRESSURE_COLOURS, despined
from tactsim.results import Result
from tactsim.units import format_quantity

SHOWN_RADII = 2.4
"""Half width of the picture in radii of the body: farther out the tissue is at rest."""
SENSOR_COLOUR = "#d62728"
GRID = 700
"""Points per direction on which a body's outline is traced."""
WORDS = 0.22
"""Height of the three lines above the inner sensor, over half the width of the picture."""


def draw_contact_section(axis: Axes, result: Result, displacement: float) -> None:
    """The deformed section of the last frame with its pressure, under the body at a displacement in m."""
    frame = result.frames[-1]
    section = Section(frame)
    pressure = np.asarray(frame.point_data["pressure [Pa]"]).ravel()
    scene = result.scene_as(PressedBodyScene)
    body, height = scene.body, 1e3 * (scene.starting_height - displacement)
    limits = _window(section, body, height)
    if scene.recess is not None and body.contact_shape.hole:
        limits = (*limits[:2], max(limits[2], height + 1e3 * scene.recess + WORDS * limits[0]))
    _draw_pressure(axis, section, pressure, limits)
    draw_mesh(axis, section)
    r, z = np.meshgrid(np.linspace(0, limits[0], GRID), np.linspace(limits[1], limits[2], GRID))
    points = np.stack([r.ravel(), z.ravel() - height]) * 1e-3
    draw_body(axis, body.signed_distance(points)[0].reshape(r.shape), (r, z))
    _draw_sensor(axis, scene, height)
    axis.set(xlim=(-limits[0], limits[0]), ylim=limits[1:], aspect="equal", xlabel="radius in mm", ylabel="height in mm")
    axis.set_title(f"at a displacement of {format_quantity(displacement, 'm')} (elements shown on the left)", loc="left")
    axis.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")
    despined(axis)


def _draw_pressure(axis: Axes, section: Section, pressure: Array, limits: tuple[float, float, float]) -> None:
    """The pressure with robust limits, so that the singular edges do not take all the colours."""
    seen = (section.places[:, 0] <= limits[0]) & (section.places[:, 1] >= limits[1])
    (low, high), factor, unit = pressure_scale(section, pressure, seen)
    values = factor * pressure
    drawn = draw_field(axis, section, values, cmap=PRESSURE_COLOURS, vmin=low, vmax=high)
    pressure_bar(axis, drawn, values[seen], (low, high), unit)


def _window(section: Section, body: RigidBody, height: float) -> tuple[float, float, float]:
    """Half width, bottom and top of the picture in mm."""
    radius = 1e3 * body.contact_shape.reach
    widest = float(section.places[:, 0].max())
    half = min(1.03 * widest, SHOWN_RADII * radius)
    bottom, top = max(section.places[:, 1].min(), -half), section.places[section.places[:, 0] <= half, 1].max()
    margin = 0.03 * (top - bottom)
    return half, float(bottom - margin), float(max(top, height) + 0.2 * min(half, radius) + margin)


def _draw_sensor(axis: Axes, scene: PressedBodyScene, height: float) -> None:
    """The inner sensor's plane across the hole."""
    recess, inner = scene.recess, scene.body.contact_shape.hole
    if recess is None or not inner:
        return
    level, edge = height + 1e3 * recess, 1e3 * inner
    draw_inner_sensor(axis, np.array([[-edge, edge], [level, level]]), recess)


def draw_inner_sensor(axis: Axes, ends: Array, recess: float) -> None:
    """The plane of the sensor in a hole between its ends (2, 2) in mm, one in each column, with its recess in m."""
    axis.plot(*ends, color=SENSOR_COLOUR, linewidth=1.8, zorder=4)
    words = f"inner sensor\n{format_quantity(recess, 'm')} above\nthe face"
    style: dict[str, Any] = {"ha": "center", "va": "bottom", "color": SENSOR_COLOUR, "fontsize": 7, "zorder": 5}
    axis.annotate(words, tuple(ends.mean(axis=1)), (0.0, 3.0), textcoords="offset points", **style)
