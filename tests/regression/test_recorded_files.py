"""Files that came from a run are what the run gives now; each names the command that makes it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import tactsim as ts

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
import recorded_signals  # noqa: E402  a script beside the package

PART = 1e-3
"""Largest difference of a recorded force from a remade one, over the largest: steps that another machine takes elsewhere."""


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
