"""Closed form of the annulus: force, displacement and rise over time."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from tactsim.interfaces import Drawing, ResultFigures
from tactsim.plotting.canvas import Plot, despined, entitle, new_figure, scale_of, styled
from tactsim.results import Result

COLOUR = "#1f4e79"
HISTORIES = (("force", "force", "N"), ("displacement", "displacement", "m"), ("tissue_rise_axis", "rise on\nthe axis", "m"))


class ClosedFormFigures(ResultFigures):
    """One figure: the histories one above the other."""

    kind: Literal["closed_form"] = "closed_form"

    def drawings(self, result: Result) -> dict[str, Drawing]:
        """``closed_form.png``."""
        return {"closed_form.png": Plot(lambda: closed_form_figure(result))} if result.steps else {}


def closed_form_figure(result: Result) -> Figure:
    """Histories of a closed form, shaded where the force pulls."""
    time = result.history_values("time")
    pulls = result.history_values("force") < 0
    with styled():
        figure = new_figure(6.4, 5.2)
        axes = figure.subplots(len(HISTORIES), 1, sharex=True)
        for axis, (name, words, unit) in zip(axes, HISTORIES, strict=True):
            values = result.history_values(name)
            factor, prefixed = scale_of(float(np.abs(values).max()), unit)
            axis.plot(time, factor * values, color=COLOUR)
            axis.axhline(0.0, color="0.6", linewidth=0.6)
            if pulls.any():
                reach = axis.get_ylim()
                axis.fill_between(
                    time, *reach, where=pulls, color="#b00020", alpha=0.12, label="pulls: a real probe would have lifted off"
                )
                axis.set_ylim(reach)
            axis.set_ylabel(f"{words} in {prefixed}")
            despined(axis)
        if pulls.any():
            axes[0].legend(fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
        axes[-1].set(xlabel="time in s", xlim=(0, time[-1]))
        entitle(figure, result.title or "Annulus on viscoelastic tissue, closed form")
    return figure
