"""A grasp in 3D: translucent tissue, its inclusions, the jaws as thin plates and a bar for the pressure on every taxel."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import TITLE, WHERE, LoadedTaxels, ending, inclusions_of, loaded_taxels
from tactsim.experiments.grasp.scene import GraspScene
from tactsim.interfaces.taxel_layout import JAWS, OUTWARD
from tactsim.plotting.canvas import PRESSURE_COLOURS, result_figure
from tactsim.plotting.off_screen import Camera, Rendering, Surface
from tactsim.plotting.plane_cut import OUTER, QUARTERS, deformed, interfaces
from tactsim.results import FieldFrame, Result
from tactsim.units import format_quantity

FROM_ABOVE, FROM_BELOW = (0.55, -1.0, 0.5), (0.55, -1.0, -0.5)
"""From the block to the eye."""
PIXELS = (1100, 850)
"""Width and height of the rendered view."""
PLATE, BAR = 0.06, 0.55
"""Thickness of the plates that stand for the jaws and length of the longest bar, over the height of the block."""
APART = 0.002
"""Gap between a plate and the bars on it, over the height of the block: faces in one plane are drawn in streaks."""
LEAST_BAR = 0.01
"""Length of a bar without pressure, over the height of the block, so that its place is seen."""
TISSUE_COLOUR, INCLUSION_COLOUR, JAW_COLOUR = "#f0b8a0", "#009e73", "#aab1ba"
ARROW = 0.15
"""Length of the arrows along the axes, over the longest side of the block."""
BOX = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
_SIDES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
BOX_TRIANGLES = _SIDES[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
"""Corners (8, 3) of a box with sides of 1, and its triangles (12, 3) as seen from outside."""
NAME_LETTER, NAME_LINE, NAME_APART = 16.0, 30.0, 8.0
"""Width of a letter and height of a line of an inclusion's name in pixels of the view, and distance of a name beside an inclusion
that it would hide.
"""
VIEW = "grasp_view.png"
"""File name of the view."""


def view_rendering(result: Result) -> Rendering:
    """The scene from above and from below, which begins to be rendered."""
    surfaces = scene(result.frames[-1], loaded_taxels(result))
    return Rendering(surfaces, [framing_camera(surfaces, direction) for direction in (FROM_ABOVE, FROM_BELOW)])


def view_figure(result: Result, rendering: Rendering) -> Figure:
    """The rendered scene from above and from below, with names, axes and the scale of the bars."""
    grasp, cameras, images = loaded_taxels(result), rendering.cameras, rendering.pictures()
    with result_figure(result, (12.0, 5.8), TITLE, remark=ending(result), where=WHERE) as figure:
        figure.set_layout_engine("constrained", h_pad=0.12)
        axes = figure.subplots(1, 2)
        for axis, camera, image, words in zip(axes, cameras, images, ("from above", "from below"), strict=True):
            axis.imshow(image, interpolation="bilinear")
            axis.set_axis_off()
            axis.set_title(f"seen from the front, right and {words.split()[-1]}", loc="left")
            annotate(axis, grasp, camera)
            _name_inclusions(axis, result, camera)
        pressure_bar(figure, axes, grasp, "pressure", "its bar on the back of the jaw")
    return figure


def pressure_bar(figure: Figure, axes: Any, grasp: LoadedTaxels, meaning: str, bars: str) -> None:
    """The colours of the bars on the taxels; ``meaning`` is what their colour and the length of ``bars`` show."""
    scale = grasp.pressure_scale
    bar = figure.colorbar(
        ScalarMappable(scale.norm, PRESSURE_COLOURS), ax=axes, location="bottom", shrink=0.5, aspect=40, pad=0.01
    )
    bar.set_label(f"mean {meaning} on the taxel in {scale.unit}: colour and length of {bars}")
    bar.outline.set_linewidth(0.5)


def scene(frame: FieldFrame, grasp: LoadedTaxels) -> list[Surface]:
    """Everything in the view, in m."""
    nodes, (faces, between) = deformed(frame), interfaces(frame)
    triangles, sides = faces[:, QUARTERS], _sides(frame.points, faces, grasp.scene.size)
    outer = (between == [OUTER, 0]).all(axis=1)
    surfaces = [
        _surface(nodes, triangles[outer & (sides == side)], TISSUE_COLOUR, opacity=0.22, creases=True)
        for side in np.unique(sides[outer])
    ]
    for number in inclusions_of(frame):
        mine = (between == number).any(axis=1)
        surfaces.append(_surface(nodes, triangles[mine], INCLUSION_COLOUR, smooth=True))
    for side in JAWS:
        surfaces += jaw_surfaces(grasp, side)
    return surfaces


def _sides(points: Array, faces: Array, size: Array) -> Array:
    """Side of the undeformed block on which each face lies, 0 to 5, or -1: edges between sides are drawn however they roll."""
    middles = points[faces[:, :3]].mean(axis=1)
    distance = np.abs(np.concatenate([middles, middles - size], axis=1))
    nearest = distance.argmin(axis=1)
    return np.where(distance.min(axis=1) < 1e-6 * size.max(), nearest, -1)


def _surface(nodes: Array, triangles: Array, colour: str, **style: Any) -> Surface:
    used, numbers = np.unique(triangles, return_inverse=True)
    return Surface(nodes[used], numbers.reshape(-1, 3), colour, **style)


def jaw_surfaces(grasp: LoadedTaxels, side: str) -> list[Surface]:
    """The plate, and on its back the bars in the colours of their pressure."""
    jaw, layout, height = grasp.scene.jaws[side], grasp.scene.matrix, float(grasp.scene.size[2])
    back = PLATE * height
    low = np.array([-jaw.width / 2, -jaw.depth / 2, 0.0])
    plate = _placed(grasp, side, BOX * np.array([jaw.width, jaw.depth, back]) + low)
    boxes, colours = [], []
    norm = Normalize(grasp.smallest_pressure, grasp.largest_pressure)
    for (row, column), pressure in np.ndenumerate(grasp.pressures[side]):
        length = height * max(LEAST_BAR, BAR * max(0.0, float(pressure)) / grasp.largest_pressure)
        corner = np.array([layout.borders("x")[column, 0], layout.borders("y")[row, 0], back + APART * height])
        boxes.append(_placed(grasp, side, BOX * np.array([layout.size, layout.size, length]) + corner))
        colours.append(matplotlib.colormaps[PRESSURE_COLOURS](float(norm(pressure)))[:3])
    triangles = np.arange(len(boxes))[:, None, None] * len(BOX) + BOX_TRIANGLES
    painted = np.repeat(np.array(colours), len(BOX_TRIANGLES), axis=0)
    bars = Surface(np.concatenate(boxes), triangles.reshape(-1, 3), painted, creases=True)
    return [Surface(plate, BOX_TRIANGLES, JAW_COLOUR, opacity=0.3, creases=True), bars]


def _placed(grasp: LoadedTaxels, side: str, points: Array) -> Array:
    """Points (n, 3) in the jaw's own axes, in those of the block."""
    return points @ grasp.scene.jaws[side].rotation.T + grasp.scene.place(side)


