"""Whether a mesh made elsewhere is one whole body: in one piece, and without a hole that the case does not know of."""

from __future__ import annotations

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces.solid import FACES
from tactsim.mesh.block import FLATNESS
from tactsim.mesh.fitting.labelling import Surfaces, neighbours_of
from tactsim.mesh.quadratic import QuadraticMesh

NEAR = 1.0
"""Distance of a boundary facet from the wall of an empty space of the case, over its longest edge, up to which it may be that
wall: a ragged mesh is as far off as its elements are large."""


def check_whole(mesh: QuadraticMesh, surfaces: Surfaces, name: str) -> None:
    """Check that the tetrahedra are joined by their sides and bound nothing but the block and its empty spaces.

    Raises
    ------
    InputError
        With the number of pieces and the place of the smallest, or with the facets of a hole and where it is.
    """
    corners = mesh.elements[:, :4]
    across = neighbours_of(corners)
    pairs = np.nonzero(across >= 0)[0], across[across >= 0]
    count, pieces = scipy.sparse.csgraph.connected_components(
        scipy.sparse.coo_array((np.ones(len(pairs[0])), pairs), shape=(len(corners),) * 2), directed=False
    )
    if count > 1:
        sizes = np.bincount(pieces)
        place = _place(mesh.nodes[corners[pieces == sizes.argmin()]].reshape(-1, 3).mean(axis=0))
        raise InputError(
            f"{name}: the mesh is in {count} pieces that share no sides; the smallest has {sizes.min()} of {len(corners)} "
            f"tetrahedra, around {place}; allowed: one piece; merge the nodes where they touch, or leave the others out"
        )
    facets, _ = mesh.boundary_facets()
    stray = mesh.nodes[facets[~_known(mesh.nodes[facets], surfaces)][:, :3]]
    if len(stray):
        hollow = any(len(group) > 1 for group in surfaces.solids)
        known = "the faces of the block and the lumen of a tube" if hollow else "the faces of the block"
        raise InputError(
            f"{name}: {len(stray)} boundary facets, around {_place(stray.reshape(-1, 3).mean(axis=0))}, lie inside the block: "
            f"the mesh has a hole or a notch there; allowed are {known}; fill it, or describe it as a tube in inclusions"
        )


def _known(facets: Array, surfaces: Surfaces) -> Array:
    """Whether each boundary facet, by the places (F, 6, 3) of its nodes, lies on a face of the block or near an empty space."""
    on = [
        np.abs(facets[..., axis] - surfaces.size[axis] * end).max(axis=1) <= FLATNESS * surfaces.size.max()
        for _, axis, end in FACES
    ]
    known = np.any(on, axis=0)
    corners = facets[:, :3]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    for _, *spaces in surfaces.solids:
        for space in spaces:
            known |= np.abs(space.signed_distance(corners.mean(axis=1))) <= NEAR * longest
    return np.asarray(known)


def _place(point: Array) -> str:
    return f"({', '.join(f'{1e3 * coordinate:.4g}' for coordinate in point)}) mm"
