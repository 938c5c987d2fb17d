"""Rows of 3.1.2 on the trigger: the reported threshold over the true one for a level of the small sensor."""

from __future__ import annotations

from pathlib import Path

import pytest

from tactsim.errors import InputError
from tactsim.validation.evaluator import Inputs
from tactsim.validation.evaluators.full_scale_error import FullScaleError
from tactsim.validation.evaluators.threshold_at_level import ThresholdAtLevel

HEADER = "displacement [mm], plate force [N], tissue rise [mm], small sensor force [N]\n"
ROWS = "0, 0, 0, 0\n1, 1, 0.4, 0\n2, 2, 0.8, 0\n3, 3, 0.8, 0.5\n4, 4, 0.8, 1\n"


def ratio(folder: Path, level: float) -> float:
    (folder / "curve.csv").write_text(HEADER + ROWS)
    found = ThresholdAtLevel(curve="curve.csv", level=level, inner_radius=1.5e-3, outer_radius=3e-3, recess=0.8e-3)
    return found.found(Inputs(folder=folder))


def test_straight_lines_give_the_ratio_by_hand(tmp_path: Path) -> None:
    assert ratio(tmp_path, 0.5) == pytest.approx(1.5, rel=1e-9)  # the plate bears 3 N where the small sensor bears 0.5 N
    assert ratio(tmp_path, 0.25) == pytest.approx(1.25, rel=1e-9)
    assert ratio(tmp_path, 0.26) != pytest.approx(1.25, rel=3e-9)


def test_a_level_beyond_the_curve_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="never bears 2 N"):
        ratio(tmp_path, 2.0)


def test_full_scale() -> None:
    assert FullScaleError.example().found(Inputs()) == pytest.approx(0.625, rel=1e-12)  # 2.5 % of 25 N
