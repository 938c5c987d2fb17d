"""The panels of a film under constant forces."""

from __future__ import annotations

import pytest
from drawn import covered_lines

import tactsim as ts


@pytest.mark.parametrize("case", ["film_lingstat_joint", "film_lingstat_literal"])
def test_words_stand_within_the_figure_and_beside_the_curves(case: str) -> None:
    figure = ts.load_case(case).run(None).plot("film_test")
    assert covered_lines(figure) == []  # which lays it out
    within = figure.bbox
    words = figure._supxlabel.get_window_extent()  # type: ignore[attr-defined]
    assert within.x0 <= words.x0
    assert words.x1 <= within.x1


def test_the_forces_are_named_beside_their_creep() -> None:
    """Of the case that ``tactsim new film_test`` writes, whose curves run through the middle of the panel."""
    figure = ts.kinds("experiment")["film_test"].example().run(None).plot("film_test")
    assert covered_lines(figure) == []
