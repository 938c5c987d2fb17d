"""A boundary value problem: the deformed body with its von Mises stress, and what was asked of it over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from tactsim.array import Array
from tactsim.contact.turned import Turned
from tactsim.experiments.boundary_value.asked import place_in_words
from tactsim.experiments.boundary_value.conditions import AnyCondition, BodyForceCondition, PointCondition
from tactsim.experiments.boundary_value.figures.course import draw_course
from tactsim.experiments.boundary_value.scene import BoundaryValueScene, TouchingBody
from tactsim.experiments.boundary_value.setup import BoundaryValueSetup
from tactsim.interfaces import Drawing
from tactsim.mesh.quadratic import row_numbers
from tactsim.plotting.canvas import (
    PRESSURE_COLOURS,
    REGION_COLOURS,
    SKETCH,
    TRACED,
    Plot,
    SingleFigure,
    despined,
    extension,
    result_figure,
    robust_limits,
    scale_of,
)
from tactsim.plotting.plane_cut import FACES, QUARTERS
from tactsim.results import FieldFrame, Result
from tactsim.results.fields import DISPLACEMENT, VON_MISES
from tactsim.schema_of_model import unit_at
from tactsim.units import format_quantity

TITLE = "Boundary value problem"
VIEW = np.array([0.55, -0.75, 0.40])
"""Direction from a body in 3D to the eye."""
RIGID_COLOUR = "#c8ccd2"
STRESSED, SPECK = 0.1, 0.15
"""Part of the top of the colours from which a place counts as stressed, and part of the body's size below which such places are a
speck in its picture."""
RIM = 0.15
"""What is shown beside the body's edge there, over the size of the stressed part."""


class BoundaryValueFigures(SingleFigure):
    """The body and the course side by side."""

    kind: Literal["boundary_value_problem"] = "boundary_value_problem"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """The one figure, or of what is at rest a sketch."""
        return {SKETCH: Plot(lambda: sketch_figure(result))} if result.at_rest else super().drawings(result)

    def figure(self, result: Result) -> Figure:
        """The deformed body of the last frame, if there is one, and the numbers that were asked for over time."""
        scene, body = result.scene_as(BoundaryValueScene), bool(result.frames)
        where = f" at {format_quantity(result.steps[-1].values['time'], 's')}"
        beside, ratio = (4.0, 1.0) if len(result.steps) > 1 else (2.0, 0.5)  # curves, or numbers alone
        with result_figure(result, (6.0 + body * beside, 4.2), TITLE, where=where) as figure:
            axes = figure.subplots(1, 1 + body, squeeze=False, width_ratios=(1.2, ratio) if body else None)[0]
            if body:
                draw_body(axes[0], result.frames[-1], scene.dimension, scene.touching)
            draw_course(axes[-1], result, scene)
        return figure


def sketch_figure(result: Result) -> Figure:
    """The body at rest with its mesh, the faces on which something is prescribed, and the rigid bodies at first touch."""
    scene, frame = result.scene_as(BoundaryValueScene), result.frames[-1]
    flat = scene.dimension != "3d"
    with result_figure(result, (8.5, 4.6), TITLE) as figure:
        axis = figure.add_subplot()
        places = 1e3 * frame.points
        shown = places[:, :2] if flat else _projected(places)
        faces = frame.cells["triangle6"] if flat else _outside(frame, places)[0]
        style: dict[str, Any] = {"facecolors": REGION_COLOURS[0], "edgecolors": "0.6", "linewidths": 0.4}
        axis.add_collection(PolyCollection(list(shown[faces[:, :3]]), **style))
        axis.autoscale_view()
        axis.margins(0.12)
        if isinstance(result.experiment, BoundaryValueSetup):
            _draw_conditions(axis, result.experiment)
        for number, touching in enumerate(scene.touching, 1):
            if flat:
                _draw_rigid(axis, touching, touching.place)
            axis.plot([], [], "s", color=RIGID_COLOUR, label=f"rigid body {number}: {touching.body.kind}")
        axis.set_title(f"at rest: {scene.solver.size_in_words}", loc="left")
        _framed(axis, scene.dimension)
        if axis.get_legend_handles_labels()[1]:
            figure.legend(loc="outside right center", fontsize=8)
    return figure


