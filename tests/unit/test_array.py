"""The choice of a few entries of an array."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.array import evenly_spaced


@pytest.mark.parametrize(("count", "most"), [(1000, 7), (10, 9), (5, 5), (3, 100)])
def test_the_chosen_entries_are_evenly_spaced_from_the_first_to_the_last(count: int, most: int) -> None:
    chosen = evenly_spaced(count, most)
    assert (len(chosen), chosen[0], chosen[-1]) == (min(count, most), 0, count - 1)
    assert np.ptp(np.diff(chosen)) <= 1, "steps differ by rounding alone"


def test_of_nothing_nothing_is_chosen() -> None:
    assert evenly_spaced(0, 5).tolist() == []
    assert evenly_spaced(1, 5).tolist() == [0]
