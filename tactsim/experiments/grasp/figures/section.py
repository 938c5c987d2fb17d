"""The vertical cut through a grasped block: deformed tissue with its pressure, inclusions, jaws and their taxels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.tri import Triangulation

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import LETTERS, TAXEL_COLOUR, drawn_millimetre, ending, inclusions_of, moment_of
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import (
    PRESSURE_COLOURS,
    REGION_COLOURS,
    TRACED,
    despined,
    extension,
    robust_limits,
    scale_of,
    with_minus,
)
from tactsim.plotting.plane_cut import PlaneCut, deformed, plane_cut
from tactsim.results import FieldFrame, Result
from tactsim.results.fields import CORNER_PRESSURE, PRESSURE

WIDTH, SURROUNDINGS, DRAWN, LOWEST, HIGHEST = 9.0, 2.2, 5.7, 3.2, 8.0
"""Width in inches of the figure of a section, height of its title, ticks and colours, width of what is drawn, and the least and
largest height of the figure.
"""
BESIDE = 1.16
"""Width of the picture over that of the undeformed block."""
JAW_SHOWN = 3.3
"""Height of the jaws in the picture, in `drawn_millimetre`."""
TAXEL_SHOWN = 0.55
"""Height of a taxel's mark in the jaw's face, in `drawn_millimetre`."""
LONGER = 1.2
"""An inclusion is cut across the horizontal axis along which it is this much longer than along the other."""
MOST_NAMED = 12
"""Most taxels along a cut of which each is named; of more, only some at even intervals."""
INCLUSION_COLOUR = "#000000"
NAME_LETTER, NAME_APART = 0.011, 6.0
"""Width of a letter of an inclusion's name, with some room, over that of the picture, and distance in points of one beside it."""


@dataclass(frozen=True)
class CuttingPlane:
    """A vertical plane: the axis across it, its level in m where the body is deformed, and the inclusion in it (0 if none)."""

    across: int
    level: float
    inclusion: int


def cutting_plane(frame: FieldFrame, size: Array) -> CuttingPlane:
    """The plane through the inclusion whose middle is the farthest from both jaws; a long one is cut across its length.

    ``size`` (3,) in m is that of the block.
    """
    places, inclusions = deformed(frame), inclusions_of(frame)
    if not inclusions:
        return CuttingPlane(1, float(size[1] / 2), 0)

    def height(nodes: Array) -> float:
        middle = (frame.points[nodes, 2].min() + frame.points[nodes, 2].max()) / 2
        return round(min(middle, size[2] - middle) / size[2], 6)

    number = max(inclusions, key=lambda k: (height(inclusions[k]), -k))
    reached = places[inclusions[number]]
    extent = np.ptp(reached, axis=0)
    axis = 0 if extent[0] > LONGER * extent[1] else 1
    return CuttingPlane(axis, float((reached[:, axis].min() + reached[:, axis].max()) / 2), number)


def section_size(result: Result) -> tuple[float, float]:
    """Width and height in inches of the figure of a section: that of a wide thin block is low, that of a tall one is high."""
    scene = result.scene_as(GraspScene)
    along = 1 - cutting_plane(result.frames[-1], scene.size).across
    shown = 1e3 * scene.size[2] + 2 * JAW_SHOWN * drawn_millimetre(scene.size)
    height = SURROUNDINGS + DRAWN * float(shown / (BESIDE * 1e3 * scene.size[along]))
    return WIDTH, float(np.clip(height, LOWEST, HIGHEST))


def draw_section(axis: Axes, result: Result) -> None:
    """The cut of the last frame with its pressure, or at rest with its regions."""
    frame, scene = result.frames[-1], result.scene_as(GraspScene)
    plane = cutting_plane(frame, scene.size)
    if result.steps:
        pressure = frame.cell_data.get(CORNER_PRESSURE, np.asarray(frame.point_data[PRESSURE]).ravel())
        cut = plane_cut(frame, plane.across, plane.level, np.asarray(pressure))
        _draw_pressure(axis, cut, [k for k, one in enumerate(scene.inclusions, 1) if one.shape.hollow])
    else:
        cut = plane_cut(frame, plane.across, plane.level, np.zeros(len(frame.points)))
        _draw_regions(axis, cut)
    _draw_outlines(axis, cut, result)
    limits = _window(cut, scene)
    drawn = [_draw_jaw(axis, scene, side, limits, plane) for side in JAWS]
    along = "yx"[plane.across]
    axis.set(xlim=limits[0], ylim=limits[1], aspect="equal", xlabel=f"{along} in mm", ylabel="z (height) in mm")
    middle = scene.named_inclusion(plane.inclusion) if plane.inclusion else "the block"
    place = f"cut at {'xy'[plane.across]} = {1e3 * plane.level:.3g} mm through the middle of {middle}"
    shown = ("\n" if moment_of(result) else "; ") + ending(result) if result.steps else ", at rest"
    axis.set_title(place + shown + ("" if any(drawn) else "\nno taxel is cut"), loc="left")
    despined(axis)


