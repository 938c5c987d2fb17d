"""Durometer: the deformed section under the indentor, and force over depth of tissue, spring and Hertz with the reading."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tactsim.experiments.durometer.scene import DurometerScene
from tactsim.experiments.indentation.figures.indentation import section_beside
from tactsim.plotting.canvas import SingleFigure, scale_of
from tactsim.results import Result
from tactsim.units import format_quantity

TISSUE_COLOUR, SPRING_COLOUR, HERTZ_COLOUR = "#1f4e79", "#b8540a", "#4d9221"
PAST = 1.01
"""Depth of the section over that at the reading above which the figure says that it is past the reading."""
ROOM = 1.25
"""The force axis ends at this many times the larger of spring and tissue."""


class DurometerFigures(SingleFigure):
    """Section and balance of forces side by side."""

    kind: Literal["durometer"] = "durometer"

    def figure(self, result: Result) -> Figure:
        """Section (if the result has fields) and forces over the depth."""
        return section_beside(result, [_draw_balance], "Durometer", _past_the_reading(result))


def _past_the_reading(result: Result) -> str:
    """Where the reading is if the section is drawn farther down."""
    if "depth" not in result.quantities or not result.frames:
        return ""
    depth = float(result.quantities["depth"].value)
    return f"past the reading, which is at {format_quantity(depth, 'm')}" if result.frames[-1].time > PAST * depth else ""


def _draw_balance(axis: Axes, result: Result) -> None:
    """Forces of tissue, spring and Hertz over the depth, and the readings along the top."""
    depth, tissue, hertz = (result.history_values(name) for name in ("displacement", "reaction_force", "hertz_force"))
    scale = result.scene_as(DurometerScene).scale
    whole = np.array([0.0, scale.travel])
    spring = scale.force_at_zero + scale.force_per_unit * 100 * (1 - whole / scale.travel)
    top = ROOM * max(spring.max(), min(float(tissue.max()), 2 * spring.max()))
    factor, unit = scale_of(top, "N")
    axis.plot(1e3 * depth, factor * tissue, ".-", color=TISSUE_COLOUR, markersize=4, label="tissue, simulated")
    axis.plot(1e3 * depth, factor * hertz, ":", color=HERTZ_COLOUR, label="Hertz, same modulus at small strain")
    axis.plot(1e3 * whole, factor * spring, "--", color=SPRING_COLOUR, label="spring of the durometer")
    axis.set(xlabel="depth of the indentor in mm", ylabel=f"force in {unit}", xlim=(0, 1e3 * whole[1]), ylim=(0, factor * top))
    travel = 1e3 * float(whole[1])

    def reading(depth: Any) -> Any:
        return 100 - 100 / travel * depth

    def depth_at(reading: Any) -> Any:
        return travel - travel / 100 * reading

    readings = axis.secondary_xaxis("top", functions=(reading, depth_at))
    readings.set_xlabel(f"reading: {_marked_reading(axis, result, factor)}")
    axis.spines["right"].set_visible(False)
    axis.legend(loc="best", fontsize=8)


def _marked_reading(axis: Axes, result: Result, factor: float) -> str:
    """The reading and its range in words, with a ring where tissue and spring balance; or that there is no such place."""
    if "depth" not in result.quantities:
        return "below 0, the indentor bottoms out" if "reading" in result.quantities else "none"
    depth, force, reading, low, high = (
        float(result.quantities[name].value) for name in ("depth", "spring_force", "reading", "reading_low", "reading_high")
    )
    axis.plot(1e3 * depth, factor * force, "o", color=TISSUE_COLOUR, markersize=9, fillstyle="none", markeredgewidth=1.8)
    return f"{reading:.1f} ({low:.1f} to {high:.1f})"
