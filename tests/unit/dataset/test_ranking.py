"""The measures of estimators, their order, and what the command writes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import colliding_words
from made_grasps import FEW, LAYOUT, SIZE, made_samples, made_store, plain_result, response

from tactsim import progress
from tactsim.cli import main
from tactsim.dataset.figures.estimator_ranking import AXES, errors_figure, ranking_figures, roc, roc_figure
from tactsim.dataset.ranking.measures import JudgedEstimate, binned, measures, outcome, penalty, ranking
from tactsim.dataset.ranking.report import against_baseline, as_summary, as_text, record
from tactsim.dataset.ranking.samples import Truth, judged_samples
from tactsim.dataset.ranking.training import seen_in_training
from tactsim.errors import InputError, InvalidQuantity
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.estimate import Estimate, EstimatedInclusion
from tactsim.interfaces.readings import noise_in_words
from tactsim.localization.estimators.hypotheses import HypothesesEstimator
from tactsim.localization.estimators.model_based import ModelBasedEstimator
from tactsim.localization.estimators.thesis import ThesisEstimator
from tactsim.localization.lump_response import LumpResponse
from tactsim.localization.networks import LearnedWeights, Network, read_weights
from tactsim.localization.region import GaussianRegion

LUMP = Truth(1, 1e-3, (20e-3, 20e-3, 12e-3), 4e-3, 8e-3, 10.0)
NOTHING = Truth(2, 1e-3)
MOST = np.hypot(20e-3, 10e-3)


def estimated(
    truth: Truth, center: tuple[float, float, float] | None, radius: float = 4e-3, spread: float = 1e-3
) -> JudgedEstimate:
    """The outcome of an estimate with a ball there, or of none."""
    if center is None:
        return outcome(Estimate(False, (), "nothing"), truth)
    region = GaussianRegion(np.array(center), spread**2 * np.eye(3))
    return outcome(Estimate(True, (EstimatedInclusion("sphere", center, radius, region=region),), "a ball"), truth)


def test_errors_of_one_estimate() -> None:
    judged = estimated(LUMP, (23e-3, 16e-3, 11e-3), radius=5e-3)
    assert judged.lateral == pytest.approx(5e-3)
    assert judged.depth == pytest.approx(-1e-3)
    assert judged.radius == pytest.approx(1e-3)
    assert judged.covered is False
    assert estimated(LUMP, (21e-3, 20e-3, 12e-3)).covered is True
    assert judged.width == pytest.approx(2 * np.sqrt(6.2514) * 1e-3, rel=1e-4)


def test_hiding_does_not_pay() -> None:
    assert penalty(estimated(LUMP, None), SIZE) == pytest.approx(MOST)
    assert penalty(estimated(LUMP, (0.0, 0.0, 0.0)), SIZE) == pytest.approx(MOST)
    assert penalty(estimated(NOTHING, None), SIZE) == 0
    assert penalty(estimated(NOTHING, (20e-3, 20e-3, 10e-3)), SIZE) == pytest.approx(MOST)
    honest = [estimated(LUMP, (24e-3, 20e-3, 12e-3)), estimated(LUMP, (26e-3, 20e-3, 12e-3))]
    hiding = [estimated(LUMP, (20e-3, 20e-3, 12e-3)), estimated(LUMP, None)]
    better, worse = (measures(judged, SIZE) for judged in (honest, hiding))
    assert worse["lateral_error"]["median"]["value"] < better["lateral_error"]["median"]["value"]
    assert worse["score"]["value"] > better["score"]["value"]
    assert worse["lateral_error_with_misses"]["value"] == pytest.approx(10e-3)


def test_rates_and_counts() -> None:
    judged = [
        estimated(LUMP, (20e-3, 20e-3, 12e-3)),
        estimated(LUMP, None),
        estimated(LUMP, (20e-3, 20e-3, 2e-3)),
        estimated(NOTHING, None),
    ]
    numbers = measures(judged, SIZE)
    assert (numbers["samples"], numbers["lumps"], numbers["without_lump"], numbers["found"]) == (4, 3, 1, 2)
    assert numbers["detection_rate"]["value"] == pytest.approx(2 / 3)
    assert numbers["false_alarm_rate"]["value"] == 0
    assert numbers["coverage"]["value"] == pytest.approx(0.5)
    assert numbers["depth_error"]["quantile_90"]["value"] == pytest.approx(9e-3)


def test_what_no_sample_reports_is_none() -> None:
    numbers = measures([estimated(NOTHING, None)], SIZE)
    assert numbers["detection_rate"] is None
    assert numbers["lateral_error"] is None
    assert numbers["coverage"] is None
    assert "NaN" not in json.dumps(numbers, allow_nan=False)


def test_bins_hold_every_lump_once() -> None:
    samples = made_samples(24, response())
    judged = [estimated(truth, truth.center) for truth in samples.truths]
    for parts in binned(judged, SIZE).values():
        assert sum(part["lumps"] for part in parts) == 21
        assert all(part["low"] <= part["high"] for part in parts)


def test_the_better_estimator_comes_first() -> None:
    table = response()
    samples = made_samples(16, table)
    good = ModelBasedEstimator(model_error=0.02, background_error=0.0, background_scale=0.0)
    ranked = ranking({"thesis": ThesisEstimator(), "model": good}, samples, table)
    assert [one.name for one in ranked] == ["model", "thesis"]
    assert ranked[0].measures["lateral_error"]["median"]["value"] < 1e-3
    assert ranked[0].measures["coverage"]["value"] >= 0.7
    assert against_baseline(ranked)["model"]["lateral_error_with_misses"] < 0.5
    assert set(ranked[0].noises) == {1.0, 2.0, 4.0}
    text = as_text(ranked, samples, ())
    assert "| model |" in text.replace("\n", "")
    assert json.loads(json.dumps(record(ranked, samples, {})))["estimators"][0]["samples"][1]["found"]
    with pytest.raises(InputError, match="needs the response"):
        ranking({"model": good}, samples, None)


def test_whoever_watches_sees_how_many_estimates_are_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "is_watched", lambda: True)
    ranking({"thesis": ThesisEstimator()}, made_samples(4, response()), None)
    assert "estimates: 100%" in (shown := capsys.readouterr().err)
    assert "12/12" in shown  # at three noises


def ranking_of_made_store(folder: Path, table: LumpResponse) -> list[str]:
    """The command that ranks the estimators on a store made in the folder, with a plain grasp as the reference."""
    store, plain = made_store(folder, table, FEW, training=7), plain_result(folder / "plain")
    given = ["--reference", plain, "--noise", "0.3 mN", "--split", "test", "--out", str(folder / "out")]
    return ["data", "rank", str(store), *given]


def test_the_command_writes_report_and_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    table = response()
    monkeypatch.setattr("tactsim.experiments.localization.response_store.stored_response", lambda folder: table)
    order = ranking_of_made_store(tmp_path, table)
    assert main(order) == 0
    shown = capsys.readouterr().out
    assert any(line.startswith("model_based ") for line in shown.splitlines())
    assert max(map(len, shown.split("report in")[0].splitlines())) < 80, "the table was three times as wide as a terminal"
    assert "| model_based |" in (tmp_path / "out" / "report.md").read_text()
    content = json.loads((tmp_path / "out" / "report.json").read_text())
    assert content["samples"] == 1
    assert content["noise"]["value"] == pytest.approx(0.3e-3)
    assert {one["name"] for one in content["estimators"]} == {"thesis", "thesis with reference", "model_based", "hypotheses"}
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert names == {".tactsim.json", "report.json", "report.md", "errors.png", "noise.png", "places.png"}
    assert main([*order, "--learned", str(tmp_path / "none.npz")]) == 5
    assert "No such file" in capsys.readouterr().err


def test_an_estimator_that_fails_costs_no_other_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refusing(self: object, readings: object) -> Estimate:
        raise InvalidQuantity("no room for two")

    def broken(self: object, readings: object) -> Estimate:
        raise ZeroDivisionError("by zero")

    table = response()
    monkeypatch.setattr("tactsim.experiments.localization.response_store.stored_response", lambda folder: table)
    monkeypatch.setattr("tactsim.dataset.figures.estimator_ranking.ranking_figures", lambda content: {})
    monkeypatch.setattr(HypothesesEstimator, "estimate", refusing)
    monkeypatch.setattr(ModelBasedEstimator, "estimate", broken)
    order = ranking_of_made_store(tmp_path, table)
    assert main(order) == 1, "that of the first that failed"
    shown, noted = capsys.readouterr()
    assert any(line.startswith("thesis ") for line in shown.splitlines())
    assert "error: hypotheses failed and is not ranked: no room for two\n" in noted
    assert "error: model_based failed and is not ranked: internal error (ZeroDivisionError: by zero); please report it" in noted
    content = json.loads((tmp_path / "out" / "report.json").read_text())
    assert {one["name"] for one in content["estimators"]} == {"thesis", "thesis with reference"}
    assert set(content["failed"]) == {"hypotheses", "model_based"}
    assert "`hypotheses` failed and is not ranked: no room for two\n" in (tmp_path / "out" / "report.md").read_text()
    monkeypatch.setattr(ThesisEstimator, "estimate", refusing)
    assert main(order) == 2
    assert not capsys.readouterr().out, "nothing to rank"


def test_an_estimator_that_was_trained_on_what_it_is_ranked_by_is_warned_of(tmp_path: Path) -> None:
    """Ranked by the whole store that it was trained on it came first, and nothing said so."""
    table = response()
    store, plain = made_store(tmp_path, table, training=30), plain_result(tmp_path / "plain")
    assert len(judged_samples(store, [plain], source=TAXEL_FORCE, noise=1e-3).cases) == 40, "one for each sample"
    made = made_samples(12, table)
    ranked = replace(made, cases=tuple(f"case {truth.sample}" for truth in made.truths))
    learned = replace(ranked, cases=ranked.cases[:8])
    one = Network((np.zeros((20, 4)),), (np.zeros(4),))
    weights = LearnedWeights(
        LAYOUT, SIZE, np.zeros(20), np.ones(20), (one,), one, np.eye(4), np.zeros(2), trained_on=learned.cases
    )
    (tmp_path / "weights.npz").write_bytes(weights.content())
    weights = read_weights(tmp_path / "weights.npz")
    seen = seen_in_training(weights, ranked)
    assert seen == 8
    for text in (as_text([], ranked, (), seen), " ".join(as_summary([], ranked, seen).split())):
        assert f"learned was trained on {seen} of these {len(ranked.truths)} grasps" in text
    unseen = seen_in_training(weights, replace(ranked, cases=ranked.cases[8:]))
    assert unseen == seen_in_training(replace(weights, trained_on=("",)), replace(ranked, cases=("",))) == 0
    assert "trained on" not in as_text([], ranked, (), unseen)


def test_a_ranking_says_how_many_specimens_there_are_and_how_the_noise_varies() -> None:
    apart = made_samples(12, response())
    shared = replace(
        apart,
        truths=tuple(replace(truth, specimen=truth.sample // 4) for truth in apart.truths),
        noise=np.linspace(1e-3, 2e-3, 12),
    )
    for text in (as_text([], shared, ()), " ".join(as_summary([], shared).split())):
        assert "12 grasps of 3 specimens" in text
        assert "noise of a reading 1 mN to 2 mN" in text
    assert record([], shared, {})["specimens"] == 3
    assert record([], shared, {})["noise"] == {"value": 1.5e-3, "low": 1e-3, "high": 2e-3, "unit": "N"}
    assert "12 grasps, " in as_text([], apart, ())


@pytest.mark.parametrize("contrasts", [(1.69, 1.69), (1.5, 4.0), (1.5, 100.0)])
def test_labels_of_contrasts_are_not_written_over_each_other(contrasts: tuple[float, float]) -> None:
    """All lumps may have one contrast, or nearly, around which a logarithmic axis labels every tick between powers of ten."""
    known = {"value": 0.5, "low": 0.4, "high": 0.6}
    errors = {"lateral_error": {"median": known}, "depth_error": {"median": known}}
    measures = {"detection_rate": known, **errors, "coverage": known, "lumps": 2}
    bins = {label: [{"low": 0.004, "high": 0.006, **measures}] for label in AXES}
    bins["contrast"] = [{"low": contrasts[0], "high": contrasts[1], **measures}]
    figure = errors_figure([{"name": "thesis", "bins": bins}])
    figure.draw_without_rendering()
    (axis,) = (axis for axis in figure.axes if axis.get_xlabel().startswith("shear modulus"))
    low, high = axis.get_xlim()
    ticks = [*axis.xaxis.get_major_ticks(), *axis.xaxis.get_minor_ticks()]
    shown = [tick.label1 for tick in ticks if tick.label1.get_text() and low <= tick.get_loc() <= high]
    spans = sorted((text.get_window_extent().x0, text.get_window_extent().x1) for text in shown)
    assert spans
    assert all(right <= left for (_, right), (left, _) in pairwise(spans))


def judged(name: str, probabilities: Sequence[float | None], found: Sequence[bool]) -> dict[str, Any]:
    """An estimator on samples of which the first half hold a lump."""
    rows = zip(probabilities, found, strict=True)
    places = [[0.0, 0.0, 0.0]] * (len(found) // 2) + [None] * (len(found) // 2)
    samples = [{"probability": p, "found": f, "truth": {"center": c}} for (p, f), c in zip(rows, places, strict=True)]
    return {"name": name, "samples": samples}


def test_the_roc_of_known_probabilities() -> None:
    present = np.array([True, True, True, False, False])
    alarms, detected = roc(np.array([0.9, 0.6, 0.6, 0.6, 0.1]), present)
    np.testing.assert_allclose(alarms, [0, 0, 0.5, 1])
    np.testing.assert_allclose(detected, [0, 1 / 3, 1, 1], err_msg="equal probabilities are taken together")


def test_the_roc_is_drawn_where_there_are_grasps_with_and_without_a_lump() -> None:
    half = judged("model_based", [0.9, 0.2, 0.3, 0.1], [True, False, False, False])
    silent = judged("thesis", [None] * 4, [True, True, True, False])
    figure = roc_figure([half, silent])
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["model based: area 0.750", "thesis: no probability stated"]
    assert colliding_words(figure) == []
    thesis = figure.axes[0].lines[-1]
    assert (thesis.get_xdata()[0], thesis.get_ydata()[0]) == (0.5, 1.0)
    record: dict[str, Any] = {"block_size": {"value": [0.04, 0.04, 0.02]}}
    assert "roc.png" in ranking_figures(record | {"estimators": [half, silent]})
    one_kind = {"name": "thesis", "samples": half["samples"][:2]}
    assert "roc.png" not in ranking_figures(record | {"estimators": [one_kind]})


def test_the_title_covers_no_estimator_of_the_legend() -> None:
    bins = {label: [] for label in AXES}
    names = ("learned", "model_based", "hypotheses", "thesis with reference", "thesis")
    figure = errors_figure([{"name": name, "bins": bins} for name in names])
    figure.draw_without_rendering()
    (legend,), title = figure.legends, figure._suptitle
    assert len(legend.get_texts()) == len(names)
    assert not legend.get_window_extent().overlaps(title.get_window_extent())
    assert "the estimators stand side by side" in figure.get_suptitle().replace("\n", " ")


def test_a_noise_that_nobody_chose_says_where_it_comes_from():
    assert noise_in_words(0.1 / 12**0.5) == "28.868 mN (of sensors that resolve 0.1 N, as the thesis's)"
    assert noise_in_words(2e-3) == "2 mN"
