"""How fast the pressure on a bonded block can grow: the bound of what penetration costs where other loads press too."""

from __future__ import annotations

import pytest

from tactsim.mechanics.contact.penetration_effect import bonded_block_rate


def test_a_slender_block_is_a_column_and_a_flat_one_is_stiffer_by_the_square_of_its_shape():
    """E = 3 G over the height, which both plates shorten; Gent & Lindley: 1 + 2 S^2 with S the loaded over the free area."""
    assert bonded_block_rate(1e3, (1e-6, 1e-6, 2.0)) == pytest.approx(2 * 3e3 / 2.0, rel=1e-9)
    width, depth, height = 0.04, 0.02, 0.005
    shape = width * depth / (2 * (width + depth) * height)
    assert bonded_block_rate(1e3, (width, depth, height)) == pytest.approx(2 * 3e3 / height * (1 + 2 * shape**2), rel=1e-12)
