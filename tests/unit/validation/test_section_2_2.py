"""The filter and the converter of the signal chain."""

from __future__ import annotations

from pathlib import Path

import pytest
from thesis_tables import TABLE as TABLE_OF_ROWS
from thesis_tables import write_tables

from tactsim.errors import CaseError, InvalidQuantity
from tactsim.validation import load_tables
from tactsim.validation.quantities.film import converter_force_step, filter_transfer

FILTER = "{kind: filter_transfer, cutoff: 40 Hz, sampling_rate: 80 Hz}"


def test_a_filter_that_cannot_be_sampled_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidQuantity, match="half the sampling_rate"):
        filter_transfer(cutoff=40.0, sampling_rate=80.0)
    text = TABLE_OF_ROWS.replace("{kind: stiffness_resolution, force: 0.1 N, displacement: 0.8 mm}", FILTER).replace(
        "125 N/m", "0.5"
    )
    with pytest.raises(CaseError, match=r"small\.yaml:12: rows\.0\.evaluate: cutoff 40 Hz of the low pass must be below half"):
        load_tables(write_tables(tmp_path, text))


def test_a_step_of_the_converter_is_worth_more_force_the_more_the_sensor_conducts() -> None:
    """By hand: V = 5 R C / (1 + R C) at R = 1 kohm, of which a step is 5 V over two to the sixteenth, and F = 20.94 C - 0.132."""
    for force in (0.5, 5.0, 25.0):
        conductance = (force + 0.132) / 20.94e3
        by_hand = 20.94e3 * (1 + 1e3 * conductance) ** 2 / 1e3 / 2**16
        assert converter_force_step(force=force) == pytest.approx(by_hand, rel=1e-9)  # round-off of a difference