def _draw_pressure(axis: Axes, cut: PlaneCut, hollow: list[int]) -> None:
    """The pressure with robust limits; walls of hollow inclusions, far stiffer than the tissue, would take all colours."""
    areas, around = cut.areas() / 3, ~np.isin(cut.regions, hollow)
    low, high = robust_limits(cut.values[around].ravel(), np.repeat(areas[around], 3))
    factor, unit = scale_of(max(abs(low), abs(high)), "Pa")
    low, high, values = factor * low, factor * high, factor * cut.values.ravel()
    corners = 1e3 * cut.triangles.reshape(-1, 2)
    mesh = Triangulation(corners[:, 0], corners[:, 1], np.arange(len(corners)).reshape(-1, 3))
    style: dict[str, Any] = {"shading": "gouraud", "rasterized": True, "cmap": PRESSURE_COLOURS, "vmin": low, "vmax": high}
    drawn = axis.tripcolor(mesh, values, **style)
    extend = extension(values, (low, high))
    bar = axis.figure.colorbar(drawn, ax=axis, extend=extend, location="bottom", shrink=0.7, aspect=36, pad=0.02)
    extremes = with_minus(f"in this cut {values.min():.3g} to {values.max():.3g} {unit}")
    words = "as computed: it varies linearly within an element, so that steep changes show the elements"
    shares = "1st to 99th percentile of the area" + (" outside walls" if not around.all() else "")
    bar.set_label(f"pressure in the tissue in {unit} (colours: {shares}; {extremes})\n{words}")
    bar.outline.set_linewidth(0.5)


def _draw_regions(axis: Axes, cut: PlaneCut) -> None:
    """Tissue and inclusions, each in its colour."""
    colours = np.array(REGION_COLOURS)[cut.regions % len(REGION_COLOURS)]
    style: dict[str, Any] = {"facecolors": colours, "edgecolors": "face", "linewidths": 0.7, "rasterized": True}
    axis.add_collection(PolyCollection(list(1e3 * cut.triangles), **style))


def _draw_outlines(axis: Axes, cut: PlaneCut, result: Result) -> None:
    """The outline of the block, and with a white rim that of every inclusion, named."""
    inner = cut.between.max(axis=1) > 0
    segments = 1e3 * cut.segments
    axis.add_collection(LineCollection(list(segments[~inner]), colors="k", linewidths=0.9, capstyle="round"))
    axis.add_collection(LineCollection(list(segments[inner]), colors="w", linewidths=2.6, capstyle="round"))
    axis.add_collection(LineCollection(list(segments[inner]), colors=INCLUSION_COLOUR, linewidths=1.2, capstyle="round"))
    for number in sorted({int(k) for k in cut.between[inner].max(axis=1)}):
        ends = segments[(cut.between == number).any(axis=1)].reshape(-1, 2)
        _name_inclusion(axis, result.scene_as(GraspScene).named_inclusion(number), ends, segments[..., 0])


def _name_inclusion(axis: Axes, name: str, ends: Array, block: Array) -> None:
    """The name in an outline through points (n, 2) in mm, or beside one that it would hide in a block that has these x in mm."""
    (left, bottom), (right, top) = ends.min(axis=0), ends.max(axis=0)
    width = NAME_LETTER * len(name) * np.ptp(block)
    place, side, align = (left + right) / 2, 0.0, "center"
    if right - left < width:
        place, side, align = (right, 1.0, "left") if right + width < block.max() else (left, -1.0, "right")
    box = {"boxstyle": "round,pad=0.2", "facecolor": "w", "edgecolor": "none", "alpha": 0.8}
    style: dict[str, Any] = {"ha": align, "va": "center", "fontsize": 8, "bbox": box, "zorder": 4}
    axis.annotate(name, (place, (bottom + top) / 2), (NAME_APART * side, 0.0), textcoords="offset points", **style)


