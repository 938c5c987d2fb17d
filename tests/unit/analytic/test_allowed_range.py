"""The check of a range: what passes, what is refused, and what the message says."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.analytic.allowed_range import checked
from tactsim.errors import InvalidQuantity


@pytest.mark.parametrize("value", [0.0, 1.0, [0.0, 0.5], [], np.float64(0.3)])
def test_values_inside_pass_as_arrays_of_floats(value):
    values = checked("ratio", value, "[0, 1]")
    assert values.dtype == float
    np.testing.assert_array_equal(values, value)


@pytest.mark.parametrize(
    ("value", "allowed"),
    [
        (0.0, "(0, 1]"),
        (1.0, "[0, 1) m"),
        (np.nan, "[0, inf]"),
        (np.inf, "[0, inf) m"),
        ([0.1, -1e-9], "[0, 1]"),
        (-1.0, "(-1, 0.5]"),
    ],
)
def test_values_outside_are_refused(value, allowed):
    with pytest.raises(InvalidQuantity, match=r"ratio .* is out of range; allowed: ") as caught:
        checked("ratio", value, allowed)
    assert str(caught.value).endswith(allowed)


@pytest.mark.parametrize("value", ["much", 1j, None, [[1.0], [1.0, 2.0]]])
def test_what_is_no_real_number_is_refused(value):
    with pytest.raises(InvalidQuantity, match=r"ratio .*; allowed: "):
        checked("ratio", value, "[0, 1]")
