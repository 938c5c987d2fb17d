"""A user's own arrays of sensors as bands and as the section between them."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes

from tactsim.errors import CaseError
from tactsim.experiments.localization.figures.tactile_bands import bands_figure
from tactsim.experiments.localization.tactile_bands import GivenReadings, MeasuredReadings, TactileBands

UPPER, LOWER = (0.1, 0.5, 0.2), (0.1, 0.3, 0.0)
EXACT = 1e-12
"""Of grey levels up to 255: products and linear interpolation."""


def drawn(**fields):
    fields.setdefault("readings", GivenReadings(upper=UPPER, lower=LOWER))
    return TactileBands(**fields).run()


def test_levels_and_band_follow_the_equations_by_hand():
    result = drawn(pixels=5, normalising=0.4)
    assert result["levels_upper"].numbers == pytest.approx([63.75, 255.0, 127.5], rel=EXACT)  # 255 V / alpha, at most 255
    band = 255 * np.minimum(np.array([0.1, 0.3, 0.5, 0.35, 0.2]) / 0.4, 1.0)  # halfway between neighbours
    assert result["band_upper"].numbers == pytest.approx(band, rel=EXACT)
    assert "readings above 400 mN, which are drawn as it: 1" in " ".join(result.warnings)


def test_the_largest_reading_of_both_arrays_is_white():
    result = drawn(readings=GivenReadings(upper=LOWER, lower=UPPER), pixels=101)  # the middle element on the middle pixel
    assert result["normalising_force"].value == 0.5
    assert result["band_lower"].numbers.max() == 255.0
    assert result["band_upper"].numbers.max() == pytest.approx(153.0, rel=EXACT)  # 255 * 0.3 / 0.5


def test_a_lump_is_drawn_nearer_to_the_array_that_reads_more():
    near_upper, near_lower = drawn(), drawn(readings=GivenReadings(upper=LOWER, lower=UPPER))
    assert near_upper["depth_share"].numbers == pytest.approx([1 / 2, 3 / 8, 0.0], rel=EXACT)  # G_L / (G_L + G_U)
    for result, half in ((near_upper, slice(0, 30)), (near_lower, slice(30, 60))):
        section = result["section"].numbers
        row, column = np.unravel_index(section.argmax(), section.shape)
        assert row in range(60)[half]
        assert column in (49, 50)


def test_the_printed_equations_put_it_on_the_wrong_side():
    section = drawn(form="as_printed")["section"].numbers
    assert np.unravel_index(section.argmax(), section.shape)[0] >= 30  # E13: the mutant of the test above


def test_one_array_has_no_section():
    result = drawn(readings=GivenReadings(upper=UPPER))
    assert not {"section", "band_lower", "depth_share"} & set(result.quantities)
    assert set(result.units) == {"element", "upper"}
    assert len(bands_figure(result).axes) == 2


def test_a_file_is_read_as_the_numbers_that_it_holds(tmp_path):
    path = tmp_path / "readings.csv"
    path.write_text("lower [mN], upper [N]\n" + "".join(f"{1e3 * low}, {high}\n" for low, high in zip(LOWER, UPPER, strict=True)))
    read = drawn(readings=MeasuredReadings(path=str(path)))
    assert read["section"].numbers == pytest.approx(drawn()["section"].numbers, rel=EXACT)
    assert len(bands_figure(read).axes) == 5


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("lower [N]\n1\n2\n", "no column upper"),
        ("upper [N]\n1\n", "from 2 to"),
        ("upper [V]\n1\n2\n", "upper"),
        ("upper [N], lower [N]\n1, 2\n3\n", "3"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, text, words):
    path = tmp_path / "readings.csv"
    path.write_text(text)
    with pytest.raises(CaseError, match=words):
        drawn(readings=MeasuredReadings(path=str(path)))


def test_fewer_pixels_than_elements_are_refused():
    with pytest.raises(CaseError, match="at least one for each of the 3 elements"):
        drawn(pixels=2)


def test_arrays_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match="as many of both"):
        GivenReadings(upper=UPPER, lower=(0.1, 0.2))


def test_pulls_and_silence_are_said(monkeypatch):
    silent = drawn(readings=GivenReadings(upper=(0.0, -0.1)))
    assert "1 negative readings" in " ".join(silent.warnings)
    assert "black" in " ".join(silent.warnings)
    shades = []
    monkeypatch.setattr(Axes, "imshow", lambda self, levels, **style: shades.append(np.asarray(levels)))
    bands_figure(silent)
    assert not np.concatenate([shade.ravel() for shade in shades]).any()


def test_every_picture_says_what_white_is():
    """The section had a white of its own, of which nothing was said."""
    result = drawn()
    titles = [axis.get_title(loc="left") for axis in bands_figure(result).axes]
    assert titles[-1] == f"between the arrays, the upper one above; white is {1e3 * result['section'].numbers.max():.3g} mN"
    assert titles[0].endswith("white is 500 mN")
