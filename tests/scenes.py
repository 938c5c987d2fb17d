"""Scenes of results that nobody computed, and what every figure of a result says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text

from tactsim.array import Array
from tactsim.contact.jaw import Jaw
from tactsim.experiments.grasp.scene import EmbeddedShape, MeshReport, SimulatedGrasp
from tactsim.interfaces import Inclusion
from tactsim.interfaces.taxel_layout import JAWS, TaxelLayout
from tactsim.plotting.off_screen import Camera, Surface
from tactsim.results import Result, SolverReport, Status

BORDER = 2
"""Pixels by which words may reach beyond a figure."""
SOLVER = SolverReport(unknowns=1000, elements=100, linear_solver="superlu", rejected_steps=0, newton_iterations=12)
MESH = MeshReport(
    content="0" * 16,
    origin="made up",
    least_quality=0.5,
    mean_quality=0.8,
    least_curvature=0.9,
    straightened_edges=0,
    volume_errors=(0.0,),
    regions=("tissue",),
)


def grasp_scene(
    size: Sequence[float], layout: TaxelLayout, inclusions: Sequence[Inclusion] = (), *, closing: float = 1e-3, **jaw: float
) -> SimulatedGrasp:
    """A grasp whose jaws, with these fields, have closed by ``closing`` in m on the middle of a block of this size in m."""
    x, y, z = map(float, size)
    return SimulatedGrasp(
        block_size=(x, y, z),
        inclusions=tuple(EmbeddedShape(shape=shape, unlike_tissue=True) for shape in inclusions),
        jaws={side: Jaw.model_validate({"width": 50e-3, "depth": 50e-3} | jaw | {"side": side}) for side in JAWS},
        jaw_places={"upper": (x / 2, y / 2, z - closing), "lower": (x / 2, y / 2, closing)},
        matrix=layout,
        solver=SOLVER,
        mesh=MESH,
        control="displacement",
    )


@dataclass(frozen=True)
class Unrendered:
    """A rendering that renders nothing: white pictures."""

    surfaces: Sequence[Surface]
    cameras: Sequence[Camera]

    def pictures(self) -> list[Array]:
        return [np.full((*camera.pixels[::-1], 3), 255, np.uint8) for camera in self.cameras]


def unmarked_figures(result: Result) -> list[str]:
    """Names of those figures that would not say so across their foot if the run had been interrupted."""
    figures = replace(result, status=Status.INTERRUPTED, reason="stopped by the user").plot()
    words = {name: " ".join(figure.get_supxlabel().split()) for name, figure in figures.items()}
    return [name for name, said in words.items() if not said.startswith("INTERRUPTED") or "stopped by the user" not in said]


def cut_words(figures: dict[str, Figure]) -> list[str]:
    """Words in figures by name that reach beyond the border; labels of ticks aside, some of which are never drawn."""
    beyond = []
    for name, figure in figures.items():
        figure.draw_without_rendering()
        ticks = {
            label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for label in axis.get_ticklabels(which="both")
        }
        words = [
            text for text in figure.findobj(Text) if text not in ticks and text.get_visible() and text.get_text()[-1:].isalpha()
        ]
        for text in words:
            box = text.get_window_extent()
            if min(box.x0, box.y0) < -BORDER or box.x1 > figure.bbox.x1 + BORDER or box.y1 > figure.bbox.y1 + BORDER:
                beyond.append(f"{name}: {text.get_text()}")
    return beyond
