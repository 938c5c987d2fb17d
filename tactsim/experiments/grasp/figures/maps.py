"""The two pressure maps of a grasp: every taxel in its place on the jaw, both jaws on one scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import (
    LETTERS,
    TAXEL_COLOUR,
    LoadedTaxels,
    PressureScale,
    drawn_millimetre,
    named_lines,
)
from tactsim.experiments.grasp.figures.viewed import outline, true_bodies
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces.solid import Solid
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import PRESSURE_COLOURS, ink_on, with_minus
from tactsim.plotting.plane_cut import OUTER, interfaces
from tactsim.results import Result

MOST_NAMED, NAME = 5, 0.42
"""Matrices with more rows or columns than this, or with a smaller pitch in inches, have the first and the last one named."""
MOST_BORDERED = 100
"""Matrices with more taxels than this have no borders, which would cover the colours."""
FITTING, LARGEST, SMALLEST = 78.0, 9.0, 5.0
"""Size in points of a letter that fills a taxel of an inch alone, and the largest and smallest size of those of a pressure."""
MAP, WIDEST, HIGHEST = 3.05, 7.0, 2.4
"""Longer side in inches of a map beside the other, and width and height within which a map below the other stays."""
WIDE, LONGEST = 2.0, 2.0
"""Width over depth of maps that stand below each other, and depth over width from which on a map is no longer drawn longer."""
WIDTH, AROUND_MAPS, BETWEEN_MAPS = 9.0, 1.95, 0.7
"""Width in inches of the figure, and height of its title and colours, and of what is between maps below each other."""
ROUND_OFF = 1e-9
"""Relative distance from the upper face of a node that lies on it."""
BESIDE = 0.6
"""Distance of the names of rows and columns from the jaw, in `drawn_millimetre`; so is that of the axes, `AROUND`."""
AROUND = 1.0


@dataclass(frozen=True)
class MapsLayout:
    """How the two maps stand in their figure; lengths in inches.

    Attributes
    ----------
    rows, columns : of the maps
    longer_side : of each map
    size : of the figure
    """

    rows: int
    columns: int
    longer_side: float
    size: tuple[float, float]

    @classmethod
    def of(cls, scene: GraspScene) -> MapsLayout:
        """Beside each other, or if they are wide below each other."""
        wide, deep = np.max([high - low for low, high in (_extent(scene, side) for side in JAWS)], axis=0).tolist()
        rows = 2 if wide > WIDE * deep else 1
        side = min(WIDEST, HIGHEST * wide / deep) if rows > 1 else MAP * min(max(deep / wide, 1.0), LONGEST)
        height = AROUND_MAPS + rows * side * min(deep / wide, 1.0) + BETWEEN_MAPS * (rows - 1)
        return cls(rows, 3 - rows, side, (WIDTH, height))


@dataclass(frozen=True)
class Numbering:
    """How pressures are written into the taxels of a jaw.

    Attributes
    ----------
    digits : of the highest pressure
    unit : behind each, with a space before it, and the force beneath it; empty if neither has room
    letters : their size in points
    """

    digits: int
    unit: str
    letters: float

    @classmethod
    def of(cls, grasp: LoadedTaxels, side: str, scale: PressureScale) -> Numbering | None:
        """The fullest that is legible; None if none is."""
        room = FITTING * grasp.scene.matrix.size * _inches_per_metre(grasp.scene, side)
        for digits, unit in ((3, f" {scale.unit}"), (3, ""), (2, "")):
            written = [_pressure(value, scale, digits) for value in grasp.pressures[side].ravel()]
            letters = min(room / (max(map(len, written)) + len(unit)), LARGEST)
            if letters >= SMALLEST:
                return cls(digits, unit, letters)
        return None


def draw_maps(axes: Sequence[Axes], grasp: LoadedTaxels) -> None:
    """The upper and the lower jaw seen from above, with one colour bar."""
    scale, bodies = grasp.pressure_scale, list(true_bodies(grasp.scene))
    for axis, side in zip(axes, JAWS, strict=True):
        _draw_matrix(axis, grasp, side, scale)
        _draw_surroundings(axis, grasp.scene, side, bodies)
        factor, unit = grasp.force_scale
        force = _digits(float(factor * grasp.forces[side].sum()), 3)
        axis.set_title(f"{side} jaw ({LETTERS[side]}): {force} {unit} on the taxels", loc="left")
        _seen_from_above(axis)
        axis.tick_params(length=2.5)
    if MapsLayout.of(grasp.scene).columns > 1:
        axes[1].set_ylabel("")
    else:
        axes[0].set_xlabel("")
    bar = axes[0].figure.colorbar(
        ScalarMappable(scale.norm, PRESSURE_COLOURS), ax=list(axes), location="bottom", shrink=0.7, aspect=40, pad=0.02
    )
    numbered = [numbering for side in JAWS if (numbering := Numbering.of(grasp, side, scale))]
    small = "; beneath it the force" if any(numbering.unit for numbering in numbered) else ""
    dashed = "undeformed block" + (" and outline of the inclusions" if bodies else "")
    bar.set_label(
        f"mean pressure on the taxel in {scale.unit}, one scale for both jaws{small}\nboth seen from above; dashed: {dashed}"
    )
    bar.outline.set_linewidth(0.5)


def draw_plan(axis: Axes, result: Result) -> None:
    """The block at rest from above: the elements of its upper face, the taxels of the upper jaw, and the inclusions."""
    scene, frame = result.scene_as(GraspScene), result.frames[-1]
    size = 1e3 * scene.matrix.size
    _draw_surroundings(axis, scene, "upper", list(true_bodies(scene)))
    columns, rows = (scene.borders(along, "upper") for along in "xy")
    squares = [Rectangle((x, y), size, size) for x in columns[:, 0] for y in rows[:, 0]]
    axis.add_collection(
        PatchCollection(squares, facecolor=TAXEL_COLOUR, edgecolor="#30363d", linewidth=0.6, alpha=0.45, zorder=2)
    )
    faces, between = interfaces(frame)
    upper = faces[(between[:, 0] == OUTER) & (frame.points[faces, 2] > scene.size[2] * (1 - ROUND_OFF)).all(axis=1)]
    outlines = 1e3 * frame.points[upper[:, [0, 1, 2, 0]], :2]
    style: dict[str, Any] = {"colors": "k", "linewidths": 0.3, "alpha": 0.6, "rasterized": True, "zorder": 2.5}
    axis.add_collection(LineCollection(list(outlines), **style))
    _seen_from_above(axis)


def _digits(value: float, count: int) -> str:
    """A number to some significant digits, zeros at its end included, and never with an exponent."""
    return with_minus(f"{float(f'{value:.{count}g}'):.{_decimals(value, count)}f}")


def _decimals(value: float, count: int) -> int:
    """Decimals of a number to some significant digits."""
    rounded = float(f"{value:.{count}g}")
    return max(0, count - 1 - math.floor(math.log10(abs(rounded)))) if rounded else 0


def _pressure(value: float, scale: PressureScale, digits: int) -> str:
    """A pressure in Pa in the unit of the scale, with the decimals of the highest, which has so many significant digits."""
    decimals = _decimals(float(scale.norm.vmax or 0.0), digits)
    return with_minus(f"{round(float(scale.factor * value), decimals) + 0.0:.{decimals}f}")


def _seen_from_above(axis: Axes) -> None:
    axis.set(aspect="equal", xlabel="x in mm", ylabel="y in mm (front at the bottom)")
    axis.spines[:].set_visible(False)


def _draw_matrix(axis: Axes, grasp: LoadedTaxels, side: str, scale: PressureScale) -> None:
    """The taxels as squares with their pressure and force; the names of rows and columns beside them."""
    import matplotlib

    layout = grasp.scene.matrix
    columns, rows = (grasp.scene.borders(along, side) for along in "xy")
    colours, size = matplotlib.colormaps[PRESSURE_COLOURS], 1e3 * layout.size
    numbering, (per_newton, force_unit) = Numbering.of(grasp, side, scale), grasp.taxel_force_scale
    border = 0.6 if grasp.pressures[side].size <= MOST_BORDERED else 0.0
    squares: list[Rectangle] = []
    for (row, column), pressure in np.ndenumerate(grasp.pressures[side]):
        corner = (columns[column, 0], rows[row, 0])
        shade = float(scale.norm(scale.factor * pressure))
        squares.append(Rectangle(corner, size, size, facecolor=colours(shade), edgecolor="#30363d", linewidth=border))
        if numbering is None:
            continue
        style: dict[str, Any] = {
            "ha": "center",
            "color": ink_on(colours(shade)),
            "zorder": 4,
            "in_layout": False,  # it lies in the map
            "path_effects": [withStroke(linewidth=2.2, foreground=colours(shade))],  # a rim: no line runs through letters
        }
        x, y = corner[0] + size / 2, corner[1] + size / 2
        written, above = f"{_pressure(pressure, scale, numbering.digits)}{numbering.unit}", bool(numbering.unit)
        place: dict[str, Any] = {"va": "bottom" if above else "center", "fontsize": numbering.letters, "fontweight": "bold"}
        axis.text(x, y, written, **place, **style)
        if above:
            force = _digits(float(per_newton * grasp.forces[side][row, column]), 2)
            axis.text(x, y - 0.06 * size, f"{force} {force_unit}", va="top", fontsize=0.72 * numbering.letters, **style)
    axis.add_collection(PatchCollection(squares, match_original=True, zorder=2))  # thousands one by one take a minute
    named: dict[str, Any] = {"fontsize": 7, "color": "#57606a"}
    right, back = _extent(grasp.scene, side)[1] + BESIDE * drawn_millimetre(grasp.scene.size)
    every = layout.pitch * _inches_per_metre(grasp.scene, side) > NAME
    for number in named_lines(layout.rows, every=every and layout.rows <= MOST_NAMED):
        axis.text(right, rows[number - 1].mean(), f"row {number}", ha="left", va="center", **named)
    for number in named_lines(layout.columns, every=every and layout.columns <= MOST_NAMED):
        axis.text(columns[number - 1].mean(), back, f"col. {number}", ha="center", va="bottom", **named)


def _inches_per_metre(scene: GraspScene, side: str) -> float:
    low, high = _extent(scene, side)
    return MapsLayout.of(scene).longer_side * 1e3 / float(np.max(high - low))


def _extent(scene: GraspScene, side: str) -> tuple[Array, Array]:
    """Lowest and highest x and y in mm of the jaw's face and the block."""
    half = np.array([scene.jaws[side].width, scene.jaws[side].depth]) / 2
    middle = scene.place(side)[:2]
    return 1e3 * np.minimum(0.0, middle - half), 1e3 * np.maximum(scene.size[:2], middle + half)


