"""Fraction by volume and exponent over the density that a filler is taken to have."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.experiments.film.scene import ThermogravimetryScene
from tactsim.plotting.canvas import SingleFigure, despined, result_figure
from tactsim.results import Result

CURVE, POINT = "#1f4e79", "#b8540a"
BARS = (POINT, CURVE, "#2e7d32", "#6a1b9a")
SHORT = {"masses": "masses", "filler_density": "filler's density", "matrix_density": "matrix's density"}
REACH = 1.25
"""The curve goes beyond the densities by this factor."""


class ThermogravimetryFigures(SingleFigure):
    """Two panels: the fraction over the density, and what the uncertainty comes from."""

    kind: Literal["thermogravimetry"] = "thermogravimetry"

    def figure(self, result: Result) -> Figure:
        """Fraction by volume over the filler's density with its readings, and the parts of their uncertainties."""
        with result_figure(result, (9.6, 3.9), "Fraction of the filler by thermogravimetric analysis") as figure:
            over_density, parts = figure.subplots(1, 2, width_ratios=(1.3, 1))
            _draw_fractions(over_density, result)
            _draw_parts(parts, result)
            for axis in (over_density, parts):
                despined(axis)
        return figure


def _draw_fractions(axis: Axes, result: Result) -> None:
    scene = result.scene_as(ThermogravimetryScene)
    density, fraction, deviation = (
        result.history_values(name) for name in ("filler_density", "volume_fraction", "volume_fraction_deviation")
    )
    exponent, mass = result.history_values("exponent"), float(result.quantities["mass_fraction"].value)
    shown = np.geomspace(density.min() / REACH, density.max() * REACH, 200)
    filled, empty = mass / shown, (1 - mass) / scene.matrix_density
    axis.plot(shown / 1e3, filled / (filled + empty), color=CURVE, label=f"{mass:.4g} by mass")
    axis.errorbar(density / 1e3, fraction, 2 * deviation, fmt="o", color=POINT, markersize=5, capsize=3, label="± 2 deviations")
    for reading, at, value, width, power in zip(scene.readings, density, fraction, deviation, exponent, strict=True):
        words = f"{reading.name}: {value:.4f} ± {2 * width:.4f}\n$\\gamma s_0$ = {power:.4g}"
        axis.annotate(words, (at / 1e3, value), (10, 8), textcoords="offset points", fontsize=8)
    axis.set(xlabel="density of the filler in g/cm³", ylabel="fraction of the filler by volume", ylim=(0, None))
    axis.set_xlim(right=1.15 * float(shown[-1]) / 1e3)
    axis.set_title("fraction over the density", loc="left")
    axis.legend(loc="lower left")


def _power_of_ten(value: float) -> str:
    """A number of two digits as it is printed, such as 1.8 × 10⁻⁶."""
    digits, _, power = f"{value:.1e}".partition("e")
    return f"{digits} × $10^{{{int(power)}}}$" if value else "0"


def _draw_parts(axis: Axes, result: Result) -> None:
    readings = result.scene_as(ThermogravimetryScene).readings
    width = 0.8 / len(readings)
    for number, reading in enumerate(readings):
        values = [reading.contributions[name] for name in SHORT]
        places = np.arange(len(values)) + (number - (len(readings) - 1) / 2) * width
        bars = axis.barh(places, values, width * 0.9, color=BARS[number % len(BARS)], label=reading.name)
        axis.bar_label(bars, [_power_of_ten(value) for value in values], padding=3, fontsize=8)
    axis.set_yticks(np.arange(len(SHORT)), list(SHORT.values()))
    axis.set_xscale("log")
    most = max(max(reading.contributions.values()) for reading in readings)
    axis.set_xlim(most / 1e4 if most else 1e-6, 20 * most if most else 1.0)
    axis.invert_yaxis()
    axis.set_xlabel("standard uncertainty of the fraction by volume")
    axis.set_title("what makes it uncertain", loc="left")
    axis.legend(loc="lower right")
