"""The panels of a film under constant forces."""

from __future__ import annotations

import pytest

import tactsim as ts


@pytest.mark.parametrize("case", ["film_lingstat_joint", "film_lingstat_literal"])
def test_words_stand_within_the_figure_and_beside_the_curves(case: str) -> None:
    figure = ts.load_case(case).run(None).plot("film_test")
    figure.draw_without_rendering()
    within = figure.bbox
    words = figure._supxlabel.get_window_extent()  # type: ignore[attr-defined]
    assert within.x0 <= words.x0
    assert words.x1 <= within.x1
    resistance = figure.axes[0]
    legend = resistance.get_legend().get_window_extent()
    for line in resistance.lines:
        assert not any(legend.contains(*point) for point in resistance.transData.transform(line.get_xydata()))
