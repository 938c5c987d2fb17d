"""The figure of a ranking: markers where the numbers are, ties named, and a run that did not end well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from drawn import text_of
from scenes import unmarked_figures

from tactsim.experiments.durometer.elastomers import STABLE_SHAPES, TABLE_3_3
from tactsim.experiments.durometer.figures.elastomer_ranking import ElastomerRankingFigures
from tactsim.experiments.durometer.scene import ElastomerRankingScene
from tactsim.plotting import figures_for
from tactsim.results import Result, Status, StepRecord

PREDICTED = ((28.0, 17.0, 12.0, 2.0, 0.0, 0.0, 0.0), (11.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0))


def made_up():
    steps = [
        StepRecord(1, 0, 0.0, {"predicted_reading": value, "modulus_of_threshold": 1e3 * k, "modulus_of_reading": 9e3 * k})
        for row in PREDICTED
        for k, value in enumerate(row, 1)
    ]
    scene = ElastomerRankingScene(elastomers=TABLE_3_3, shapes=STABLE_SHAPES[:2], threshold_displacement=(1e-3, 2e-3))
    return Result("elastomer_ranking", Status.CONVERGED, "done", steps=tuple(steps), scene=scene)


def test_elastomers_shapes_and_ties_are_named():
    written = text_of(ElastomerRankingFigures().figure(made_up()))
    for words in (*(one.name for one in TABLE_3_3), "B1-A stable", "durometer", "hand", "sensor", "3 tied", "5 tied"):
        assert words in written
    assert "FAILED" not in written


def test_markers_and_ranks_stand_where_the_numbers_are():
    readings, _, ranks = ElastomerRankingFigures().figure(made_up()).axes
    offsets = np.asarray(readings.collections[0].get_offsets())
    np.testing.assert_allclose(offsets, np.stack([[48, 45, 42, 36, 13, 4, 1], PREDICTED[0]], axis=1))
    hardest, softest = ranks.lines[0].get_ydata(), ranks.lines[6].get_ydata()
    np.testing.assert_allclose(hardest, 7)
    np.testing.assert_allclose(softest, [1, 1, 1, 2, 3])  # shared with three and with five


def test_what_is_missing_leaves_a_gap():
    cut = [
        replace(step, values={k: v for k, v in step.values.items() if k != "predicted_reading"}) for step in made_up().steps[:7]
    ]
    result = replace(made_up(), steps=(*cut, *made_up().steps[7:10]), status=Status.INTERRUPTED, reason="stopped")
    assert "INTERRUPTED: stopped" in text_of(ElastomerRankingFigures().figure(result))


def test_png_by_name_and_nothing_without_a_shape():
    (name, draw), *rest = figures_for(made_up()).items()
    assert (name, rest) == ("elastomer_ranking.png", [])
    assert draw().startswith(b"\x89PNG")
    assert unmarked_figures(made_up()) == []
    assert figures_for(replace(made_up(), steps=made_up().steps[:6])) == {}
