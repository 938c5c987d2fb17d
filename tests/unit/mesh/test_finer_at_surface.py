"""Elements finer than usual stand at the surface and grow into the depth."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.mesh.axisymmetric import edge_graded, finer_at_surface


def test_fine_elements_reach_along_the_surface_and_grow_into_the_depth() -> None:
    usual = edge_graded(np.zeros((1, 2)), finest=0.3, growth=0.5, coarsest=3.0, reach=4.0)
    size = finer_at_surface(usual, radii=np.zeros(1), finest=0.1, growth=0.5, reach=4.0)
    assert size(np.array([[0.0, 0.0], [4.0, 0.0], [2.0, 0.5]])) == pytest.approx([0.1, 0.1, 0.1])
    assert size(np.array([[0.0, -0.2], [4.2, 0.0]])) == pytest.approx([0.2, 0.2])
    deep = np.array([[1.0, -1.0], [0.0, -3.0], [9.0, 0.0]])
    assert size(deep[:2]) == pytest.approx(usual(deep[:2]))
    assert size(deep[2:]) == pytest.approx([0.1 + 0.5 * 5.0])


def test_fine_elements_reach_to_both_sides_of_each_radius() -> None:
    size = finer_at_surface(
        lambda points: np.full(len(points), 9.0), radii=np.array([2.0, 6.0]), finest=0.1, growth=0.5, reach=1.0
    )
    assert size(np.array([[1.0, 0.0], [3.0, 0.0], [5.0, 0.0], [7.0, 0.0]])) == pytest.approx([0.1] * 4)
    assert size(np.array([[0.0, 0.0], [4.0, 0.0], [6.0, -2.0], [10.0, -4.0]])) == pytest.approx([0.6, 0.6, 1.1, 2.6])
    assert size(np.array([[100.0, 0.0]])) == pytest.approx([9.0])