def _draw_conditions(axis: Axes, problem: BoundaryValueSetup) -> None:
    """The faces and points on which something is prescribed, each with its words in the legend."""
    parts, flat = problem.parts, problem.dimension != "3d"
    nodes = 1e3 * parts.domain.mesh.nodes
    shown = nodes if flat else _projected(nodes)
    for number, condition in enumerate(problem.conditions):
        words, colour = _in_words(condition), f"C{number % 10}"
        if isinstance(condition, PointCondition):
            axis.plot(*shown[parts.node(condition.at)], "o", color=colour, label=words)
            continue
        if isinstance(condition, BodyForceCondition):
            axis.plot([], [], " ", label=words)
            continue
        facets = parts.facets(condition)
        if flat:
            drawn: Any = LineCollection(list(shown[facets[:, [0, 2, 1]]]), colors=colour, linewidths=3, label=words)
        else:
            style: dict[str, Any] = {"facecolors": colour, "alpha": 0.5, "edgecolors": colour, "linewidths": 0.4}
            drawn = PolyCollection(list(shown[facets[_facing(nodes[facets[:, :3]])][:, :3]]), label=words, **style)
        axis.add_collection(drawn, autolim=False)


def _in_words(condition: AnyCondition) -> str:
    """Where a condition acts and what it prescribes, at a factor of one."""
    kind, where, of = condition.kind, getattr(condition, "face", None), type(condition)
    sizes = {name: size for name in of.model_fields if isinstance(size := getattr(condition, name), float)}
    given = [
        (f"{name} = " if len(name) == 1 else "") + format_quantity(size, unit_at(of, {}, (name,))) for name, size in sizes.items()
    ]
    place = f"point {place_in_words(condition.at)}" if isinstance(condition, PointCondition) else where or "whole body"
    return f"{place}: {' '.join([kind.replace('point', 'displacement'), ', '.join(given)]).strip()}"


def _draw_rigid(axis: Axes, touching: TouchingBody, place: Sequence[float]) -> None:
    """A rigid body at its place in m in the plane, filled from its signed distance within the picture."""
    (left, right), (bottom, top) = axis.get_xlim(), axis.get_ylim()
    x, y = np.meshgrid(np.linspace(left, right, TRACED), np.linspace(bottom, top, TRACED))
    body = Turned.of(touching.body, touching.axis)
    points = 1e-3 * np.array([x.ravel(), y.ravel()]) - np.array(place)[:, None]
    distance = body.signed_distance(points)[0].reshape(x.shape)
    axis.contourf(x, y, distance, levels=[-np.inf, 0.0], colors=[RIGID_COLOUR], zorder=3)
    axis.set(xlim=(left, right), ylim=(bottom, top))


def draw_body(axis: Axes, frame: FieldFrame, dimension: str, touching: Sequence[TouchingBody] = ()) -> None:
    """The deformed body, each element in the colour of its von Mises stress, and in 2D the rigid bodies where they came to."""
    places = 1e3 * (frame.points + frame.point_data[DISPLACEMENT])
    polygons, owners = _section(frame) if "triangle6" in frame.cells else _surface(frame, places)
    flat = places[:, :2] if "triangle6" in frame.cells else _projected(places)
    stress = np.asarray(frame.cell_data[VON_MISES]).ravel()
    factor, unit = scale_of(float(stress.max()), "Pa")
    values, corners = factor * stress[owners], flat[polygons]
    weights = np.ones(len(values))
    style: dict[str, Any] = {"cmap": PRESSURE_COLOURS, "edgecolors": "face", "linewidths": 0.2, "rasterized": True}
    drawn = PolyCollection(list(corners), array=values, **style)
    axis.add_collection(drawn)
    axis.autoscale_view()
    words = f"deformed, at {format_quantity(frame.time, 's')}"
    stressed = values > STRESSED * robust_limits(values, weights)[1]
    if dimension != "3d" and _frame_stressed(axis, corners[stressed], corners):
        words += "; the stressed part"
        weights = _areas_shown(axis, corners)
    shown = weights > 0
    low, high = robust_limits(values[shown], weights[shown])
    drawn.set_clim(low, high)
    beyond = extension(values[shown], (low, high))
    bar = axis.figure.colorbar(drawn, ax=axis, extend=beyond, location="bottom", shrink=0.6, aspect=32)
    limits = "" if beyond == "neither" else "\n(colours: 1st to 99th percentile of what is seen)"
    bar.set_label(f"von Mises stress in {unit}, one value for each element{limits}")
    bar.outline.set_linewidth(0.5)
    rigid = [] if dimension == "3d" else [(one, one.reached) for one in touching if one.reached is not None]
    for one, place in rigid:
        _draw_rigid(axis, one, place)
    axis.set_title(words + ("; grey: rigid" if rigid else ""), loc="left")
    _framed(axis, dimension)


