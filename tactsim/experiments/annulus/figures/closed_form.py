"""Closed form of the annulus: force, displacement and rise over time."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from tactsim.plotting.canvas import SingleFigure, despined, result_figure, scale_of
from tactsim.results import Result

COLOUR, PULLS = "#1f4e79", "pulls: a real probe would have lifted off"
HISTORIES = (("force", "force", "N"), ("displacement", "displacement", "m"), ("tissue_rise_axis", "rise on\nthe axis", "m"))


class ClosedFormFigures(SingleFigure):
    """The histories one above the other."""

    kind: Literal["closed_form"] = "closed_form"

    def figure(self, result: Result) -> Figure:
        """Histories of a closed form, shaded where the force pulls."""
        time = result.history_values("time")
        pulls = result.history_values("force") < 0
        with result_figure(result, (6.4, 5.2), "Annulus on viscoelastic tissue, closed form") as figure:
            axes = figure.subplots(len(HISTORIES), 1, sharex=True)
            for axis, (name, words, unit) in zip(axes, HISTORIES, strict=True):
                values = result.history_values(name)
                factor, prefixed = scale_of(float(np.abs(values).max()), unit)
                axis.plot(time, factor * values, color=COLOUR)
                axis.axhline(0.0, color="0.6", linewidth=0.6)
                if pulls.any():
                    reach = axis.get_ylim()
                    axis.fill_between(time, *reach, where=pulls, color="#b00020", alpha=0.12, label=PULLS)
                    axis.set_ylim(reach)
                axis.set_ylabel(f"{words} in {prefixed}")
                despined(axis)
            if pulls.any():
                axes[0].legend(fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
            axes[-1].set(xlabel="time in s", xlim=(0, time[-1]))
        return figure
