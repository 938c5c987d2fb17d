"""What the taxels of several results read, side by side: small maps on one colour scale, and how far they are from the first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import FigureBase

from tactsim.interfaces.both_jaws import READ_FORCE, TAXEL_FORCE, TAXEL_PRESSURE, VOLTAGE
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.outside.text import one_line
from tactsim.plotting.canvas import PRESSURE_COLOURS, ink_on, scale_of, with_minus
from tactsim.results import Quantity, Result
from tactsim.results.compared_numbers import difference

MAPPED = {TAXEL_FORCE: "force on the taxel", READ_FORCE: "force read by the taxel", VOLTAGE: "voltage of the taxel"}
"""What is drawn, with its words: the first that every result has."""
OF_ANY_SIZE = {TAXEL_PRESSURE: "mean pressure on the taxel"}
"""What is drawn first of taxels that are not alike, whose forces say nothing of each other."""
DIFFERENCE_COLOURS = "RdBu_r"
MOST_MAPPED = 5
"""More results than this have no maps beside each other."""
MOST_WRITTEN = 10
"""Matrices with more rows or columns than this have no numbers written in them."""
SMALL = 0.01
"""Part of the largest number of a scale below which another is written with the decimals of that one."""
MAP_SIZE, HEAD, BAR = 1.75, 1.1, 0.6
"""Width and height in inches of a map with its names, height of names and a colour bar, and of one more."""
LONGEST_HEADING = 18


@dataclass(frozen=True)
class TaxelMaps:
    """Arrays [row][column] of every result, by the jaw, in SI."""

    words: str
    unit: str
    values: Mapping[str, tuple[Quantity, ...]]

    def apart(self, side: str) -> list[np.ndarray | None]:
        """The maps of a jaw less that of the first result, None where the shapes are not the same."""
        first, *others = self.values[side]
        return [difference(first, one) for one in others]

    @property
    def has_differences(self) -> bool:
        """Whether any result can be held against the first."""
        return any(one is not None for side in self.values for one in self.apart(side))

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the drawing in inches."""
        count = len(self.values[JAWS[0]])
        two = count == 2 and self.has_differences
        below = self.has_differences and not two
        return MAP_SIZE * (count + two), MAP_SIZE * len(self.values) * (1 + below) + HEAD + BAR * below


@dataclass(frozen=True)
class Colours:
    """A colour map from one number to another."""

    name: str
    low: float
    high: float

    @property
    def norm(self) -> Normalize:
        """From a number to a part of the map."""
        return Normalize(self.low, self.high)

    @property
    def mappable(self) -> ScalarMappable:
        """What a colour bar shows."""
        return ScalarMappable(self.norm, self.name)


def taxel_maps(results: Mapping[str, Result]) -> TaxelMaps | None:
    """What the taxels of all results read, of different ones their pressures; None if one has no taxels or there are too many
    results.
    """
    layouts = [getattr(result.scene, "matrix", None) for result in results.values()]
    alike = all(layout == layouts[0] for layout in layouts)
    for name, words in (MAPPED if alike else OF_ANY_SIZE | MAPPED).items():
        held = {side: [r[key] for r in results.values() if (key := f"{name}_{side}") in r] for side in JAWS}
        every = [one for ones in held.values() for one in ones]
        complete = all(len(ones) == len(results) for ones in held.values()) and len({one.unit for one in every}) == 1
        if complete and len(results) <= MOST_MAPPED and all(map(_is_map, every)):
            return TaxelMaps(words, every[0].unit, {side: tuple(ones) for side, ones in held.items()})
    return None


def _is_map(quantity: Quantity) -> bool:
    return quantity.numbers.ndim == 2 and bool(np.isfinite(quantity.numbers).any())


