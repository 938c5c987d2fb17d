"""Film under constant forces: resistance and conductance over force, creep, coefficients, and the surface R(F, t)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from tactsim.array import Array, evenly_spaced
from tactsim.experiments.film.figures.capacitive_test import capacitive_test_figure
from tactsim.experiments.film.scene import FilmTestScene
from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import Plot, despined, plain_decades, result_figure, with_minus
from tactsim.results import Result

DATA, LINE = "#1f4e79", "#b8540a"
LINE_LENGTH = 140
"""Letters of the line below the panels."""
MOST_CURVES = 6
"""Forces whose creep is drawn."""
TICKS_OF_A_DECADE = ((1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7), (1, 1.2, 1.4, 1.6, 1.8, 2, 2.5, 3, 3.5, 4, 4.5, 5, 6, 7, 8, 9))
"""Round numbers in a decade that are written as resistances beside the surface, ever closer together."""
FEWEST_TICKS = 3
COEFFICIENTS = (
    ("instantaneous", "$E_0$", "#1f4e79", "-"),
    ("delayed", "$E_1$", "#b8540a", "--"),
    ("viscosity", "$\\mu_1$ (right)", "#4d9221", "-."),
)


class FilmTestFigures(ResultFigures):
    """Four panels, and the surface of Fig. 2.10; for a capacitive film the capacitance and its strain."""

    kind: Literal["film_test"] = "film_test"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``film_test.png`` and, with at least two times of a piezoresistive film, ``film_surface.png``."""
        if "capacitance" in result.quantities:
            return {"film_test.png": Plot(lambda: capacitive_test_figure(result))}
        if result.scene is None or (coefficients := result.scene_as(FilmTestScene).coefficients) is None:
            return {}
        drawings: dict[str, Drawing] = {"film_test.png": Plot(lambda: film_test_figure(result, coefficients))}
        if len(result.quantities["times"].value) > 1:
            drawings["film_surface.png"] = Plot(lambda: film_surface_figure(result))
        return drawings


def film_test_figure(result: Result, coefficients: Mapping[str, Sequence[float]]) -> Figure:
    """Thesis Fig. 2.5a, 2.5b, 2.9b and 2.6b."""
    with result_figure(result, (10.0, 7.0), "Piezoresistive film under constant forces") as figure:
        axes = figure.subplots(2, 2)
        _draw_readings(axes[0, 0], axes[0, 1], result)
        _draw_creep(axes[1, 0], result)
        _draw_coefficients(axes[1, 1], result.quantities["forces"].numbers, coefficients)
        for axis in axes.flat:
            despined(axis)
        if result.assumptions:  # which line the film was identified to, and over what, which is not the line of these readings
            figure.supxlabel(fill(with_minus(result.assumptions[0]), LINE_LENGTH), x=0.01, ha="left", fontsize=8.5)
    return figure


def film_surface_figure(result: Result) -> Figure:
    """Resistance over force and time, thesis Fig. 2.10."""
    words = "Resistance over force and time; edges: the forces and times of the case"
    with result_figure(result, (7.0, 5.5), below=words) as figure:
        axis: Any = figure.add_subplot(projection="3d")
        forces, times = np.meshgrid(result.quantities["forces"].numbers, result.quantities["times"].numbers)
        kilohms = result.quantities["resistance"].numbers / 1e3
        norm, decades = LogNorm(float(kilohms.min()), float(kilohms.max())), np.log10(kilohms)
        colours = colormaps["viridis"](norm(kilohms))
        axis.plot_surface(forces, times, decades, facecolors=colours, linewidth=0.2, edgecolor="#444444", shade=False)
        ticks = _surface_ticks(float(kilohms.min()), float(kilohms.max()))
        axis.set_zticks(np.log10(ticks), [f"{value:.3g}" for value in ticks])
        axis.set(xlabel="force in N", ylabel="time since the force began in s", zlabel="resistance in kΩ")
        axis.view_init(elev=25, azim=40)
        axis.set_box_aspect((1, 1, 0.75), zoom=0.95)
        bar = figure.colorbar(ScalarMappable(norm, "viridis"), ax=axis, shrink=0.6, aspect=24, pad=0.08)
        bar.set_label("resistance in kΩ")
        bar.ax.yaxis.set_ticks(ticks, [f"{value:.3g}" for value in ticks])
        bar.ax.yaxis.set_minor_formatter(NullFormatter())
    return figure


