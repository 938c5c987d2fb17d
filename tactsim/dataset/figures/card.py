"""Figures of a data set for its card: how its numbers are spread, and what the taxels feel on average."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from tactsim.array import Array
from tactsim.dataset import load
from tactsim.interfaces.both_jaws import TAXEL_FORCE
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.plotting.canvas import PRESSURE_COLOURS, Plot, despined, scale_of, titled_figure

if TYPE_CHECKING:
    import xarray

MOST_PANELS, MOST_NUMBERED = 12, 8
TITLE, TITLE_SIZE = 0.3, 9.0
"""Height of a title in inches, and of its letters in points."""
COLUMNS = 4
SAME = 1e-9
"""Relative difference of two numbers that differ by round-off only."""
SPREAD, TAXELS = "spread.png", "taxels.png"
FIGURE_FILES = (SPREAD, TAXELS)


@dataclass(frozen=True)
class Spread:
    """Values (n,) of a number in the samples, and their unit."""

    values: Array
    unit: str


def card_figures(store: str | Path) -> dict[str, Plot]:
    """File name -> drawing; empty for a data set without a sample that is done, or in which nothing differs.

    Raises
    ------
    StorageError
        If the data set cannot be read.
    """
    data = load(store)
    if not data.sizes["sample"]:
        return {}
    count = data.sizes["sample"]
    title = f"{data.attrs.get('title') or Path(store).name}: {count} sample{'' if count == 1 else 's'}"
    numbers = _numbers(data)
    drawings: dict[str, Plot] = {SPREAD: Plot(lambda: spread(numbers, title))} if numbers else {}
    if TAXEL_FORCE in data:
        drawings[TAXELS] = Plot(lambda: taxels(data[TAXEL_FORCE].values[:, -1].mean(axis=0), title))
    return drawings


def spread(numbers: dict[str, Spread], title: str) -> Figure:
    """Histogram of each of these numbers."""
    names = list(numbers)[:MOST_PANELS]
    rows = -(-len(names) // COLUMNS)
    with titled_figure(2.3 * COLUMNS, 1.7 * rows + TITLE, title, title_size=TITLE_SIZE) as figure:
        for number, name in enumerate(names, 1):
            values, unit = numbers[name].values, numbers[name].unit
            axis = figure.add_subplot(rows, COLUMNS, number)
            factor, shown = scale_of(float(np.abs(values).max(initial=0.0)), unit) if unit != "1" else (1.0, "")
            axis.hist(factor * values, bins=20, color="0.45")
            axis.set_title(name.replace("_", " ") + (f" in {shown}" if shown else ""), loc="left", fontsize=7)
            axis.yaxis.set_major_locator(MaxNLocator(nbins=3, integer=True))
            counted = np.array_equal(factor * values, np.round(factor * values))  # such as the number of inclusions
            axis.xaxis.set_major_locator(MaxNLocator(nbins=6 if counted else 4, integer=counted))
            axis.tick_params(labelsize=7)
            if number % COLUMNS == 1:
                axis.set_ylabel("values", fontsize=7)
            despined(axis)
    return figure


def taxels(force: Array, title: str) -> Figure:
    """Mean force (jaw, row, column) in N, row 1 at the bottom; of many rows or columns the first and the last are numbered."""
    factor, unit = scale_of(float(force.max(initial=0.0)), "N")
    with titled_figure(5.2, 2.4 + TITLE, title, title_size=TITLE_SIZE) as figure:
        for number, (side, values) in enumerate(zip(JAWS, force, strict=True), 1):
            axis = figure.add_subplot(1, 2, number)
            image = axis.imshow(
                factor * values, origin="lower", vmin=0.0, vmax=factor * float(force.max()), cmap=PRESSURE_COLOURS
            )
            axis.set_title(f"{side} jaw", loc="left")
            axis.set(xlabel="column, along x", ylabel="row, along y")
            for along, size in ((axis.yaxis, values.shape[0]), (axis.xaxis, values.shape[1])):
                numbered = list(range(size)) if size <= MOST_NUMBERED else [0, size - 1]
                along.set_ticks(numbered, [str(k + 1) for k in numbered])
            figure.colorbar(image, ax=axis, label=f"mean force in {unit}", shrink=0.8)
    return figure


def _numbers(data: xarray.Dataset) -> dict[str, Spread]:
    """Labels, what was drawn and is not a multiple of one of them, then readings of one number, finite values only."""
    numbers: dict[str, Spread] = {}
    whole: list[Array] = []
    for role in ("label", "varied", "reading"):
        for name, values in data.data_vars.items():
            if values.attrs["role"] != role or "flag_values" in values.attrs or (role == "reading" and values.ndim > 1):
                continue
            content = np.asarray(values.values, dtype=float)
            vector = content.ndim > 1 and content.shape[-1] == len("xyz")
            parts = {f"{name} {along}": content[..., k] for k, along in enumerate("xyz")} if vector else {str(name): content}
            for part, components in parts.items():
                finite = components[np.isfinite(components)]
                repeated = role == "varied" and any(_proportional(components, other) for other in whole)
                whole.append(components)
                if finite.size and np.ptp(finite) > 0 and not repeated:
                    numbers[part] = Spread(finite, str(values.attrs["units"]))
    return numbers


def _proportional(drawn: Array, label: Array) -> bool:
    """Whether a number (n,) is a multiple of another wherever it is finite, as a coefficient is of the shear modulus."""
    if label.size != drawn.size:
        return False
    known = np.isfinite(drawn)
    first, second = drawn[known], label.reshape(drawn.shape)[known]
    return bool(np.allclose(first * np.abs(second).max(initial=0.0), second * np.abs(first).max(initial=0.0), rtol=SAME, atol=0))
