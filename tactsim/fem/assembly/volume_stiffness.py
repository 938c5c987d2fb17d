"""How stiffly elements resist the change of volume that linear pressures leave: a of `Body`."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array

VOLUME_STIFFNESS = 3.0
"""What bodies in contact have at least.

Where a free face rolls onto a jaw or around a fillet, tissue that sticks beside it is strained without bound. Without this
stiffness its volume ratios are 0.7 to 1.2 there however fine the elements are, and thin ones turn inside out; docs/theory/mesh.md
has the figures, also of the constants below."""
MOST = 20.0
"""What slim cells of a block have. As much in wide cells makes blocks too stiff; with 3 in slim ones, fine meshes disagree."""
SLIM = 0.45
"""Width of a cell over that of the cells in the middle of the block below which a grows."""
FINE = 0.05
"""Width of a cell over the least side of the block and of what presses it above which none is slim, 1 mm of 20 mm: coarser edges
would be too stiff."""
GROWTH = 8
"""Power of one over the width with which it grows: cells next to slim ones have little more than wide ones."""


def block_volume_stiffness(nodes: Array, elements: Array, pressed: float = np.inf) -> Array:
    """a (E,) of the tetrahedra ``elements`` (E, 10) between the ``nodes`` (n, 3) of a block: the slimmer, the stiffer.

    ``pressed`` is the least side in m of the faces that press on it.
    The width of a cell is the geometric mean of its two lesser extents along the sides of the block: cells along an edge of a jaw
    are slim, those in the middle of its face, thin in one direction only, are not. Slim is what is so beside the cells that half
    of the volume lies in: to halve all cells of a mesh with fine edges changes no a, and its errors fall as with one for all.
    """
    corners = nodes[elements[:, :4]]
    least = np.sort(np.ptp(corners, axis=1), axis=1)[:, :2]
    width, volume = np.sqrt(least.prod(axis=1)), np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    order = np.argsort(width)
    usual = width[order][np.searchsorted(np.cumsum(volume[order]), volume.sum() / 2)]
    slim = min(SLIM * usual, FINE * pressed, FINE * np.ptp(nodes, axis=0).min())
    return np.clip(VOLUME_STIFFNESS * (slim / width) ** GROWTH, VOLUME_STIFFNESS, MOST)