def _surface_ticks(low: float, high: float) -> Array:
    """Round numbers between two others, as few as tell the scale; the ends themselves where no round ones lie between."""
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    for parts in TICKS_OF_A_DECADE:
        ticks = np.outer(decades, parts).ravel()
        ticks = ticks[(low <= ticks) & (ticks <= high)]
        if len(ticks) >= FEWEST_TICKS:
            return ticks
    return np.array([low, high])


def _draw_readings(resistance: Axes, conductance: Axes, result: Result) -> None:
    forces, read = result.quantities["forces"].numbers, result.quantities["reading_resistance"].numbers
    when = f"{result.scene_as(FilmTestScene).reading_time:g} s after the force began"
    resistance.semilogy(forces, read / 1e3, "o-", color=DATA, markersize=3, label="film and contacts")
    resistance.semilogy(forces, result.quantities["reading_film_resistance"].numbers / 1e3, "--", color=LINE, label="film alone")
    resistance.legend()
    resistance.set(xlabel="force in N", ylabel="resistance in kΩ")
    resistance.set_title(f"resistance, {when}", loc="left")
    conductance.plot(forces, 1e3 / read, "o", color=DATA, markersize=3)
    slope, intercept = (float(result.quantities[f"line_{part}"].value) for part in ("slope", "intercept"))
    sign = "−" if intercept < 0 else "+"
    label = f"C = {slope * 1e3:.4g} mS/N · F {sign} {abs(intercept) * 1e3:.3g} mS\n{_inverse(slope, intercept)}"
    ends = np.array([0.0, forces[-1]])
    conductance.plot(ends, 1e3 * (slope * ends + intercept), "--", color=LINE, label=label)
    conductance.set(xlabel="force in N", ylabel="conductance in mS", ylim=(0, 1.35e3 * float((1 / read).max())))
    conductance.set_title("conductance and its line", loc="left")
    conductance.legend(loc="upper left")


def _inverse(slope: float, intercept: float) -> str:
    """The line solved for the force: of these forces and this reading time, not the one printed of a whole sensor."""
    per_force, offset = 1e-3 / slope, intercept / slope
    return f"or F = {per_force:.4g} N/mS · C {'−' if offset > 0 else '+'} {abs(offset):.3g} N,\nof these readings"


def _draw_creep(axis: Axes, result: Result) -> None:
    forces, times, resistance = (result.quantities[name].numbers for name in ("forces", "times", "resistance"))
    chosen = evenly_spaced(len(forces), MOST_CURVES)
    colours = colormaps["viridis"](np.linspace(0, 0.85, len(chosen)))
    for k, colour in zip(chosen, colours, strict=True):
        axis.semilogy(times, resistance[:, k] / 1e3, ".-", color=colour, markersize=4, label=f"{forces[k]:.3g} N")
    axis.set(xlabel="time since the force began in s", ylabel="resistance in kΩ")
    axis.set_title("creep of the resistance; dots: the times of the case", loc="left")
    plain_decades(axis)
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)  # beside: the curves may be anywhere


def _draw_coefficients(axis: Axes, forces: Array, coefficients: Mapping[str, Sequence[float]]) -> None:
    axes = coefficient_axes(axis)
    for name, label, colour, style in COEFFICIENTS:
        axes[name].plot(forces, np.array(coefficients[name]) / 1e6, style, color=colour, label=label)
    axis.set_title("standard linear solid over force", loc="left")
    finish_coefficients(axes)


def coefficient_axes(axis: Axes) -> dict[str, Axes]:
    """Axes of each coefficient: the moduli on the left, the viscosity, which has another unit, on the right."""
    right: Any = axis.twinx()
    return {name: right if name == "viscosity" else axis for name, *_ in COEFFICIENTS}


def finish_coefficients(axes: Mapping[str, Axes]) -> None:
    """Labels, limits and the legend of the coefficients, once they are drawn."""
    left, right = axes["delayed"], axes["viscosity"]
    left.set(xlabel="force in N", ylabel="moduli $E_0$ and $E_1$ in MPa", ylim=(0, None))
    right.set(ylim=(0, None))
    right.set_ylabel("viscosity $\\mu_1$ in MPa s", color=COEFFICIENTS[-1][2])
    right.tick_params(axis="y", colors=COEFFICIENTS[-1][2])
    right.spines["top"].set_visible(False)
    handles = [handle for one in (left, right) for handle in one.get_legend_handles_labels()[0]]
    left.legend(handles, [label for _, label, *_ in COEFFICIENTS], loc="upper left")
