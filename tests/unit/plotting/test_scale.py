"""The unit in which a size is drawn."""

from __future__ import annotations

import pytest

from tactsim.plotting.canvas import scale_of


@pytest.mark.parametrize(
    ("largest", "prefixed"),
    [(2e6, "MPa"), (5e3, "kPa"), (1.0, "Pa"), (4e-5, "µPa"), (3e-7, "nPa"), (0.0, "Pa")],
)
def test_the_number_drawn_lies_between_one_and_a_thousand(largest: float, prefixed: str) -> None:
    factor, unit = scale_of(largest, "Pa")
    assert unit == prefixed
    assert largest == 0.0 or 1.0 <= factor * largest < 1e3


def test_a_pressure_is_never_in_a_unit_that_is_a_letter_from_the_megapascal() -> None:
    assert scale_of(0.02, "Pa") == (1.0, "Pa")
    assert scale_of(0.02, "N") == (1e3, "mN")


def test_a_long_time_stays_in_seconds_and_an_inverse_length_is_no_thousand_of_ones():
    assert scale_of(2000.0, "s") == (1.0, "s")
    assert scale_of(2000.0, "1/m") == (1e-3, "1/mm")
    assert scale_of(2e9, "Pa") == (1e-9, "GPa")


@pytest.mark.parametrize("largest", [0.0, 1e-12, float("nan")])
def test_what_is_next_to_nothing_has_no_prefix(largest):
    assert scale_of(largest, "N") == (1.0, "N")
