"""Files that came from a run are what the run gives now; each names the command that makes it."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactsim as ts
from tactsim.experiments.switch_probe.probe_curve import CHAPTER_5

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
import probe_curve  # noqa: E402  a script beside the package
import recorded_signals  # noqa: E402  another

PART = 1e-3
"""Largest difference of a recorded force from a remade one, over the largest: steps that another machine takes elsewhere."""
GALLERY = ROOT / "docs" / "gallery"
STORED = sorted(path.parent for place in (ROOT / "cases", GALLERY) for path in place.glob("stored/*/result.json"))
"""Results that cases and pages read; `docs/gallery/plot_NAME.py` makes one anew where its folder is missing."""
BY_POINTS = {"min_volume_ratio": 0.05, "max_penetration": 0.2}
"""What single points decide, and by which part of it they may differ."""
SMALL = {"penetration_force_error": 1e-4}
"""Differences of large numbers, and by how much they may differ: by a part of the force that nobody sees."""
NOTHING = 1e-6
"""Of a number without a unit, such as an asymmetry: below this it is round-off."""


def recorded() -> np.ndarray:
    lines = [line for line in recorded_signals.RECORDED.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])


def test_the_recorded_signals_name_the_command_that_makes_them() -> None:
    text = recorded_signals.RECORDED.read_text(encoding="utf-8")
    assert "# Made by: tactsim run cases/annulus_icf.yaml" in text
    case = ts.load_case(
        ROOT / "cases" / "annulus_icf.yaml", {"experiment.stop": "displacement", "experiment.displacement": "4.6 mm"}
    )
    assert f"Case {case.case_id}." in text, "the case has changed: remake the file"


@pytest.mark.slow
def test_the_recorded_signals_are_what_the_run_gives(tmp_path: Path) -> None:
    case = ts.load_case(
        ROOT / "cases" / "annulus_icf.yaml", {"experiment.stop": "displacement", "experiment.displacement": "4.6 mm"}
    )
    case.run().save(tmp_path / "signals")
    remade, kept = np.array(recorded_signals.signals(tmp_path / "signals")), recorded()
    for column in (1, 2, 3):
        values = np.interp(kept[:, 0], remade[:, 0], remade[:, column])
        np.testing.assert_allclose(kept[:, column], values, atol=PART * remade[:, column].max())
        with pytest.raises(AssertionError):
            np.testing.assert_allclose(1.01 * kept[:, column], values, atol=PART * remade[:, column].max())


def test_the_curve_of_the_probe_names_the_command_that_makes_it() -> None:
    text = (ROOT / "tactsim" / "experiments" / "switch_probe" / "probe_curve.py").read_text(encoding="utf-8")
    assert "``python benchmarks/probe_curve.py``" in text
    assert (ROOT / "benchmarks" / "probe_curve.py").is_file()


@pytest.mark.slow
def test_the_curve_of_the_probe_is_what_finite_elements_give() -> None:
    """The force of the whole probe hardly knows the mesh; how high the tissue stands and what a strip carries jump from one
    point of the surface to the next."""
    kept = 1e3 * np.stack([CHAPTER_5.depth, CHAPTER_5.force, CHAPTER_5.contact_height, CHAPTER_5.switches[:, 0]], axis=1)
    remade = np.array(list(probe_curve.rows()))
    np.testing.assert_allclose(remade[:, 0], kept[:, 0], rtol=1e-6)

    def check(kept: np.ndarray) -> None:
        np.testing.assert_allclose(remade[:, 1], kept[:, 1], rtol=1e-3)
        deep = kept[:, 0] > 1.99
        np.testing.assert_allclose(remade[deep, 2], kept[deep, 2], atol=0.02)
        np.testing.assert_allclose(remade[:, 3], kept[:, 3], atol=4e-3)

    check(kept)
    for column, factor in ((1, 1.002), (2, 1.05), (3, 1.05)):
        wrong = kept.copy()
        wrong[:, column] *= factor
        with pytest.raises(AssertionError):
            check(wrong)


def differences(kept: dict[str, Any], remade: ts.Result) -> dict[str, float]:
    """Largest difference of every kept quantity over its largest value, if it is more than is allowed."""
    assert set(kept) == set(remade.quantities)
    wrong = {}
    for name, quantity in kept.items():
        first, second = (np.array(value, dtype=float) for value in (quantity["value"], remade.quantities[name].value))
        assert first.shape == second.shape, name
        size = max(float(np.nanmax(np.abs(first), initial=0.0)), NOTHING if quantity["unit"] == "1" else 0.0)
        difference = float(np.nanmax(np.abs(first - second), initial=0.0))
        if (
            difference > max(BY_POINTS.get(name, PART) * size, SMALL.get(name, 0.0))
            or (np.isnan(first) != np.isnan(second)).any()
        ):
            wrong[name] = difference / size
    return wrong


@pytest.mark.slow
@pytest.mark.parametrize("folder", STORED, ids=lambda folder: f"{folder.parents[1].name}-{folder.name}")
def test_a_stored_result_is_what_its_case_gives(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(GALLERY)  # where the results that a case reads are looked for
    case = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))["case"]["experiment"]
    kept = json.loads((folder / "result.json").read_text(encoding="utf-8"))["quantities"]
    remade = ts.kinds("experiment")[case["kind"]].model_validate(case).run()
    assert differences(kept, remade) == {}
    name = next(name for name, quantity in kept.items() if np.any(np.array(quantity["value"], dtype=float)))
    moved = {**kept, name: {**kept[name], "value": (1.3 * np.array(kept[name]["value"], dtype=float)).tolist()}}
    assert list(differences(moved, remade)) == [name]