def _frame_stressed(axis: Axes, stressed: Array, body: Array) -> bool:
    """Show only the neighbourhood of a body's stressed triangles (n, 3, 2), with a rim, if they are a speck of it, as under a
    punch; whether that was done.
    """
    if not len(stressed):
        return False
    least, most = stressed.min(axis=(0, 1)), stressed.max(axis=(0, 1))
    first, last = body.min(axis=(0, 1)), body.max(axis=(0, 1))
    reach = float((most - least).max())
    if reach > SPECK * float((last - first).max()):
        return False
    middle = (least + most) / 2
    low, high = np.maximum(middle - 1.5 * reach, first - RIM * reach), np.minimum(middle + 1.5 * reach, last + RIM * reach)
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return True


def _areas_shown(axis: Axes, corners: Array) -> Array:
    """Area (n,) of each triangle (n, 3, 2) whose middle is in the picture, 0 of the others."""
    sides, middles = corners[:, 1:] - corners[:, :1], corners.mean(axis=1)
    limits = np.array([axis.get_xlim(), axis.get_ylim()])
    inside = ((middles >= limits[:, 0]) & (middles <= limits[:, 1])).all(axis=1)
    return np.abs(np.linalg.det(sides)) / 2 * inside


def _framed(axis: Axes, dimension: str) -> None:
    """Names the axes of a section; a body in 3D has none."""
    axis.set_aspect("equal")
    if dimension == "3d":
        axis.set_axis_off()
    else:
        names = ("r", "z") if dimension == "axisymmetric" else ("x", "y")
        axis.set(xlabel=f"{names[0]} in mm", ylabel=f"{names[1]} in mm")
        despined(axis)


def _section(frame: FieldFrame) -> tuple[Array, Array]:
    """Triangles (T, 3) of a section, four to an element, and their elements (T,)."""
    elements = frame.cells["triangle6"]
    return elements[:, QUARTERS].reshape(-1, 3), np.repeat(np.arange(len(elements)), len(QUARTERS))


def _surface(frame: FieldFrame, places: Array) -> tuple[Array, Array]:
    """Triangles (T, 3) of the surface that face the eye, the farthest first, and their elements (T,)."""
    faces, owners = _outer_faces(frame)
    triangles = faces[:, QUARTERS].reshape(-1, 3)
    seen = _facing(places[triangles])
    return triangles[seen], np.repeat(owners, len(QUARTERS))[seen]


def _outside(frame: FieldFrame, places: Array) -> tuple[Array, Array]:
    """Faces (k, 6) of the surface that face the eye, the farthest first, and their elements (k,)."""
    faces, owners = _outer_faces(frame)
    seen = _facing(places[faces[:, :3]])
    return faces[seen], owners[seen]


def _outer_faces(frame: FieldFrame) -> tuple[Array, Array]:
    """Faces (F, 6) of one element only, and their elements (F,)."""
    faces = frame.cells["tetra10"][:, FACES].reshape(-1, 6)
    _, first, count = np.unique(row_numbers(np.sort(faces[:, :3], axis=1)), return_index=True, return_counts=True)
    outside = first[count == 1]
    return faces[outside], outside // len(FACES)


def _facing(corners: Array) -> Array:
    """Indices of those of the triangles with corners (k, 3, 3) that face the eye, the farthest first."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    seen = np.flatnonzero(normal @ VIEW > 0)
    return seen[np.argsort(corners[seen].mean(axis=1) @ VIEW)]


def _projected(places: Array) -> Array:
    """Places (n, 2) of points (n, 3) as the eye sees them, z upwards."""
    back = VIEW / np.linalg.norm(VIEW)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    return np.column_stack([places @ right, places @ np.cross(back, right)])
