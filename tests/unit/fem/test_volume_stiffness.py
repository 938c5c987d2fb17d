"""The stiffness against what pressures leave of a change of volume: more in cells that are slim beside the others."""

from __future__ import annotations

import numpy as np
import pytest
from solids import box

from tactsim.fem.assembly.volume_stiffness import GROWTH, MOST, SLIM, VOLUME_STIFFNESS, block_volume_stiffness

USUAL = 2.0
"""Width of the cells that fill a block of 20 times that, so that all of it is fine."""


def stiffness_of(*lengths: float) -> np.ndarray:
    """That of the tetrahedra of one cell of these sides beside a block of usual cells."""
    block, cell = box([4 * USUAL] * 3, [4, 4, 4]), box(list(lengths), [1, 1, 1])
    far = np.array([[0.0, 0.0, 0.0], [20 * USUAL] * 3])  # nodes of no cell, which say how large the block is
    nodes = np.vstack([block.nodes, cell.nodes + 5 * USUAL, far])
    elements = np.vstack([block.elements, cell.elements + len(block.nodes)])
    stiffness = block_volume_stiffness(nodes, elements)
    np.testing.assert_array_equal(stiffness[: len(block.elements)], VOLUME_STIFFNESS)
    return stiffness[len(block.elements) :]


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [((3.0, 3.0, 3.0), VOLUME_STIFFNESS), ((4.0, 4.0, 0.6), VOLUME_STIFFNESS), ((0.5, 0.5, 4.0), MOST), ((0.5, 0.5, 0.5), MOST)],
    ids=["wide", "thin, in the middle of a face", "slim, along an edge", "small"],
)
def test_slim_cells_are_the_stiffest(lengths: tuple[float, ...], expected: float) -> None:
    np.testing.assert_array_equal(stiffness_of(*lengths), expected)


def test_it_grows_with_a_power_of_the_width() -> None:
    width = 0.4 * USUAL
    np.testing.assert_allclose(stiffness_of(width, width, 3 * width), VOLUME_STIFFNESS * (SLIM / 0.4) ** GROWTH, rtol=1e-12)


def test_cells_at_edges_that_are_coarse_in_the_block_have_no_more() -> None:
    """Jaws on a block of few cells would else press too lightly."""
    mesh = box([4.0, 4.0, 4.0], [4, 4, 4])
    nodes, elements = mesh.nodes, mesh.elements
    graded = np.where(nodes < 1, 0.3 * nodes, 0.3 + (nodes - 1) * 3.7 / 3)
    assert block_volume_stiffness(graded, elements).max() == VOLUME_STIFFNESS
    graded = np.where(nodes < 1, 0.1 * nodes, 0.1 + (nodes - 1) * 3.9 / 3)
    assert block_volume_stiffness(graded, elements).max() == MOST
    assert block_volume_stiffness(graded, elements, pressed=2.0).max() == VOLUME_STIFFNESS, "under a jaw of half the block"


@pytest.mark.parametrize("scale", [1e-3, 0.5])
def test_a_mesh_with_all_cells_smaller_has_the_same(scale: float) -> None:
    """So that refinement changes the discretisation alone."""
    mesh = box([1.0, 1.0, 1.0], [6, 6, 6])
    graded = mesh.nodes**2
    stiffness = block_volume_stiffness(graded, mesh.elements)
    np.testing.assert_allclose(block_volume_stiffness(scale * graded, mesh.elements), stiffness, rtol=1e-12)
    assert set(np.unique(stiffness)) > {VOLUME_STIFFNESS, MOST}
