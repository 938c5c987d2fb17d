"""The deformed section of tissue under a rigid body, with its pressure and the inner sensor: of a section, or cut from space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tactsim.array import Array
from tactsim.experiments.indentation.figures.section import (
    Section,
    draw_body,
    draw_field,
    draw_mesh,
    draw_regions,
    pressure_bar,
    pressure_scale,
)
from tactsim.experiments.indentation.scene import PressedBodyScene
from tactsim.plotting.canvas import PRESSURE_COLOURS, TRACED, despined
from tactsim.results import Result
from tactsim.results.fields import PRESSURE
from tactsim.units import format_quantity

SHOWN_RADII = 2.4
"""Half width of the picture in radii of the body: farther out the tissue is at rest."""
SENSOR_COLOUR = "#d62728"
WORDS = 0.22
"""Height of the three lines above the inner sensor, over half the width of the picture."""


@dataclass(frozen=True, eq=False)
class PressedSection:
    """A section and the body above it; lengths in mm.

    Attributes
    ----------
    section : the tissue
    scene : the body and its sensor
    height : of the body's reference point
    limits : of the picture, along the horizontal and the vertical axis
    sides : 1.0, and -1.0 too if the mirror image of the tissue is shown
    meshed : those of the sides on which elements are drawn
    turn : matrix (3, 3) from the axes of the body to those of the tissue; None for an axisymmetric section
    along : horizontal axis of a section of tissue in 3D, 0 or 1
    """

    section: Section
    scene: PressedBodyScene
    height: float
    limits: tuple[tuple[float, float], tuple[float, float]]
    sides: tuple[float, ...]
    meshed: tuple[float, ...]
    turn: Array | None = None
    along: int = 0

    def draw(self, axis: Axes, xlabel: str, title: str, *, at_rest: bool) -> None:
        """Everything, with the pressure in colours, or at rest with the regions."""
        if at_rest:
            draw_regions(axis, self.section, self.sides)
        else:
            self._draw_pressure(axis)
        draw_mesh(axis, self.section, self.sides, self.meshed)
        self._draw_body(axis)
        if self.scene.recess is not None and self.scene.body.contact_shape.hole:
            self._draw_sensor(axis, self.scene.recess, self.scene.body.contact_shape.hole)
        axis.set(xlim=self.limits[0], ylim=self.limits[1], aspect="equal", xlabel=xlabel, ylabel="height in mm")
        axis.set_title(title, loc="left")
        despined(axis)

    def _draw_pressure(self, axis: Axes) -> None:
        """The pressure with robust limits, so that the singular edges do not take all the colours."""
        (left, right), (bottom, _) = self.limits
        pressure = np.asarray(self.section.frame.point_data[PRESSURE]).ravel()
        x, z = self.section.places.T
        seen = (x >= left) & (x <= right) & (z >= bottom)
        (low, high), factor, unit = pressure_scale(self.section, pressure, seen)
        drawn = draw_field(axis, self.section, factor * pressure, self.sides, cmap=PRESSURE_COLOURS, vmin=low, vmax=high)
        pressure_bar(axis, drawn, factor * pressure[seen], (low, high), unit)

    def _draw_body(self, axis: Axes) -> None:
        """The body filled from its signed distance; an axisymmetric one is traced from the axis on, and mirrored."""
        mirrored, (left, right) = self.turn is None, self.limits[0]
        x, z = np.meshgrid(np.linspace(0.0 if mirrored else left, right, TRACED), np.linspace(*self.limits[1], TRACED))
        points = np.zeros((2 if mirrored else 3, x.size))
        points[self.along], points[-1] = x.ravel(), z.ravel() - self.height
        distance = self.scene.body.signed_distance(points * 1e-3)[0].reshape(x.shape)
        draw_body(axis, distance, (x, z), sides=(-1.0, 1.0) if mirrored else (1.0,))

    def _draw_sensor(self, axis: Axes, recess: float, hole: float) -> None:
        """The plane of the inner sensor across the hole, with its recess."""
        ends = np.zeros((3, 2))
        ends[self.along], ends[2] = (-hole, hole), recess
        ends = (np.eye(3) if self.turn is None else self.turn) @ ends
        x, z = 1e3 * ends[self.along], 1e3 * ends[2] + self.height
        axis.plot(x, z, color=SENSOR_COLOUR, linewidth=1.8, zorder=4)
        words = f"inner sensor\n{format_quantity(recess, 'm')} above\nthe face"
        style: dict[str, Any] = {"ha": "center", "va": "bottom", "color": SENSOR_COLOUR, "fontsize": 7, "zorder": 5}
        axis.annotate(words, (x.mean(), z.mean()), (0.0, 3.0), textcoords="offset points", **style)


def draw_contact_section(axis: Axes, result: Result, displacement: float = 0.0, remark: str = "") -> None:
    """The axisymmetric section of the last frame under the body at a displacement in m, both halves, elements on the left.

    A ``remark`` stands below the words on the moment.
    """
    section, scene = Section(result.frames[-1]), result.scene_as(PressedBodyScene)
    height = 1e3 * (scene.starting_height - displacement)
    half, bottom, top = _window(section, 1e3 * scene.body.contact_shape.reach, height)
    top = max(top, top_of_words(scene, height, half))
    shown = PressedSection(section, scene, height, ((-half, half), (bottom, top)), sides=(-1.0, 1.0), meshed=(-1.0,))
    words = "\n".join(part for part in (f"{moment_in_words(result, displacement)} (elements shown on the left)", remark) if part)
    shown.draw(axis, "radius in mm", words, at_rest=result.at_rest)
    axis.xaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")


def moment_in_words(result: Result, displacement: float) -> str:
    """When a section is shown: at a displacement in m, or at rest, with the size of its mesh."""
    if result.at_rest:
        return f"at rest: {result.scene_as(PressedBodyScene).solver.size_in_words}"
    return f"at a displacement of {format_quantity(displacement, 'm')}"


def top_of_words(scene: PressedBodyScene, height: float, half: float) -> float:
    """Height in mm that the words above an inner sensor need in a picture of a half width in mm; the body's if there is none."""
    sensor = scene.recess is not None and scene.body.contact_shape.hole > 0
    return height + 1e3 * (scene.recess or 0.0) + WORDS * half if sensor else height


def _window(section: Section, radius: float, height: float) -> tuple[float, float, float]:
    """Half width, bottom and top of the picture in mm, under a body of a radius and at a height in mm, which may be deep down."""
    half = min(1.03 * float(section.places[:, 0].max()), SHOWN_RADII * radius)
    bottom, top = max(section.places[:, 1].min(), min(0.0, height) - half), section.places[section.places[:, 0] <= half, 1].max()
    margin = 0.03 * (top - bottom)
    return half, float(bottom - margin), float(max(top, height) + 0.2 * min(half, radius) + margin)