def _draw_surroundings(axis: Axes, scene: GraspScene, side: str, bodies: Sequence[Solid]) -> None:
    """The jaw's face, the undeformed block and the outlines of the inclusions in it."""
    jaw, place, size = scene.jaws[side], 1e3 * scene.place(side), 1e3 * scene.size
    half = 1e3 * np.array([jaw.width, jaw.depth]) / 2
    face = Rectangle(tuple(place[:2] - half), *(2 * half), facecolor="#e6e8eb", edgecolor="#30363d", linewidth=1.0, zorder=1)
    axis.add_patch(face)
    axis.add_patch(Rectangle((0, 0), size[0], size[1], fill=False, edgecolor="#57606a", linewidth=0.8, linestyle=(0, (4, 3))))
    low, high = _extent(scene, side)
    room, unit = 0.11 * (high[0] - low[0]), drawn_millimetre(scene.size)
    (left, front), (right, back) = low - AROUND * unit, high + BESIDE * unit
    axis.set(xlim=(left, right + room), ylim=(front, back + room / 2))
    axis.set_xticks([tick for tick in axis.get_xticks() if low[0] <= tick <= high[0]])
    axis.set_yticks([tick for tick in axis.get_yticks() if low[1] <= tick <= high[1]])
    for body in bodies:
        x, y, distance = outline(body, scene.size, 2)
        axis.contour(x, y, distance, levels=[0.0], colors=["w"], linewidths=2.2, zorder=3)
        axis.contour(x, y, distance, levels=[0.0], colors=["k"], linewidths=1.0, linestyles="--", zorder=3)
