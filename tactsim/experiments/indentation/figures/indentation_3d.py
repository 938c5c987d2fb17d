"""Indentation in 3D: the deformed cut, the force against the displacement, and the pressure around the annulus."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.experiments.indentation.figures.indentation import FORCE_COLOUR, PressedFigures, after, draw_curve
from tactsim.experiments.indentation.figures.section_3d import draw_cut
from tactsim.experiments.indentation.scene import Indentation3dScene
from tactsim.plotting.canvas import despined, result_figure, scale_of
from tactsim.results import Result


class Indentation3DFigures(PressedFigures):
    """The cut, and the curves beside it."""

    kind: Literal["indentation_3d"] = "indentation_3d"

    def draw_at_rest(self, axis: Axes, result: Result) -> None:
        """The cut of a sketch."""
        draw_cut(axis, result)

    def figure(self, result: Result) -> Figure:
        """Cut (if the result has fields), force-displacement curve, and pressure around an annulus off the axis or leaning."""
        around = "pressure_around" in result.quantities and result.scene_as(Indentation3dScene).symmetry != "quarter"
        wide = bool(result.frames)
        size = (11.0 if wide else 6.0, 5.6 if around else 4.4)
        with result_figure(result, size, "Indentation in 3D", where=after(result)) as figure:
            grid = figure.add_gridspec(1 + around, 1 + wide, width_ratios=(1.5, 1) if wide else None)
            if wide:
                draw_cut(figure.add_subplot(grid[:, 0]), result)
            draw_curve(figure.add_subplot(grid[0, -1]), result)
            if around:
                _draw_around(figure.add_subplot(grid[1, -1]), result)
        return figure


def _draw_around(axis: Axes, result: Result) -> None:
    """The mean pressure on each sector of the annulus against the angle about its axis."""
    pressure = result.quantities["pressure_around"].numbers
    factor, unit = scale_of(float(np.abs(pressure).max()), "Pa")
    edges = np.linspace(0.0, 360.0, len(pressure) + 1)
    axis.stairs(factor * pressure, edges, baseline=None, color=FORCE_COLOUR, linewidth=1.5)
    axis.axhline(factor * pressure.mean(), color=FORCE_COLOUR, linewidth=0.8, linestyle=":")
    axis.set(xlabel="angle about the annulus's axis in degrees, 0 at +x, 90 at +y", ylabel=f"pressure in {unit}", xlim=(0, 360))
    axis.set_xticks(range(0, 361, 90))
    axis.set_ylim(min(0.0, 1.1 * factor * float(pressure.min())), max(1e-9, 1.15 * factor * float(pressure.max())))
    axis.set_title("mean pressure on sectors of the annulus (dotted: on all)", loc="left")
    despined(axis)
