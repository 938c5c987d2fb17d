"""The stiffness against what pressures leave of a change of volume: more in slim cells, alike in any turn of a block."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import box

from tactsim.fem.assembly.volume_stiffness import MOST, VOLUME_STIFFNESS, block_volume_stiffness

SIDE = 20.0


def stiffness_of(*lengths: float, count: int = 1) -> np.ndarray:
    """That of a box of these sides in a block of ``SIDE``, made of ``count`` cells along each axis."""
    mesh = box(list(lengths), [count] * 3)
    far = SIDE * np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])  # nodes of no cell, which say how large the block is
    return block_volume_stiffness(np.vstack([mesh.nodes, far]), mesh.elements)


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [((3.0, 3.0, 3.0), VOLUME_STIFFNESS), ((4.0, 4.0, 0.6), VOLUME_STIFFNESS), ((0.5, 0.5, 4.0), MOST), ((0.5, 0.5, 0.5), MOST)],
    ids=["in the middle", "thin, in the middle of a face", "slim, along an edge", "small"],
)
def test_slim_cells_are_the_stiffest(lengths: tuple[float, ...], expected: float) -> None:
    np.testing.assert_array_equal(stiffness_of(*lengths), expected)


def test_it_grows_with_the_fourth_power_of_the_width() -> None:
    coarse, fine = stiffness_of(1.2, 1.2, 1.2), stiffness_of(1.0, 1.0, 1.0)
    assert (coarse > VOLUME_STIFFNESS).all()
    assert (fine < MOST).all()
    np.testing.assert_allclose(fine / coarse, 1.2**4, rtol=1e-12)


def test_a_turn_of_the_cell_changes_nothing() -> None:
    mesh, far = box([0.8, 0.9, 1.1], [1, 1, 1]), SIDE * np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    turned = mesh.nodes @ Rotation.from_rotvec([0.2, 0.4, -0.3]).as_matrix().T + SIDE / 2
    both = [block_volume_stiffness(np.vstack([nodes, far]), mesh.elements) for nodes in (mesh.nodes, turned)]
    assert both[0].min() > VOLUME_STIFFNESS
    np.testing.assert_allclose(both[0], both[1], rtol=1e-12)
