"""The one colour map of pressure can be read in grey print and by the colour-blind, and no figure of a grasp takes another."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps

import tactsim
from tactsim.experiments.grasp.figures.views import colour_table
from tactsim.plotting.canvas import PRESSURE_COLOURS

SEEN = {
    "normal": np.eye(3),
    "protanopia": np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]),
    "deuteranopia": np.array([[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]),
}
"""Linear red, green and blue as dichromats see them: F. Vienot, H. Brettel & J. Mollon 1999."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear red, green and blue (ITU-R BT.709)."""


def lightness(name: str, sight: np.ndarray) -> np.ndarray:
    """CIE lightness of 64 levels of a colour map."""
    coded = colormaps[name](np.linspace(0, 1, 64))[:, :3]
    linear = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    return 116 * np.cbrt(np.clip(linear @ sight.T @ LUMINANCE, 1e-9, None)) - 16


@pytest.mark.parametrize("sight", SEEN)
def test_levels_get_lighter_to_everyone_and_in_grey_print(sight: str) -> None:
    steps = np.diff(lightness(PRESSURE_COLOURS, SEEN[sight]))
    assert steps.min() > 0.5, "half of what can just be told apart side by side, at every 64th"
    for wrong in ("jet", "hsv", "rainbow"):
        assert np.diff(lightness(wrong, SEEN[sight])).min() < 0


def test_the_page_has_the_colours_of_the_figures() -> None:
    expected = np.round(255 * colormaps[PRESSURE_COLOURS](np.arange(256))[:, :3]).astype(int)
    np.testing.assert_array_equal(np.reshape(colour_table(256), (-1, 3)), expected)


def test_figures_of_a_grasp_and_its_localization_name_no_colour_map() -> None:
    named = re.compile(r'"(viridis|plasma|inferno|magma|cividis|jet|hot)"')
    root = Path(tactsim.__file__).parent / "experiments"
    figures = [*root.glob("grasp/figures/*.py"), *root.glob("localization/figures/*.py")]
    lines_of_time = {"taxel_voltages.py", "detectability.py"}  # a colour for each line, of no pressure
    found = [path.name for path in figures if path.name not in lines_of_time and named.search(path.read_text(encoding="utf-8"))]
    assert len(figures) > 10
    assert found == []
