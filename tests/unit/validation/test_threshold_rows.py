"""The threshold sensor: the reported threshold over the true one for a level of the small sensor, thickness and recess."""

from __future__ import annotations

from pathlib import Path

import pytest
from thesis_tables import shipped_table

from tactsim.errors import InputError
from tactsim.shipped import CASES
from tactsim.validation.inputs import Inputs
from tactsim.validation.quantities.film import full_scale_error
from tactsim.validation.quantities.threshold import equal_force_ratio, threshold_at_level
from tactsim.validation.study import RunOutcome

SHIPPED = CASES / "thesis"
HEADER = "displacement [mm], plate force [N], tissue rise [mm], small sensor force [N]\n"
ROWS = "0, 0, 0, 0\n1, 1, 0.4, 0\n2, 2, 0.8, 0\n3, 3, 0.8, 0.5\n4, 4, 0.8, 1\n"


def ratio(folder: Path, level: float) -> float:
    (folder / "curve.csv").write_text(HEADER + ROWS)
    dimensions = {"inner_radius": 1.5e-3, "outer_radius": 3e-3, "recess": 0.8e-3}
    return threshold_at_level(Inputs(folder=folder), "curve.csv", level, **dimensions)


def test_straight_lines_give_the_ratio_by_hand(tmp_path: Path) -> None:
    assert ratio(tmp_path, 0.5) == pytest.approx(1.5, rel=1e-9)  # the plate bears 3 N where the small sensor bears 0.5 N
    assert ratio(tmp_path, 0.25) == pytest.approx(1.25, rel=1e-9)


def test_a_level_beyond_the_curve_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="never bears 2 N"):
        ratio(tmp_path, 2.0)


def test_full_scale() -> None:
    assert full_scale_error(0.025, 25.0) == pytest.approx(0.625, rel=1e-12)  # 2.5 % of 25 N


def test_the_thickness_limit_of_the_shipped_sensor() -> None:
    (row,) = (row for row in shipped_table("section_3_1_1").rows if row.id == "thickness_limit")
    assert row.evaluate is not None
    assert row.evaluate(Inputs(folder=SHIPPED)) == pytest.approx(0.8e-3, rel=1e-6)  # 24 halvings of 1.6 mm


def test_a_linear_rise_needs_half_the_recess_for_twice_the_hardness() -> None:
    history = {"tissue_rise": (0.0, 0.4e-3, 0.8e-3), "reaction_force": (0.0, 1.0, 2.0)}
    run = RunOutcome(id="a", case_id="a", status="converged", reason="", quantities={}, history=history, seconds=1)
    ratio = equal_force_ratio(Inputs(studies={"s": (run,)}), "s", "a", recess=0.8e-3, hardness=2)
    assert ratio == pytest.approx(2, rel=1e-12)  # exact for a straight line
