"""Creep tests of a film with their fits, and the coefficients over the force with their lines: thesis Fig. 2.6."""

from __future__ import annotations

from textwrap import fill
from typing import Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.experiments.film.figures.film_test import COEFFICIENTS, LINE_LENGTH, coefficient_axes, finish_coefficients
from tactsim.experiments.film.scene import FilmCreepScene
from tactsim.plotting.canvas import SingleFigure, despined, result_figure
from tactsim.results import Result

PER_CENT = 100.0
MARKERS = "os^"


class FilmCreepFigures(SingleFigure):
    """Creep on the left, coefficients on the right; nothing unless a fit was made."""

    kind: Literal["film_creep"] = "film_creep"

    def figure(self, result: Result) -> Figure:
        """Strain over time of every test with its fit, and E0, E1 and mu1 over the force with intervals."""
        with result_figure(result, (10.0, 4.2), "Creep of a piezoresistive film") as figure:
            creep, coefficients = figure.subplots(1, 2)
            _draw_creep(creep, result)
            _draw_coefficients(coefficients, result)
            for axis in (creep, coefficients):
                despined(axis)
            if result.assumptions:  # what the intervals are of, and whether the data are synthetic
                figure.supxlabel(fill("; ".join(result.assumptions), LINE_LENGTH), x=0.01, ha="left", fontsize=8.5)
        return figure


def _draw_creep(axis: Axes, result: Result) -> None:
    scene = result.scene_as(FilmCreepScene)
    tests = scene.tests
    colours = colormaps["viridis"](np.linspace(0, 0.85, len(tests)))
    for test, step, colour in zip(tests, result.steps, colours, strict=False):
        values = step.values
        time, stress = np.array(test.time), values["force"] / scene.area
        delayed = -np.expm1(-values["delayed"] / values["viscosity"] * time) * stress / values["delayed"]
        axis.plot(time, PER_CENT * np.array(test.strain), ".", color=colour, markersize=2.0, alpha=0.5)
        axis.plot(time, PER_CENT * (stress / values["instantaneous"] + delayed), color=colour, label=f"{values['force']:.3g} N")
    axis.set(xlabel="time in s", ylabel="strain in %", ylim=(0, None))
    axis.set_title("creep (dots) and fits (lines)", loc="left")
    axis.legend(loc="lower right", ncols=2)


def _draw_coefficients(axis: Axes, result: Result) -> None:
    forces, axes = result.history_values("force"), coefficient_axes(axis)
    for (name, label, colour, _), marker in zip(COEFFICIENTS, MARKERS, strict=True):
        values = result.history_values(name) / 1e6
        widths = result.history_values(f"{name}_half_width") / 1e6
        axes[name].errorbar(forces, values, widths, fmt=marker, color=colour, markersize=4, capsize=3, linewidth=1, label=label)
        if f"{name}_slope" in result.quantities:
            slope, intercept = (float(result.quantities[f"{name}_{part}"].value) / 1e6 for part in ("slope", "intercept"))
            ends = np.array([0.0, forces.max()])
            axes[name].plot(ends, slope * ends + intercept, "-", color=colour, linewidth=1)
    axis.set(xlim=(0, None))
    axis.set_title("coefficients, their intervals and lines", loc="left")
    finish_coefficients(axes)
