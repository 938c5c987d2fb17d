"""The unit in which a size is drawn."""

from __future__ import annotations

import pytest

from tactsim.plotting.canvas import scale_of


@pytest.mark.parametrize(
    ("largest", "prefixed"),
    [(2e6, "MPa"), (5e3, "kPa"), (1.0, "Pa"), (0.02, "mPa"), (4e-5, "µPa"), (3e-7, "nPa"), (0.0, "Pa")],
)
def test_the_number_drawn_lies_between_one_and_a_thousand(largest: float, prefixed: str) -> None:
    factor, unit = scale_of(largest, "Pa")
    assert unit == prefixed
    assert largest == 0.0 or 1.0 <= factor * largest < 1e3
