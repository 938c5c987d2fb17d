"""Thesis, Appendix .1, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import InvalidQuantity
from tactsim.localization.bands import band_image, band_intensities, band_weights, element_positions, inserted_elements


def test_intensities_by_hand():
    # alpha = 2, K = 256: 0.5/2 x 255 = 63.75; 2/2 x 255 = 255; 3 > alpha: 255; a pull counts as none
    np.testing.assert_allclose(band_intensities(np.array([0.0, 0.5, 2.0, 3.0, -1.0]), 2.0), [0, 63.75, 255, 255, 0])
    np.testing.assert_allclose(band_intensities(np.array([[0.5], [1.0]]), 1.0, 3), [[1.0], [2.0]])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"grey_levels": -1}, "number K of grey levels is -1"),
        ({"grey_levels": 1}, "whole numbers from 2"),
        ({"grey_levels": 2.5}, "whole numbers"),
        ({"normalising": 0.0}, "alpha is 0"),
        ({"normalising": float("nan")}, "alpha is nan"),
        ({"signals": np.array([1.0, np.nan])}, r"\(2,\), counted from 1"),
    ],
)
def test_bad_levels_are_refused(change, words):
    with pytest.raises(InvalidQuantity, match=words):
        band_intensities(**({"signals": np.ones(2), "normalising": 1.0} | change))


def test_whole_spacing_by_hand():
    # n = 3, N = 5: (5 - 3)/2 = 1 inserted between two; elements at pixels 1, 3, 5; halves between
    assert inserted_elements(3, 5) == 1
    np.testing.assert_allclose(element_positions(3, 5), [1, 3, 5])
    np.testing.assert_allclose(band_image(np.array([2.0, 4.0, 10.0]), 5), [2, 3, 4, 7, 10])


def test_spacing_that_is_not_whole_by_hand():
    # n = 3, N = 4: element 2 at pixel 2.5; pixel 2 lies 2/3 of the way from V1 = 0 to V2 = 3, pixel 3 a third from V2 to V3 = 6
    assert inserted_elements(3, 4) == 0.5
    np.testing.assert_allclose(element_positions(3, 4), [1, 2.5, 4])
    np.testing.assert_allclose(band_image(np.array([0.0, 3.0, 6.0]), 4), [0, 2, 4, 6])
    np.testing.assert_allclose(band_image(np.array([0.0, 3.0, 0.0]), 4), [0, 2, 2, 0])


@pytest.mark.parametrize("elements", [1, 2, 3, 7, 32])
@pytest.mark.parametrize("pixels", [1, 2, 5, 60, 100])
def test_weights_are_a_mean_and_keep_a_line(elements, pixels):
    weights = band_weights(elements, pixels)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    assert weights.min() >= 0
    if elements > 1 and pixels > 1:
        line = weights @ np.arange(elements)
        np.testing.assert_allclose(line, np.linspace(0, elements - 1, pixels), atol=1e-12)


def test_as_printed_differs_between_elements_and_agrees_on_them():
    # n = 3, N = 5 as printed: pixel 2 is in the first range (1 to 1 + 4/3): V1 + 1 x (V2 - V1)/2 = 3; pixel 4 is in the third
    # (1 + 8/3 to 5), where V4 stands for V3: 10; pixels 1, 3, 5 by eq. .1.3
    signals = np.array([2.0, 4.0, 10.0])
    printed = band_image(signals, 5, "as_printed")
    np.testing.assert_allclose(printed, [2, 3, 4, 10, 10])
    assert np.abs(printed - band_image(signals, 5)).max() == pytest.approx(3.0)


def test_bad_arrays_are_refused():
    with pytest.raises(InvalidQuantity, match="at least one signal"):
        band_image(np.array([]), 5)
    with pytest.raises(InvalidQuantity, match=r"\(3,\), counted from 1, is not finite"):
        band_image(np.array([1.0, 2.0, np.inf]), 5)
    with pytest.raises(InvalidQuantity, match="number of pixels is 0"):
        band_image(np.ones(3), 0)
    with pytest.raises(InvalidQuantity, match="number of elements is 1"):
        inserted_elements(1, 5)
