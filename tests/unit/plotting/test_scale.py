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
