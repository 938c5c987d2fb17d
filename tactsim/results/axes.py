"""Axes of the arrays of a result: their names, and the places, times and other values along them."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from tactsim.results.quantity import Coordinate, Quantity

COMPONENTS = ("x", "y", "z")


def dimensions(name: str, quantity: Quantity) -> tuple[str, ...]:
    """Names of the axes of a quantity's array, empty where only their number is known.

    They stand in the description: ``[row][column]`` or ``[ratio, force]``, and ``(x, y, z)`` for components, which come last.
    """
    count, bracketed = quantity.numbers.ndim, re.findall(r"\[([^\[\]]+)\]", quantity.description)
    stated = [axis.strip().replace(" ", "_") for axes in bracketed for axis in axes.split(",")]
    components = ["component"] if re.search(r"\(x, y(, z)?\)", quantity.description) else []
    by_name = ["row", "column"] if name.partition("_")[0] in ("taxel", "voltage", "read") else []
    if name.endswith("_history"):
        by_name.insert(0, "time")
    for named in (stated, [*stated, *components], by_name):
        if named and len(named) == count:
            return tuple(named)
    return ()


def coordinates(
    quantities: Mapping[str, Quantity], placed: Mapping[str, Coordinate], sizes: dict[str, int]
) -> dict[str, Coordinate]:
    """Coordinate by name of an array of these sizes by axis: what is ``placed``, and what quantities of the same result hold.

    An axis ``depth`` lies along ``depth``, ``depths``, ``depth_history`` or ``readout_depth``, whichever has that one axis and as
    many values; the steps of a history have their displacement beside their time.
    """
    known = {}
    if "component" in sizes:
        known["component"] = Coordinate("component", COMPONENTS[: sizes["component"]])
    for axis, size in sizes.items():
        for name in (axis, "displacement") if axis == "time" else (axis,):
            for held in (name, f"{name}s", f"{name}_history", f"readout_{name}"):
                if held in quantities and dimensions(held, quantities[held]) == (axis,):
                    one = quantities[held]
                    if one.numbers.size == size and name not in known:
                        known[name] = Coordinate(axis, tuple(map(float, one.numbers)), one.unit, one.description)
    return known | {name: one for name, one in placed.items() if sizes.get(one.axis) == len(one.values)}


def centred(axis: str, borders: np.ndarray, place: float, description: str) -> Coordinate:
    """The middles of intervals (n, 2) in m, moved by a place in m."""
    return Coordinate(axis, tuple(float(value) for value in borders.mean(axis=1) + place), "m", description)
