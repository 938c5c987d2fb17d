"""The deformed cut y = 0 of tissue in space under a rigid body, with its pressure."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from tactsim.array import Array
from tactsim.contact.tilted import Tilted
from tactsim.experiments.indentation.figures.contact_section import SHOWN_RADII, draw_inner_sensor
from tactsim.experiments.indentation.figures.section import Section, draw_body, draw_field, pressure_bar, pressure_scale
from tactsim.experiments.indentation.scene import Indentation3dScene
from tactsim.plotting.canvas import PRESSURE_COLOURS, despined
from tactsim.results import FieldFrame, Result
from tactsim.units import format_quantity

GRID = 700
"""Points per direction on which the body's outline is traced."""
_FACES = np.array([[0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 2, 3, 6, 9, 7]])
"""Nodes of the faces of a quadratic tetrahedron, as quadratic triangles, in the order of VTK."""


def cut(frame: FieldFrame) -> FieldFrame:
    """The faces of elements that lay in the plane y = 0, as six-node triangles with (x, z, 0) for coordinates."""
    flat = frame.points[:, 1] == 0.0
    faces = frame.cells["tetra10"][:, _FACES].reshape(-1, 6)
    owner = np.repeat(np.arange(len(frame.cells["tetra10"])), len(_FACES))
    inside = flat[faces].all(axis=1)
    _, first = np.unique(np.sort(faces[inside][:, :3], axis=1), axis=0, return_index=True)
    faces, owner = faces[inside][first], owner[inside][first]
    used, numbers = np.unique(faces, return_inverse=True)
    fields = {name: np.asarray(values)[used] for name, values in frame.point_data.items()}
    fields["displacement [m]"] = _in_plane(fields["displacement [m]"])
    regions = {"region [1]": np.asarray(frame.cell_data["region [1]"]).ravel()[owner]} if frame.cell_data else {}
    return FieldFrame(frame.time, _in_plane(frame.points[used]), {"triangle6": numbers.reshape(-1, 6)}, fields, regions)


def draw_cut(axis: Axes, result: Result) -> None:
    """The deformed cut of the last frame with its pressure, the body and the sensor's plane in the hole."""
    frame = result.frames[-1]
    section = Section(cut(frame))
    scene = result.scene_as(Indentation3dScene)
    body, height = scene.body, 1e3 * (scene.starting_height - frame.time)
    sides = (-1.0, 1.0) if scene.symmetry == "quarter" else (1.0,)
    limits = _window(section, body, height, mirrored=len(sides) > 1)
    _draw_pressure(axis, section, sides, limits)
    edges, outline = section.edges()
    for side in sides:
        mirror = np.array([side, 1.0])
        style: dict[str, Any] = {"colors": "k", "linewidths": 0.25, "alpha": 0.35, "rasterized": True}
        axis.add_collection(LineCollection(list(section.curves(edges) * mirror), **style))
        axis.add_collection(LineCollection(list(section.curves(edges[outline]) * mirror), colors="k", linewidths=0.9))
    x, z = np.meshgrid(np.linspace(*limits[0], GRID), np.linspace(*limits[1], GRID))
    points = np.stack([x.ravel(), np.zeros(x.size), z.ravel() - height]) * 1e-3
    distance = body.signed_distance(points)[0].reshape(x.shape)
    draw_body(axis, distance, (x, z), sides=(1.0,))
    _draw_sensor(axis, scene.recess, body, height)
    axis.set(xlim=limits[0], ylim=limits[1], aspect="equal", xlabel="x in mm", ylabel="height in mm")
    axis.set_title(f"cut y = 0 at a displacement of {format_quantity(frame.time, 'm')}", loc="left")
    despined(axis)


def _in_plane(points: Array) -> Array:
    return np.stack([points[:, 0], points[:, 2], np.zeros(len(points))], axis=1)


def _window(section: Section, body: Tilted, height: float, *, mirrored: bool) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits in mm of the picture along x and z."""
    x, z = section.places.T
    radius = 1e3 * body.contact_shape.reach
    right = min(1.03 * float(x.max()), SHOWN_RADII * radius)
    left = -right if mirrored else max(1.03 * float(x.min()), -SHOWN_RADII * radius)
    deepest = max(float(z.min()), -SHOWN_RADII * radius)
    top = max(float(z[(x >= left) & (x <= right)].max()), height) + 0.4 * min(right, radius)
    margin = 0.03 * (top - deepest)
    return (left, right), (deepest - margin, top + margin)


def _draw_pressure(axis: Axes, section: Section, sides: tuple[float, ...], limits: tuple[tuple[float, float], ...]) -> None:
    """The pressure with robust limits, so that the singular edges do not take all the colours."""
    (left, right), (bottom, _) = limits
    pressure = np.asarray(section.frame.point_data["pressure [Pa]"]).ravel()
    x, z = section.places.T
    seen = (x >= left) & (x <= right) & (z >= bottom)
    (low, high), factor, unit = pressure_scale(section, pressure, seen)
    drawn = draw_field(axis, section, factor * pressure, sides, cmap=PRESSURE_COLOURS, vmin=low, vmax=high)
    pressure_bar(axis, drawn, factor * pressure[seen], (low, high), unit)


def _draw_sensor(axis: Axes, recess: float | None, body: Tilted, height: float) -> None:
    """The inner sensor's plane across the hole."""
    inner = body.contact_shape.hole
    if recess is None or not inner:
        return
    ends = body.rotation @ np.array([[-inner, inner], [0.0, 0.0], [recess, recess]])
    draw_inner_sensor(axis, np.array([1e3 * ends[0], 1e3 * ends[2] + height]), recess)
