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
"""What slim cells of a block have. As much in coarse cells makes blocks too stiff; with 3 in slim ones, fine meshes disagree."""
SLIM = 0.06
"""Width of a cell over the least side of its block below which a grows: 1.2 mm in the block of 20 mm."""
GROWTH = 4
"""Power of one over the width with which it grows: what quadratic displacements leave of a smooth energy falls so."""


def block_volume_stiffness(nodes: Array, elements: Array) -> Array:
    """a (E,) of the tetrahedra ``elements`` (E, 10) between the ``nodes`` (n, 3) of a block: the slimmer, the stiffer.

    The width is that across the longest edge, the root of six volumes over its length: cells along an edge of a jaw are slim,
    those in the middle of its face, thin in one direction only, are not.
    """
    corners = nodes[elements[:, :4]]
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=-1).max(axis=(1, 2))
    width = np.sqrt(np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / longest)
    side = float(np.ptp(nodes, axis=0).min())
    return np.clip(VOLUME_STIFFNESS * (SLIM * side / width) ** GROWTH, VOLUME_STIFFNESS, MOST)
