"""The panels of a film under constant forces."""

from __future__ import annotations

import pytest
from drawn import covered_lines

import tactsim as ts
from tactsim.experiments.film.figures.film_test import FEWEST_TICKS, _surface_ticks


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


@pytest.mark.parametrize(("low", "high"), [(11.3, 45.2), (3.5, 38.9), (0.2, 900.0), (11.3, 13.0), (11.31, 11.32)])
def test_the_surface_has_several_round_resistances_beside_it(low: float, high: float) -> None:
    """From 11 to 45 kilohms there was one, 20, by which no scale is read."""
    ticks = _surface_ticks(low, high)
    assert len(ticks) >= (FEWEST_TICKS if high > 1.2 * low else 2)
    assert ((low <= ticks) & (ticks <= high)).all()


def test_the_surface_says_what_its_edges_are_and_the_foot_has_a_minus_sign() -> None:
    result = ts.load_case("film_thermogravimetry").run(None)
    assert "edges: the forces and times of the case" in result.plot("film_surface").get_suptitle()
    figure = ts.load_case("film_lingstat").run(None).plot("film_test")
    assert "F = 20.94 C − 0.132" in figure.get_supxlabel()


def test_the_creep_says_that_it_is_synthetic_and_of_what_its_intervals_are() -> None:
    words = " ".join(ts.load_case("film_creep").run(None).plot("film_creep").get_supxlabel().split())
    assert "synthetic creep" in words
    assert "intervals by linearisation" in words
