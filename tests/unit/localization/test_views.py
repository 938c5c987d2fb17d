"""Thesis, 6.3: three views of two matrices."""

from __future__ import annotations

import numpy as np
import pytest
from made_grasps import BALL

from tactsim.errors import InvalidQuantity
from tactsim.interfaces.readings import checked_readings
from tactsim.localization.section_image import section_image
from tactsim.localization.views import joined, pair_images, views, volume


def test_what_each_view_adds_up_by_hand():
    # rows from the front: U = [[1, 2], [3, 4], [5, 6]], L = 10 U
    upper = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    pictures = views(np.array([upper, 10 * upper]), (7, 5))
    np.testing.assert_allclose(pictures.front[0, [0, -1]], [9, 12])  # 1 + 3 + 5 and 2 + 4 + 6
    np.testing.assert_allclose(pictures.front[-1, [0, -1]], [90, 120])
    np.testing.assert_allclose(pictures.left[0, [0, 2, -1]], [11, 7, 3])  # row 3 (the back) at the left
    np.testing.assert_allclose(pictures.top[0, [0, -1]], [55, 66])  # row 3 at the top, U + L
    np.testing.assert_allclose(pictures.top[3, [0, -1]], [33, 44])
    np.testing.assert_allclose(pictures.top[-1, [0, -1]], [11, 22])


def test_front_view_is_the_section_between_the_sums_of_the_columns():
    forces = np.random.default_rng(3).uniform(0, 1, (2, 4, 6))
    for form in ("corrected", "as_printed"):
        pictures = views(forces, (60, 100), form=form)
        np.testing.assert_allclose(pictures.front, section_image(*forces.sum(axis=1), (60, 100), form), atol=1e-12)
        np.testing.assert_allclose(pictures.left, section_image(*forces.sum(axis=2)[:, ::-1], (60, 100), form), atol=1e-12)


@pytest.mark.parametrize("rows", [2, 3, 8])
def test_the_top_view_is_the_joined_pictures_of_the_pairs(rows):
    total = np.random.default_rng(rows).uniform(0, 1, (rows, 3))
    images, forces = pair_images(total, (11, 20)), np.stack([total, 0 * total])
    np.testing.assert_allclose(views(forces, (10 * (rows - 1) + 1, 20)).top, joined(images), atol=1e-12)
    np.testing.assert_allclose(images[0], section_image(total[-1], total[-2], (11, 20)), atol=1e-12)
    assert joined(images, "stacked").shape == (11 * (rows - 1), 20)
    np.testing.assert_allclose(joined(images, "added"), images.sum(axis=0))
    np.testing.assert_array_equal(joined(images, "stacked"), np.concatenate(images))
    assert views(forces, (11, 20), form="as_printed").top.shape == (11 * (rows - 1), 20)


@pytest.mark.parametrize("matrix", [(1, 1), (1, 5), (4, 1), (3, 3), (5, 8)])
@pytest.mark.parametrize("shape", [(1, 1), (2, 2), (60, 100)])
def test_every_matrix_and_size_has_finite_views(matrix, shape):
    forces = np.random.default_rng(1).uniform(0, 1, (2, *matrix))
    for given in (forces, 0 * forces, -forces):
        pictures = views(given, shape)
        for image in (pictures.front, pictures.left, pictures.top):
            assert image.shape == shape
            assert np.isfinite(image).all()
            assert image.min() >= 0
    printed = views(forces, shape, form="as_printed")
    assert all(np.isfinite(image).all() for image in (printed.front, printed.left, printed.top))
    assert volume(forces, (2, 3, 4)).shape == (2, 3, 4)


def test_without_signal_everything_is_black():
    pictures = views(np.zeros((2, 3, 3)))
    assert max(image.max() for image in (pictures.front, pictures.left, pictures.top)) == 0


