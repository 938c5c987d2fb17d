"""Figures of a data set for its card: how its numbers are spread, and what the taxels feel on average."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tactsim.array import Array
from tactsim.dataset import load
from tactsim.plotting.canvas import despined, new_figure, png, scale_of, styled
from tactsim.plotting.colours import PRESSURE_COLOURS

if TYPE_CHECKING:
    import xarray

Drawing = Callable[[], bytes]
MOST_PANELS = 12
COLUMNS = 4
SPREAD, TAXELS = "spread.png", "taxels.png"
FIGURE_FILES = (SPREAD, TAXELS)
JAWS = ("upper jaw", "lower jaw")


def card_figures(store: str | Path) -> dict[str, Drawing]:
    """File name -> drawing; empty for a data set without a sample that is done.

    Raises
    ------
    StorageError
        If the data set cannot be read.
    """
    data = load(store)
    if not data.sizes["sample"]:
        return {}
    drawings: dict[str, Drawing] = {SPREAD: lambda: spread(_numbers(data))}
    if "taxel_force" in data:
        drawings[TAXELS] = lambda: taxels(data["taxel_force"].values[:, -1].mean(axis=0))
    return drawings


def spread(numbers: dict[str, tuple[Array, str]]) -> bytes:
    """Histogram of each of these values, with their units."""
    names = list(numbers)[:MOST_PANELS]
    rows = -(-len(names) // COLUMNS)
    with styled():
        figure = new_figure(2.3 * COLUMNS, 1.7 * rows)
        for number, name in enumerate(names, 1):
            values, unit = numbers[name]
            axis = figure.add_subplot(rows, COLUMNS, number)
            factor, shown = scale_of(float(np.abs(values).max(initial=0.0)), unit) if unit != "1" else (1.0, "")
            axis.hist(factor * values, bins=20, color="0.45")
            axis.set_title(name.replace("_", " ") + (f" [{shown}]" if shown else ""), fontsize=7)
            axis.set_yticks([])
            despined(axis)
        return png(figure)


def taxels(force: Array) -> bytes:
    """Mean force (jaw, row, column) in N, row 1 at the bottom."""
    with styled():
        figure = new_figure(5.2, 2.4)
        for number, (name, values) in enumerate(zip(JAWS, force, strict=True), 1):
            axis = figure.add_subplot(1, 2, number)
            image = axis.imshow(values, origin="lower", vmin=0.0, vmax=float(force.max()), cmap=PRESSURE_COLOURS)
            axis.set_title(f"mean force, {name}")
            axis.set_xticks(range(values.shape[1]), [str(k + 1) for k in range(values.shape[1])])
            axis.set_yticks(range(values.shape[0]), [str(k + 1) for k in range(values.shape[0])])
            figure.colorbar(image, ax=axis, label="N", shrink=0.8)
        return png(figure)


def _numbers(data: xarray.Dataset) -> dict[str, tuple[Array, str]]:
    """Labels, then readings of one number, finite values only."""
    numbers = {}
    for role in ("label", "reading"):
        for name, values in data.data_vars.items():
            if values.attrs["role"] != role or "flag_values" in values.attrs or (role == "reading" and values.ndim > 1):
                continue
            content = np.asarray(values.values, dtype=float)
            finite = content[np.isfinite(content)]
            if finite.size and np.ptp(finite) > 0:
                numbers[str(name)] = finite, str(values.attrs["units"])
    return numbers
