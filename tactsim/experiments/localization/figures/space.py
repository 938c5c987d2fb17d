"""The estimated and the true inclusions in 3D, between the jaws with a bar for every taxel: the picture of thesis Fig. 6.8."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tactsim.array import Array
from tactsim.experiments.grasp.figures.parts import LoadedTaxels
from tactsim.experiments.grasp.figures.view import (
    BOX,
    BOX_TRIANGLES,
    FROM_ABOVE,
    TISSUE_COLOUR,
    annotate,
    framing_camera,
    jaw_surfaces,
    pressure_bar,
)
from tactsim.experiments.grasp.figures.viewed import ViewedGrasp, estimated_bodies
from tactsim.experiments.localization.figures.parts import localized
from tactsim.interfaces.solid import Solid
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import result_figure
from tactsim.plotting.off_screen import Rendering, Surface
from tactsim.results import Result

SPACE = "space.png"
"""File name of the view."""
TRUE_COLOUR, ESTIMATE_COLOUR = "#009e73", "#d1242f"
FACETS = 30
"""Edges of triangles along the block's height."""
WITHIN = 2e-3
"""Distance from the faces of the block, over its size, at which bodies are cut."""
UNKNOWN_RADIUS = 0.06
"""Radius over the block's height with which the place of an inclusion of unknown size is marked."""


@dataclass(frozen=True, eq=False)
class SpaceView:
    """What is shown, the jaws around it, the titles of the pictures, and their rendering, which has begun."""

    shown: ViewedGrasp
    grasp: LoadedTaxels
    titles: tuple[str, ...]
    rendering: Rendering


def space_view(result: Result) -> SpaceView:
    """True beside estimated inclusions, in the undeformed tissue, seen from the front, right and above."""
    shown = localized(result)
    grasp = _grasp(shown)
    outside = [_tissue(shown.scene.size), *(surface for side in JAWS for surface in jaw_surfaces(grasp, side))]
    scenes = {"true inclusions": list(_true(shown)), "estimated inclusions": list(_estimated(shown))}
    camera = framing_camera(outside, FROM_ABOVE)
    inclusions = [replace(body, seen_by=(k,)) for k, bodies in enumerate(scenes.values()) for body in bodies]
    titles = tuple(words if inside else f"{words}: none" for words, inside in scenes.items())
    return SpaceView(shown, grasp, titles, Rendering([*outside, *inclusions], [camera] * len(scenes)))


def space_figure(result: Result, view: SpaceView) -> Figure:
    """The pictures beside each other, with the axes and the scale of the bars."""
    rendering = view.rendering
    images = rendering.pictures()
    with result_figure(result, (12.0, 6.2), "Localization", remark=result.reason.partition(";")[0]) as figure:
        figure.set_layout_engine("constrained", h_pad=0.08)
        axes = figure.subplots(1, 2)
        for axis, camera, image, title in zip(axes, rendering.cameras, images, view.titles, strict=True):
            axis.imshow(image, interpolation="bilinear")
            axis.set_axis_off()
            axis.set_title(title, loc="left")
            annotate(axis, view.grasp, camera)
        _scale(figure, axes, view.grasp, view.shown)
    return figure


def _scale(figure: Figure, axes: Any, grasp: LoadedTaxels, shown: ViewedGrasp) -> None:
    pressure_bar(figure, axes, grasp, shown.meaning.replace("force", "pressure"), "its bar")
    handles = [Patch(color=TRUE_COLOUR, label="true"), Patch(color=ESTIMATE_COLOUR, label="estimated")]
    figure.legend(handles=handles, loc="lower right", ncols=2, fontsize=8.5)


def _grasp(shown: ViewedGrasp) -> LoadedTaxels:
    """The jaws at the faces of the undeformed block, with the pressures of what is shown."""
    x, y = map(float, shown.scene.middle)
    places = {"upper": (x, y, shown.scene.block_size[2]), "lower": (x, y, 0.0)}
    forces = dict(zip(JAWS, shown.signal, strict=True))
    pressures = {side: forces[side] / shown.scene.matrix.area for side in JAWS}
    return LoadedTaxels(shown.scene.model_copy(update={"jaw_places": places}), pressures, forces)


def _tissue(size: Array) -> Surface:
    return Surface(BOX * size, BOX_TRIANGLES, TISSUE_COLOUR, opacity=0.18, creases=True)


def _true(shown: ViewedGrasp) -> Iterator[Surface]:
    for body in shown.true:
        yield _surface(body, shown.scene.size, TRUE_COLOUR)


def _estimated(shown: ViewedGrasp) -> Iterator[Surface]:
    for body in estimated_bodies(shown, UNKNOWN_RADIUS * float(shown.scene.size[2])):
        yield _surface(body, shown.scene.size, ESTIMATE_COLOUR)


def _surface(body: Solid, size: Array, colour: str) -> Surface:
    """The surface of a body, cut just within the faces of the block: two surfaces in one place would show through each other
    in spots.
    """
    points, triangles = body.triangles(float(size[2]) / FACETS)
    return Surface(np.clip(points, WITHIN * size, (1 - WITHIN) * size), triangles, colour, smooth=True)