def test_a_ball_of_finite_elements_is_shown_where_it_lies():
    pictures = views(BALL, (61, 101))
    row, column = np.unravel_index(pictures.front.argmax(), pictures.front.shape)
    assert 10e-3 + 20e-3 * column / 100 == pytest.approx(28e-3, abs=2.5e-3)
    assert 20e-3 * (1 - row / 60) == pytest.approx(12e-3, abs=2.5e-3)
    row, column = np.unravel_index(pictures.top.argmax(), pictures.top.shape)
    assert 30e-3 - 20e-3 * row / 60 == pytest.approx(14e-3, abs=2.5e-3)
    row, column = np.unravel_index(pictures.left.argmax(), pictures.left.shape)
    assert 30e-3 - 20e-3 * column / 100 == pytest.approx(14e-3, abs=5e-3)
    printed = views(BALL, (61, 101), form="as_printed")
    row, _ = np.unravel_index(printed.front.argmax(), printed.front.shape)
    assert 20e-3 * (1 - row / 60) < 10e-3, "the printed depth is upside down (E13)"


def test_the_volume_has_both_jaws_as_its_ends_and_its_maximum_at_the_ball():
    voxels = volume(BALL, (21, 21, 21))
    np.testing.assert_allclose(voxels[0, [0, -1]][:, [0, -1]], BALL[0][[0, -1]][:, [0, -1]])
    np.testing.assert_allclose(voxels[-1, [0, -1]][:, [0, -1]], BALL[1][[0, -1]][:, [0, -1]])
    depth, _, across = np.unravel_index(voxels.argmax(), voxels.shape)
    assert 0.2 < depth / 20 < 0.5
    assert across == 20


def test_invalid_taxels_lie_between_their_neighbours():
    forces = np.array([np.arange(9.0).reshape(3, 3), np.ones((3, 3))])
    valid = np.ones(forces.shape, bool)
    valid[0, 1, 1] = False
    broken = np.where(valid, forces, np.nan)
    np.testing.assert_allclose(checked_readings(broken, valid), forces)  # mean of 1, 3, 5, 7 is 4
    valid[0, 1, 2] = False  # a at the middle, b right: 4 a = 1 + 3 + 7 + b, 3 b = 2 + 8 + a: a = 43/11, b = 51/11
    readings = checked_readings(np.where(valid, forces, 1e9), valid)
    np.testing.assert_allclose(readings[0, 1], [3, 43 / 11, 51 / 11])
    assert np.isfinite(views(broken, valid=valid).front).all()
    np.testing.assert_allclose(views(broken, valid=np.isfinite(broken)).top, views(forces).top)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda f: f[0], "upper jaw first"),
        (lambda f: f[:, :0], "at least one row"),
        (lambda f: np.where(np.arange(3) == 2, np.nan, f), r"taxel U1,3 \(upper jaw, row 1, column 3\) reads nan"),
        (lambda f: np.stack([f[0], f[1] * np.inf]), r"taxel L1,1 \(lower jaw, row 1, column 1\) reads inf"),
    ],
)
def test_bad_readings_are_refused_and_the_taxel_named(change, words):
    with pytest.raises(InvalidQuantity, match=words):
        views(change(np.ones((2, 3, 3))))


def test_bad_masks_and_pictures_are_refused():
    forces = np.ones((2, 3, 3))
    with pytest.raises(InvalidQuantity, match="mask of valid taxels"):
        views(forces, valid=np.ones((3, 3), bool))
    with pytest.raises(InvalidQuantity, match="mask of valid taxels is int"):
        views(forces, valid=np.ones((2, 3, 3), int))
    with pytest.raises(InvalidQuantity, match="lower jaw are marked invalid"):
        views(forces, valid=np.stack([np.ones((3, 3), bool), np.zeros((3, 3), bool)]))
    with pytest.raises(InvalidQuantity, match="rows of the picture is 0"):
        views(forces, (0, 5))
    with pytest.raises(InvalidQuantity, match="number of pixels is -3"):
        views(forces, (5, -3))
    with pytest.raises(InvalidQuantity, match="row 2, column 1"):
        pair_images(np.array([[1.0], [np.nan]]))
    with pytest.raises(InvalidQuantity, match=r"sums of shape \(0, 3\)"):
        pair_images(np.ones((0, 3)))
    with pytest.raises(InvalidQuantity, match="pictures of shape"):
        joined(np.ones((3, 3)))
