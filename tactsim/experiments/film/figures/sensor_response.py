"""A piezoresistive sensor under a force over time: applied and read force, and the error: thesis Fig. 3.5."""

from __future__ import annotations

from typing import Literal

from matplotlib.figure import Figure

from tactsim.plotting.canvas import SingleFigure, despined, result_figure
from tactsim.results import Result

READINGS = (
    ("unfiltered_force", "by the calibration line,\nunfiltered", "#9ecae1", 0.7, 3, "-"),
    ("read_force", "by the calibration line,\nlow pass", "#1f4e79", 2.2, 2, "-"),
    ("model_force", "by the film's equations,\ninverted", "#b8540a", 1.4, 4, "-."),
)
"""Column, words, colour, width, order and line of each reading."""
APPLIED, SATURATED = "#000000", "#b00020"


class SensorResponseFigures(SingleFigure):
    """Forces above, errors below."""

    kind: Literal["sensor_response"] = "sensor_response"

    def figure(self, result: Result) -> Figure:
        """Applied force with the three readings, and each reading's error."""
        columns = {name: result.history_values(name) for name in result.units}
        time, force = columns["time"], columns["force"]
        with result_figure(result, (10.0, 6.0), "Response of a piezoresistive sensor") as figure:
            above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1))
            above.plot(time, force, "--", color=APPLIED, linewidth=1.0, label="applied", zorder=5)
            for name, label, colour, width, order, line in READINGS:
                above.plot(time, columns[name], line, color=colour, linewidth=width, label=label, zorder=order)
                below.plot(time, columns[name] - force, line, color=colour, linewidth=min(width, 1.4), zorder=5 - order)
            flagged = columns["saturated"] > 0
            if flagged.any():
                above.plot(time[flagged], columns["unfiltered_force"][flagged], "x", color=SATURATED, label="saturated")
            rms = float(result.quantities["rms_error"].value)
            below.set(xlabel="time in s", ylabel="reading − applied in N")
            below.set_title(f"error; root mean square {rms:.3g} N with low pass", loc="left")
            above.set(ylabel="force in N")
            above.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
            for axis in (above, below):
                despined(axis)
        return figure
