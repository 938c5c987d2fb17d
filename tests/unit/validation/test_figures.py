"""Figures of the validation report."""

from __future__ import annotations

from typing import Any

import pytest

from tactsim.errors import UnknownName
from tactsim.validation.figures import validation_figure
from tactsim.validation.figures.forms import curves_figure, maps_figure

LINE = {"label": "printed", "value": 400.0}
BARS = [{"label": "default", "values": [8e4, 1e5]}, {"label": "friction 0", "values": []}]
CURVE = {"label": "fit", "x": [0.6, 0.8], "y": [2.0, 1.0], "style": "line"}
PANEL = {"y_axis": "force", "unit": "N", "curves": [CURVE, {**CURVE, "style": "points"}], "logarithmic": True}
RANGES = {
    "form": "ranges",
    "title": "t",
    "axis": "pressure",
    "unit": "Pa",
    "panels": [{"title": "a", "bars": BARS, "lines": [LINE]}],
}
SURFACES = {
    "form": "surfaces", "title": "t", "x": [0.0, 1.0, 2.0], "x_axis": "time in s", "y": [1.0, 2.0], "y_axis": "force in N",
    "z_axis": "resistance", "unit": "ohm", "panels": [{"title": "a", "z": [[3e3, 2e3, 1e3], [2e3, 1e3, 5e2]]}] * 2,
}  # fmt: skip
SECTION = {
    "title": "a", "points": [[0, 0], [6e-3, 0], [0, 6e-3], [6e-3, 6e-3]], "triangles": [[0, 1, 2], [1, 3, 2]],
    "values": [-2e3, 1e3], "lines": [[[1e-3, 5e-3], [3e-3, 5e-3]], [[0, 6e-3], [1e-3, 6e-3]]],
}  # fmt: skip
SECTIONS = {"form": "sections", "title": "t", "unit": "Pa", "label": "stress", "panels": [SECTION, SECTION]}
CURVES = {"form": "curves", "title": "t", "x_axis": "stretch", "x_unit": "", "panels": [PANEL, {**PANEL, "unit": ""}]}


@pytest.mark.parametrize(
    "data",
    [
        RANGES,
        CURVES,
        {**CURVES, "x_logarithmic": True, "even_panels": True},
        {**CURVES, "panels": [PANEL]},
        {**RANGES, "panels": RANGES["panels"] * 2},
        SURFACES,
        SECTIONS,
    ],
)  # type: ignore[operator]
def test_figures_are_drawn(data: dict[str, Any]) -> None:
    assert validation_figure(data).startswith(b"\x89PNG")


def test_a_bracket_without_any_run_is_still_drawn() -> None:
    panel = {"title": "a", "bars": BARS[1:], "lines": [LINE]}
    assert validation_figure({**RANGES, "panels": [panel]}).startswith(b"\x89PNG")


def test_an_unknown_form_is_refused() -> None:
    with pytest.raises(UnknownName, match="ranges"):
        validation_figure({"form": "range"})


def test_each_of_a_few_points_of_a_line_is_marked() -> None:
    """Kinks between eight computed points looked like those of the curve."""
    many = {**CURVE, "x": [0.1 * k for k in range(40)], "y": [1.0] * 40}
    figure = curves_figure({**CURVES, "panels": [{**PANEL, "curves": [CURVE, many]}]})
    assert [line.get_marker() for line in figure.axes[0].lines] == [".", ""]


def test_maps_say_that_each_column_has_colours_of_its_own() -> None:
    column = {"title": "a", "upper": [[1.0, 2.0]], "lower": [[0.5, 1.0]]}
    figure = maps_figure({"title": "Forces", "unit": "N", "columns": [column, column]})
    assert "colours from 0 to the largest of each column" in figure.get_suptitle().replace("\n", " ")
