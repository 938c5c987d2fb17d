"""Grasp: the pressure maps of both jaws, the section through the block, the course over time, and a 3D view."""

from __future__ import annotations

from typing import Literal

from matplotlib.figure import Figure

from tactsim.experiments.grasp.figures.history import draw_histories, has_history, panels
from tactsim.experiments.grasp.figures.maps import MapsLayout, draw_maps, draw_plan
from tactsim.experiments.grasp.figures.moment import shown_moment
from tactsim.experiments.grasp.figures.parts import TITLE, WHERE, loaded_taxels, moment_of
from tactsim.experiments.grasp.figures.section import draw_section, section_size
from tactsim.experiments.grasp.figures.taxel_voltages import VOLTAGES, voltages_figure
from tactsim.experiments.grasp.figures.view import VIEW, view_figure, view_rendering
from tactsim.experiments.grasp.figures.viewed import viewed
from tactsim.experiments.grasp.figures.views import VIEWS, views_figure
from tactsim.experiments.grasp.scene import GraspScene, SimulatedGrasp
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.interfaces.both_jaws import TAXEL_FORCE, VOLTAGE, has_taxels
from tactsim.plotting.canvas import SKETCH, Plot, result_figure
from tactsim.plotting.rendered_plot import RenderedPlot
from tactsim.results import Result, Status

PANEL_HEIGHT = 2.1
"""Of a history, in inches."""


class GraspFigures(ResultFigures):
    """The maps first; the 3D view last, as it alone needs a renderer."""

    kind: Literal["grasp"] = "grasp"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """What the result has fields and steps for; a sketch of what is at rest."""
        if result.at_rest:
            return {SKETCH: Plot(lambda: sketch_figure(result))}
        if not result.steps:
            return {}
        moment = shown_moment(result) if result.status is Status.CONVERGED else result
        drawings: dict[str, Drawing] = {"grasp_maps.png": Plot(lambda: maps_figure(moment))}
        if result.frames:
            drawings["grasp_section.png"] = Plot(lambda: section_figure(moment))
        if has_history(result):
            drawings["grasp_history.png"] = Plot(lambda: history_figure(result))
        if has_taxels(result, TAXEL_FORCE):
            drawings[VIEWS] = Plot(lambda: views_figure(moment, viewed(moment)))
        if has_taxels(result, VOLTAGE, history=True):
            drawings[VOLTAGES] = Plot(lambda: voltages_figure(result))
        if result.frames:
            drawings[VIEW] = RenderedPlot(lambda: view_rendering(moment), lambda rendering: view_figure(moment, rendering))
        return drawings


def sketch_figure(result: Result) -> Figure:
    """The block at rest between the jaws, cut and from above."""
    with result_figure(result, (11.0, 5.0), TITLE) as figure:
        axes = figure.subplots(1, 2, width_ratios=(1.4, 1))
        draw_section(axes[0], result)
        draw_plan(axes[1], result)
        axes[1].set_title(f"from above: {result.scene_as(SimulatedGrasp).solver.size_in_words}", loc="left")
    return figure


def section_figure(result: Result) -> Figure:
    """The section through the deformed block, between the jaws."""
    with result_figure(result, section_size(result), TITLE, where=WHERE) as figure:
        draw_section(figure.add_subplot(), result)
    return figure


def maps_figure(result: Result) -> Figure:
    """The pressure on every taxel of both jaws."""
    layout = MapsLayout.of(result.scene_as(GraspScene))
    with result_figure(result, layout.size, TITLE, below=moment_of(result), where=WHERE) as figure:
        draw_maps(figure.subplots(layout.rows, layout.columns).tolist(), loaded_taxels(result))
    return figure


def history_figure(result: Result) -> Figure:
    """The forces of the jaws, the pressure in an artery and the taxels that carry most, over time."""
    rows = len(panels(result))
    with result_figure(result, (8.0, PANEL_HEIGHT * rows + 0.8), TITLE, where=WHERE) as figure:
        draw_histories(figure.subplots(rows, 1, squeeze=False)[:, 0].tolist(), result)
    return figure
