"""The figures of a localization: the three views and the 3D view, with the true and the estimated inclusions."""

from __future__ import annotations

from typing import Literal

from tactsim.experiments.grasp.figures.views import VIEWS, views_figure
from tactsim.experiments.localization.figures.parts import localized
from tactsim.experiments.localization.figures.space import SPACE, space_figure, space_view
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.interfaces.both_jaws import TAXEL_FORCE, has_taxels
from tactsim.plotting.canvas import Plot
from tactsim.plotting.rendered_plot import RenderedPlot
from tactsim.results import Result


class LocalizationFigures(ResultFigures):
    """The three views, and a 3D view."""

    kind: Literal["localization"] = "localization"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``views.png`` and ``space.png``; the last needs a renderer."""
        if not has_taxels(result, TAXEL_FORCE):
            return {}
        drawings: dict[str, Drawing] = {VIEWS: Plot(lambda: views_figure(result, localized(result)))}
        drawings[SPACE] = RenderedPlot(lambda: space_view(result), lambda view: space_figure(result, view))
        return drawings
