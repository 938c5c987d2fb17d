"""Where taxels lie."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tactsim.interfaces.taxel_layout import TaxelLayout


@pytest.mark.parametrize("count", [1, 2, 3, 16, 99])
@pytest.mark.parametrize("pitch", [0.3e-3, 1.1e-3, 10e-3])
def test_taxels_that_touch_share_their_borders(count, pitch):
    """Faces of the tissue are cut at every border; two of one place would leave a sliver between them."""
    borders = TaxelLayout(rows=2, columns=count, pitch=pitch, size=pitch).borders("x")
    assert len(np.unique(borders)) == count + 1
    assert_allclose(borders.mean(axis=1), pitch * (np.arange(count) - (count - 1) / 2), atol=1e-15)


def test_taxels_apart_leave_gaps():
    borders = TaxelLayout(rows=2, columns=3, pitch=10e-3, size=9e-3).borders("x")
    assert_allclose(borders, [[-14.5e-3, -5.5e-3], [-4.5e-3, 4.5e-3], [5.5e-3, 14.5e-3]], atol=1e-15)