def draw_maps(figure: FigureBase, maps: TaxelMaps, names: Sequence[str]) -> None:
    """A map of each jaw for each result; of two results the difference beside them, of more those from the first below them."""
    count, apart = len(names), maps.has_differences
    beside = apart and count == 2
    grid = figure.subplots(len(JAWS) * (2 if apart and not beside else 1), count + beside, squeeze=False)
    forces = [one.numbers for ones in maps.values.values() for one in ones]
    factor, unit = scale_of(max(float(np.nanmax(np.abs(one), initial=0.0)) for one in forces), maps.unit)
    low, high = (factor * bound for bound in (min(np.nanmin(one) for one in forces), max(np.nanmax(one) for one in forces)))
    scale = Colours(PRESSURE_COLOURS, min(0.0, low), high if high > min(0.0, low) else 1.0)
    differences = [one for side in JAWS for one in maps.apart(side) if one is not None]
    largest = max((float(np.nanmax(np.abs(one), initial=0.0)) for one in differences), default=0.0)
    small, small_unit = scale_of(largest, maps.unit) if largest else (factor, unit)
    bound = small * largest or scale.high or 1.0
    scale_apart = Colours(DIFFERENCE_COLOURS, -abs(bound), abs(bound))
    for number, side in enumerate(JAWS):
        row = number if beside or not apart else 2 * number
        for axis, one in zip(grid[row], maps.values[side], strict=False):
            _draw_map(axis, factor * one.numbers, scale)
        grid[row, 0].set_ylabel(f"{side} jaw")
        below: Any = grid[row, count:] if beside else grid[row + 1, 1:] if apart else []
        for axis, values in zip(below, maps.apart(side), strict=False):
            if values is None:
                axis.set_axis_off()
            else:
                _draw_map(axis, small * values, scale_apart, "+")
        if apart and not beside:
            grid[row + 1, 0].set_axis_off()
            grid[row + 1, 1].set_ylabel(f"{side} jaw,\nless the first")
    for axis, name in zip(grid[0], names, strict=False):
        axis.set_title(one_line(name, LONGEST_HEADING), parse_math=False)
    if beside:
        grid[0, -1].set_title("second less first")
    style: dict[str, Any] = {"location": "bottom", "aspect": 30, "pad": 0.02}
    bar = figure.colorbar(scale.mappable, ax=grid[:, :count] if beside or not apart else grid, shrink=0.8, **style)
    bar.set_label(f"{maps.words} in {unit}; row 1 at the front")
    if apart:
        bar = figure.colorbar(scale_apart.mappable, ax=grid[:, count:] if beside else grid, shrink=0.8, **style)
        bar.set_label(f"difference in {small_unit}")


def _draw_map(axis: Axes, values: np.ndarray, scale: Colours, sign: str = "") -> None:
    """A matrix with its numbers, row 1 at the bottom; ``sign`` is that of a format."""
    axis.imshow(values, cmap=scale.name, norm=scale.norm, origin="lower")
    rows, columns = values.shape
    size, colours = float(np.clip(24 / max(rows, columns), 4.0, 8.0)), colormaps[scale.name]
    for (row, column), value in np.ndenumerate(values) if max(rows, columns) <= MOST_WRITTEN else ():
        if np.isfinite(value):
            style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": size, "in_layout": False}
            axis.text(column, row, _written(float(value), scale, sign), color=ink_on(colours(scale.norm(float(value)))), **style)
    axis.set_xticks(_ticks(columns), [str(k + 1) for k in _ticks(columns)], fontsize=7)
    axis.set_yticks(_ticks(rows), [str(k + 1) for k in _ticks(rows)], fontsize=7)
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)


def _written(value: float, scale: Colours, sign: str) -> str:
    """A number of three digits; one that is small beside the largest has no more decimals than that."""
    largest = max(abs(scale.low), abs(scale.high))
    if abs(value) >= SMALL * largest:
        digits = 2 if sign else 3
        return with_minus(np.format_float_positional(float(f"{value:.{digits}g}"), trim="-", sign=bool(sign)))
    if not value:
        return "0"
    decimals = max(0, 2 - math.floor(math.log10(largest)))
    words = f"{value:{sign}.{decimals}f}"
    return with_minus(words) if float(words) else words.lstrip("+-")


def _ticks(count: int) -> list[int]:
    """Places of the rows or columns that are numbered: all of a few, else the first and the last."""
    return list(range(count)) if count <= MOST_WRITTEN else [0, count - 1]
