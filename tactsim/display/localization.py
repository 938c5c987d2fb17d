"""The figure of a localization: the three views with the true and the estimated inclusions."""

from __future__ import annotations

from typing import Literal

from tactsim.display.canvas import png
from tactsim.display.localization_parts import has_views
from tactsim.display.localization_views import VIEWS, views_figure
from tactsim.display.result_figures import Drawing, ResultFigures
from tactsim.results import Result


class LocalizationFigures(ResultFigures):
    """One figure."""

    kind: Literal["localization"] = "localization"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``views.png``."""
        return {VIEWS: lambda: png(views_figure(result))} if has_views(result) else {}