def _window(cut: PlaneCut, scene: GraspScene) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits in mm of the picture."""
    low, high = 1e3 * cut.triangles.min(axis=(0, 1)), 1e3 * cut.triangles.max(axis=(0, 1))
    margin, shown = 0.03 * (high[0] - low[0]), JAW_SHOWN * drawn_millimetre(scene.size)
    top = max(high[1], 1e3 * scene.place("upper")[2]) + shown
    bottom = min(low[1], 1e3 * scene.place("lower")[2]) - shown
    return (float(low[0] - margin), float(high[0] + margin)), (float(bottom), float(top))


def _draw_jaw(
    axis: Axes, scene: GraspScene, side: str, limits: tuple[tuple[float, float], tuple[float, float]], plane: CuttingPlane
) -> bool:
    """A jaw filled from its signed distance in the plane, its name, and marks of the taxels that the plane passes; whether it
    passes any.
    """
    jaw, place, across = scene.jaws[side], scene.place(side), plane.across
    middle, end = sum(limits[1]) / 2, limits[1][1 if side == "upper" else 0]
    along, height = np.meshgrid(np.linspace(*limits[0], TRACED), np.linspace(min(middle, end), max(middle, end), TRACED))
    points = np.empty((3, along.size))
    points[1 - across], points[2], points[across] = 1e-3 * along.ravel(), 1e-3 * height.ravel(), plane.level
    distance = jaw.signed_distance(points - place[:, None])[0].reshape(along.shape)
    if distance.min() > 0:
        return False
    axis.contourf(along, height, distance, levels=[-np.inf, 0.0], colors=["#c8ccd2"], zorder=3)
    axis.contour(along, height, distance, levels=[0.0], colors=["#30363d"], linewidths=1.1, zorder=3)
    passed = _draw_taxels(axis, scene, side, plane)
    unit = drawn_millimetre(scene.size)
    edge = limits[1][1] - 0.3 * unit if side == "upper" else limits[1][0] + 0.3 * unit
    where: dict[str, Any] = {"ha": "left", "va": "top" if side == "upper" else "bottom"}
    left = 1e3 * (place[1 - across] - (jaw.depth if across == 0 else jaw.width) / 2)
    axis.text(max(left, limits[0][0]) + 0.6 * unit, edge, f"{side} jaw", fontsize=8, zorder=5, **where)
    return passed


def _draw_taxels(axis: Axes, scene: GraspScene, side: str, plane: CuttingPlane) -> bool:
    """Marks of the taxels of the row or column that the plane passes, named as in Fig. 6.3 of the thesis; if there is one."""
    across, jaw, place = plane.across, scene.jaws[side], scene.place(side)
    fixed = (plane.level - place[across]) / jaw.rotation[across, across]
    passed, height = scene.matrix.borders("xy"[across]), TAXEL_SHOWN * drawn_millimetre(scene.size)
    hit = np.flatnonzero((passed[:, 0] <= fixed) & (fixed <= passed[:, 1]))
    for index in hit:
        borders = scene.matrix.borders("yx"[across])
        every = -(-len(borders) // MOST_NAMED)
        for number, (low, high) in enumerate(borders):
            corners = np.zeros((3, 4))
            corners[1 - across], corners[across] = [low, high, high, low], fixed
            corners[2] = np.array([0.0, 0.0, 1e-3, 1e-3]) * height
            shown = 1e3 * (jaw.rotation @ corners + place[:, None])
            axis.fill(shown[1 - across], shown[2], facecolor=TAXEL_COLOUR, edgecolor="#30363d", linewidth=0.5, zorder=4)
            if number % every:
                continue
            row, column = (index, number) if across == 1 else (number, index)
            above: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 7, "zorder": 5}
            normal = 2.2 * height * jaw.rotation[2, 2]
            axis.text(shown[1 - across].mean(), shown[2].mean() + normal, f"{LETTERS[side]}{row + 1},{column + 1}", **above)
    return bool(len(hit))
