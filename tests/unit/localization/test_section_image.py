"""Thesis, Appendix .2, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tactsim.errors import InvalidQuantity
from tactsim.localization.section_image import depth_share, lump_rows, section_image


def by_equation(upper, lower, rows, row):
    """Eq. .2.7 for one column, pixel by pixel, for 1 < r < M."""
    total = upper + lower
    return [
        upper + (i - 1) * (total - upper) / (row - 1) if i <= row else total + (i - row) * (lower - total) / (rows - row)
        for i in range(1, rows + 1)
    ]


def test_corrected_by_hand():
    # two columns, M = 5. Column 1: U = 3, L = 1, r = 1 + 4 x 1/4 = 2: 3, 4, then 4 to 1 in three steps: 3, 2, 1
    # Column 2: U = 2, L = 2, r = 3: 2, 3, 4, 3, 2
    image = section_image(np.array([3.0, 2.0]), np.array([1.0, 2.0]), (5, 2))
    np.testing.assert_allclose(image, np.array([[3, 4, 3, 2, 1], [2, 3, 4, 3, 2]]).T)


def test_as_printed_by_hand():
    # U = 1, L = 3, M = 4: r = 4 x 1/4 = 1, the first line divides by zero at its single row, the second: 4 + (i - 1)(3 - 4)/3
    image = section_image(np.array([1.0]), np.array([3.0]), (4, 1), "as_printed")
    np.testing.assert_allclose(image[:, 0], [4, 4 - 1 / 3, 4 - 2 / 3, 3])
    # U = 3, L = 1, M = 5: r = 3.75: 3 + (i - 1) x 1/2.75 up to row 3, then 4 + (i - 3.75)(1 - 4)/1.25
    image = section_image(np.array([3.0]), np.array([1.0]), (5, 1), "as_printed")
    np.testing.assert_allclose(image[:, 0], [3, 3 + 1 / 2.75, 3 + 2 / 2.75, 3.4, 1])


@pytest.mark.parametrize("seed", range(5))
def test_the_form_without_division_is_equation_2_7(seed):
    generator = np.random.default_rng(seed)
    upper, lower = generator.uniform(0.1, 2.0, (2, 9))
    image = section_image(upper, lower, (23, 9))
    rows = lump_rows(upper, lower, 23)
    wanted = np.array([by_equation(*column, 23, row) for *column, row in zip(upper, lower, rows, strict=True)]).T
    np.testing.assert_allclose(image, wanted, rtol=1e-12)
    wrong = np.array([by_equation(*column, 23, row * 1.01) for *column, row in zip(upper, lower, rows, strict=True)]).T
    assert np.abs(wrong / image - 1).max() > 1e-3


def test_a_lump_near_the_upper_jaw_is_shown_near_the_top_only_if_corrected():
    upper, lower = np.array([1.0, 3.0, 1.0]), np.array([1.0, 1.5, 1.0])
    corrected, printed = (section_image(upper, lower, (61, 101), form)[:, 50].argmax() for form in ("corrected", "as_printed"))
    assert corrected < 30 < printed
    assert depth_share(upper, lower)[1] == pytest.approx(1.5 / 4.5)
    assert depth_share(upper, lower, "as_printed")[1] == pytest.approx(3 / 4.5)


def test_rows_where_the_printed_equations_divide_by_zero():
    upper, lower = np.array([0.0, 2.0, 0.0]), np.array([0.0, 0.0, 2.0])
    np.testing.assert_allclose(lump_rows(upper, lower, 5), [3, 1, 5])
    np.testing.assert_allclose(lump_rows(upper, lower, 5, "as_printed"), [2.5, 5, 0])
    # no signal: black; only the upper: 2 falls to 0 in row 5; only the lower: rises to 2
    wanted = np.array([[0, 0, 0, 0, 0], [2, 1.5, 1, 0.5, 0], [0, 0.5, 1, 1.5, 2]]).T
    np.testing.assert_allclose(section_image(upper, lower, (5, 3)), wanted)
    assert np.isfinite(section_image(upper, lower, (5, 3), "as_printed")).all()


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (2, 3), (60, 100)])
@pytest.mark.parametrize("form", ["corrected", "as_printed"])
def test_every_size_is_finite_and_between_nothing_and_the_sum(shape, form):
    upper, lower = np.array([1.0, 0.0, 2.0, 0.3]), np.array([0.5, 0.0, 0.0, 3.0])
    image = section_image(upper, lower, shape, form)
    assert image.shape == shape
    assert np.isfinite(image).all()
    if form == "corrected":
        assert image.min() >= -1e-12
        assert image.max() <= 3.3 + 1e-12


def test_bad_arrays_are_refused():
    with pytest.raises(InvalidQuantity, match="two of the same shape"):
        section_image(np.ones(3), np.ones(4), (5, 5))
    with pytest.raises(InvalidQuantity, match="rows of the picture is -1"):
        section_image(np.ones(3), np.ones(3), (-1, 5))
    with pytest.raises(InvalidQuantity, match="not finite"):
        section_image(np.ones(3), np.array([1.0, np.nan, 1.0]), (5, 5))
