"""A result in words."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from pretence import pretended_result

from tactsim.cli.report import last_line, result_report, step_line
from tactsim.materials.library import LIBRARY
from tactsim.progress import Extent
from tactsim.results import Quantity, Result, Status, StepRecord
from tactsim.results.quantity import format_values

RESULT = pretended_result(Status.CONVERGED, "done", ())


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0008, "m", "800 µm"),
        (0.25, "1", "0.25"),
        (None, "Pa", "none"),
        ([[1.0, None], [3.0, 2.0]], "N", "2 x 2 values, 1 N to 3 N"),
        ([None], "N", "1 values, none finite"),
        ([45e3] * 5, "Pa", "5 values, all 45 kPa"),
        ([None, *[45e3] * 4], "Pa", "5 values, 45 kPa to 45 kPa"),
        (math.nan, "N", "nan N"),
        ([31.462e-6, 129.77e-6, 1.0359e-3], "m", "0.031462 mm, 0.12977 mm, 1.0359 mm"),
        ([0.0, 0.0], "N", "0 N, 0 N"),
        ([1, 2], "1", "1, 2"),
    ],
)
def test_values_with_units(value: object, unit: str, text: str) -> None:
    assert format_values(Quantity(value, unit, "")) == text


def test_a_component_that_is_round_off_beside_another_is_zero() -> None:
    assert format_values(Quantity([-2.4e-12, 6e-9, -6.112], "N", "")) == "0 N, 6e-09 N, -6.112 N"
    assert format_values(Quantity([[8.8e-15, 0.0148]] * 2, "N", "")) == "2 x 2 values, 0 N to 14.8 mN"
    record = StepRecord(1, 1, 0.0, {"jaw_force_upper_x": -7e-12, "jaw_force_upper_z": 6.1, "time": 1e-15})
    line = step_line(record, dict.fromkeys(record.values, "N"))
    assert "jaw_force_upper_x 0 N  jaw_force_upper_z 6.1 N  time 1e-15 N" in line


def test_the_last_line_reports_only_what_was_reached() -> None:
    place = Path("results/x")
    assert last_line(RESULT, place, {}) == "threshold pressure 17.2 kPa; result results/x"
    assert last_line(RESULT, place, {"a.png": b""}).endswith("; figure results/x/figures/a.png")
    missed = replace(RESULT, quantities={"threshold_pressure": Quantity(None, "Pa", "")})
    assert last_line(missed, place, {}).startswith("threshold pressure not reached;")
    assert last_line(replace(RESULT, quantities={}), place, {}).startswith("converged;")
    failed = replace(RESULT, status=Status.FAILED, reason="stuck")
    assert last_line(failed, place, {}).startswith("failed: stuck;")


def test_what_the_threshold_owes_to_an_assumption_stands_below_it() -> None:
    spread = f"icf_stable is {LIBRARY['icf_stable'].left_open}"
    result = replace(RESULT, assumptions=("exactly incompressible tissue", spread, "error in time below 0.001"))
    lines = result_report(replace(result, quantities=RESULT.quantities | {"time": Quantity(1.0, "s", "")})).splitlines()
    threshold = next(number for number, line in enumerate(lines) if line.strip().startswith("threshold_pressure"))
    assert lines[threshold + 1].strip() == f"assumption: {spread}"
    assert sum("assumption: " in line for line in lines) == 1
    assert lines[-1].endswith("3 assumptions listed in result.json")


def test_quantities_of_many_touches_share_a_line() -> None:
    """A switch probe on three tissues at three rates printed 72 lines."""
    touches = {f"force_{k}": Quantity([0.1 * k, 0.2 * k], "N", f"read, in N [closing], tissue {k}") for k in range(1, 6)}
    alone = {f"rate_{k}": Quantity(1e-3, "m/s", "") for k in (1, 2)}
    mixed = {f"odd_{k}": Quantity(1.0, "m" if k else "s", "") for k in range(5)}
    result = replace(RESULT, quantities={"first": Quantity(1.0, "N", ""), **touches, **alone, **mixed})
    names = [line.split("  ")[1] for line in result_report(result).splitlines() if line.startswith("  ")]
    assert names[:4] == ["first", "force_1 to _5", "rate_1", "rate_2"]
    assert names[4:9] == list(mixed)
    assert "10 values, 100 mN to 1 N  read, in N [closing], tissue 1 to tissue 5" in result_report(result)
    assert list(result.quantities)[1:6] == list(touches), "the names of the result are as they were"


def test_an_empty_result_can_be_reported() -> None:
    text = result_report(Result("k", Status.INTERRUPTED, ""))
    assert text == "interrupted\n  0 accepted steps; 0 assumptions listed in result.json"


def test_a_step_is_one_line() -> None:
    record = StepRecord(12, 4, 2.1e-10, {"displacement": 6.2e-4, "share": 0.5})
    line = step_line(record, {"displacement": "m", "share": "1"})
    assert line == "step   12  displacement 620 µm  share 0.5  4 iterations, residual 2.1e-10"
    assert "share 0.5" in step_line(record, {}), "without units every value is printed, in SI"
    unsolved = StepRecord(1, 0, 0.0, {"taxels": 3})
    assert step_line(unsolved, {"taxels": "1"}) == "step    1  taxels 3", "a step that Newton had no part in"


def test_a_step_says_how_far_the_run_is() -> None:
    record = StepRecord(3, 5, 1e-12, {"time": 0.5})
    line = step_line(record, {"time": "s"}, Extent("time", 2.0))
    assert line.startswith("step    3  25%  time 500 ms")
    assert "left" not in line
    assert step_line(record, {"time": "s"}, Extent("time", 2.0), 12.0).endswith("about 36 s left")
    assert step_line(record, {"time": "s"}, Extent("time", 2.0), 60.0).endswith("about 3 min left")
    assert "left" not in step_line(record, {"time": "s"}, Extent("time", 0.5), 12.0), "the run is at its end"


def test_a_line_shows_the_first_values_that_the_units_name() -> None:
    names = [f"value_{number}" for number in range(7)]
    line = step_line(StepRecord(1, 2, 0.0, dict.fromkeys(names, 1.0)), dict.fromkeys(names, "1"))
    assert "value_3" in line
    assert "value_4" not in line
