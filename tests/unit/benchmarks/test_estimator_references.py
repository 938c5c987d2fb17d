"""The stored report of estimators with other references: its text is its numbers, and a run makes its estimates anew."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "docs" / "verification"
STORED = json.loads((FOLDER / "estimators.json").read_text(encoding="utf-8"))
REMADE = 2
"""Samples that the slow test computes."""


@pytest.fixture
def report(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    return importlib.import_module("estimator_references")


def entry(content: dict, reference: str, estimator: str, factor: str) -> dict:
    (one,) = [
        one for one in content["entries"] if (one["reference"], one["estimator"], one["factor"]) == (reference, estimator, factor)
    ]
    return one


def test_the_text_is_that_of_the_numbers(report: ModuleType) -> None:
    assert (FOLDER / "estimators.md").read_text(encoding="utf-8") == report.as_text(STORED)
    other = json.loads(json.dumps(STORED))
    other["entries"][0]["measures"]["detection_rate"]["value"] -= 0.2
    assert report.as_text(other) != report.as_text(STORED)


def test_every_reference_and_estimator_is_judged_on_the_same_grasps(report: ModuleType) -> None:
    assert [(e["reference"], e["estimator"], e["factor"]) for e in STORED["entries"]] == [
        (reference, *key) for reference in report.REFERENCES for key in report.ESTIMATORS
    ]
    assert {e["measures"]["samples"] for e in STORED["entries"]} == {STORED["samples"]}
    assert f"--samples {STORED['samples']}" in STORED["command"]


def test_the_factor_is_what_a_softer_reference_needs(report: ModuleType) -> None:
    fitted, rigid = (entry(STORED, "softer", "model_based", one)["measures"] for one in (report.FACTOR, report.RIGID))
    assert fitted["false_alarm_rate"]["high"] < rigid["false_alarm_rate"]["low"]
    assert fitted["score"]["value"] < 0.6 * rigid["score"]["value"]
    assert fitted["coverage"]["value"] > rigid["coverage"]["high"]


@pytest.mark.slow
def test_a_run_makes_the_first_estimates_anew(report: ModuleType, tmp_path: Path) -> None:
    made = report.record(tmp_path, REMADE, ["matched"], ["model_based"])
    for factor in (report.FACTOR, report.RIGID):
        now, then = (entry(one, "matched", "model_based", factor)["first_samples"] for one in (made, STORED))
        assert [row["sample"] for row in now] == list(range(REMADE))
        for row, kept in zip(now, then, strict=False):
            assert row["warned"] == kept["warned"]
            assert (row["center_mm"] is None) == (kept["center_mm"] is None)
            assert row["factor"] == pytest.approx(kept["factor"], abs=1e-3)
            if row["center_mm"] is not None:
                assert row["center_mm"] == pytest.approx(kept["center_mm"], abs=0.1)  # a tenth of the grid of centres
