"""Two tetrahedra along every edge of a block that rolls onto a jaw."""

from __future__ import annotations

import numpy as np
import pytest
from lumps import wedges

from tactsim.interfaces.solid import FACES
from tactsim.mesh.fitting.labelling import Surfaces, interfaces
from tactsim.mesh.fitting.wedges import side_patches, without_wedges
from tactsim.mesh.structured_block import structured_block

SIZE = np.array([3.0, 2.0, 1.0])
SIDES = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]


def split_grid():
    mesh = structured_block(SIZE, (3, 2, 2)).mesh
    corners, simplices = mesh.nodes[: mesh.corner_count], mesh.elements[:, :4]
    labels = np.zeros(len(simplices), np.int64)
    return corners, simplices, labels, interfaces(corners, simplices, labels, Surfaces(SIZE, []))


def volumes(corners, simplices):
    return np.linalg.det(corners[simplices[:, 1:]] - corners[simplices[:, :1]]) / 6


def test_edges_of_a_split_grid_get_two_tetrahedra_and_the_mesh_stays_whole():
    corners, simplices, labels, walls = split_grid()
    assert wedges(corners, simplices, SIZE) == 10, "of twenty: the case is one that the function must mend"
    moved, finer, kept, around = without_wedges(corners, simplices, labels, walls)
    assert wedges(moved, finer, SIZE) == 0
    np.testing.assert_array_equal(moved[: len(corners)], corners)
    assert (volumes(moved, finer) > 0).all()
    assert volumes(moved, finer).sum() == pytest.approx(SIZE.prod(), rel=1e-12)
    assert len(kept) == len(finer)
    assert (side_patches(finer, around) >= 0).sum() == len(around.triangles)
    facets, counts = np.unique(np.sort(finer[:, SIDES].reshape(-1, 3), axis=1), axis=0, return_counts=True)
    assert set(counts.tolist()) == {1, 2}, "neighbours share whole sides"
    assert {tuple(t) for t in facets[counts == 1].tolist()} == {tuple(t) for t in around.triangles.tolist()}
    for number, (_, axis, end) in enumerate(FACES):
        on_face = moved[around.triangles[around.patch == number]]
        np.testing.assert_allclose(on_face[..., axis], end * SIZE[axis], atol=1e-12)
        area = np.linalg.norm(np.cross(on_face[:, 1] - on_face[:, 0], on_face[:, 2] - on_face[:, 0]), axis=1).sum() / 2
        assert area == pytest.approx(SIZE.prod() / SIZE[axis])


def test_a_mesh_without_wedges_stays():
    mended = without_wedges(*split_grid())
    again = without_wedges(*mended)
    assert all(after is before for after, before in zip(again, mended, strict=True))