def framing_camera(surfaces: list[Surface], direction: tuple[float, float, float]) -> Camera:
    """A camera that sees everything, with a margin."""
    points = np.concatenate([surface.points for surface in surfaces])
    trial = Camera((0.0, 0.0, 0.0), direction, 1.0, PIXELS)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    flat = (trial.project(points - middle) - np.array(PIXELS) / 2) / (PIXELS[1] / 2)
    reach = np.abs(flat).max(axis=0)
    half = 1.05 * max(float(reach[1]), float(reach[0]) * PIXELS[1] / PIXELS[0])
    return Camera((float(middle[0]), float(middle[1]), float(middle[2])), direction, half, PIXELS)


def annotate(axis: Axes, grasp: LoadedTaxels, camera: Camera) -> None:
    """The directions of the axes with a length, and the jaws' names."""
    length = ARROW * float(grasp.scene.size.max())
    corner = np.array([0.05, 0.98]) * camera.pixels
    begin, *ends = camera.project(length * np.vstack([np.zeros(3), np.eye(3)]))
    for name, end in zip("xyz", ends, strict=True):
        tip = corner + end - begin
        axis.annotate(
            "",
            (tip[0], tip[1]),
            (corner[0], corner[1]),
            annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": "k", "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0},
        )
        beyond = corner + 1.18 * (end - begin)
        axis.text(beyond[0], beyond[1], name, ha="center", va="center")
    words = f"arrows: {format_quantity(length, 'm')}"
    axis.text(0.0, -0.1, words, transform=axis.transAxes, ha="left", va="top", fontsize=7.5)
    for side in JAWS:
        jaw = grasp.scene.jaws[side]
        plate_corner = np.array([-jaw.width / 2, -jaw.depth / 2, PLATE * float(grasp.scene.size[2]) / 2])
        x, y = camera.project(_placed(grasp, side, plate_corner[None]))[0]
        axis.text(x - 14, y - OUTWARD[side] * 10, f"{side} jaw", ha="right", va="center")


def _name_inclusions(axis: Axes, result: Result, camera: Camera) -> None:
    """The names of the inclusions where they lie, beside small ones, and each below the one that it would stand on."""
    frame, rim = result.frames[-1], [withStroke(linewidth=2.5, foreground="w")]
    style: dict[str, Any] = {"va": "center", "ha": "left", "fontsize": 8.5, "fontweight": "bold", "path_effects": rim}
    named: list[tuple[float, float, float]] = []
    shown = [(k, camera.project(deformed(frame)[nodes])) for k, nodes in inclusions_of(frame).items()]
    for number, points in sorted(shown, key=lambda inclusion: float(inclusion[1][:, 1].mean())):
        name = result.scene_as(GraspScene).named_inclusion(number)
        width, (x, y) = NAME_LETTER * len(name), points.mean(axis=0).tolist()
        left = x - width / 2 if np.ptp(points[:, 0]) > width else float(points[:, 0].max()) + NAME_APART
        for other, end, line in named:
            if left < end and other < left + width:
                y = max(y, line + NAME_LINE)
        named.append((left, left + width, y))
        axis.text(left, y, name, **style)
