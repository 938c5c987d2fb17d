"""Bands of grey levels of arrays of sensors, and the section between two: thesis, Fig. 2 and 3 of Appendix .1 and .2."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from tactsim.array import Array
from tactsim.experiments.localization.scene import BandsScene
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.localization.bands import GREY_LEVELS, band_intensities
from tactsim.plotting.canvas import Plot, result_figure
from tactsim.results import Result
from tactsim.units import format_quantity

BAND_HEIGHT, SECTION_HEIGHT = 0.75, 2.6
"""Of a picture in inches."""


class TactileBandsFigures(ResultFigures):
    """The bands."""

    kind: Literal["tactile_bands"] = "tactile_bands"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``bands.png``."""
        return {"bands.png": Plot(lambda: bands_figure(result))}


def bands_figure(result: Result) -> Figure:
    """Each array as its elements and interpolated; the section between two, white at its largest intensity."""
    scene, section = result.scene_as(BandsScene), None
    white, pictures = format_quantity(scene.normalising, "N"), list[tuple[str, Array]]()
    for name in scene.arrays:
        levels, band = (result.quantities[f"{part}_{name}"].numbers for part in ("levels", "band"))
        array = "array" if len(scene.arrays) == 1 else f"{name} array"
        words = f"{array}, {levels.size} elements; white is {white}"
        pictures += [(words, levels[None]), (f"{array}, {band.size} pixels", band[None])]
    if "section" in result.quantities:
        section = result.quantities["section"].numbers
    heights = [BAND_HEIGHT] * len(pictures) + ([] if section is None else [SECTION_HEIGHT])
    with result_figure(result, (7.0, 1.0 + sum(heights) + 0.25 * len(heights)), "Readings as bands") as figure:
        axes = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
        for axis, (words, levels) in zip(axes, pictures, strict=False):
            _draw(axis, levels, words)
        if section is not None:
            white = format_quantity(float(f"{section.max():.3g}"), "N")  # not that of the bands: readings of both arrays add up
            words = f"between the arrays, the upper one above; white is {white}"
            _draw(axes[-1], band_intensities(section, float(section.max()) or 1.0), words)
        axes[-1].set_xlabel("pixel")
    return figure


def _draw(axis: Axes, levels: Array, words: str) -> None:
    """Grey levels (rows, columns) from black without signal to white."""
    axis.imshow(
        np.asarray(levels),
        cmap="gray",
        vmin=0,
        vmax=GREY_LEVELS - 1,
        aspect="auto",
        interpolation="nearest",
        extent=(0.5, levels.shape[1] + 0.5, 0, 1),
    )
    axis.set_yticks([])
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.set_title(words, fontsize=9, loc="left")
