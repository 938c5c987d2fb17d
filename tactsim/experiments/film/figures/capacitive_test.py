"""Capacitive film under constant forces: capacitance over force with its line, strain, and the amplifier's voltage."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tactsim.plotting.canvas import despined, result_figure
from tactsim.results import Result

DATA, LINE = "#1f4e79", "#b8540a"


def capacitive_test_figure(result: Result) -> Figure:
    """Capacitance and strain over force and, if an amplifier reads it, its voltage."""
    forces, capacitance = result.quantities["forces"].numbers, 1e12 * result.quantities["reading_capacitance"].numbers
    amplified = "reading_voltage" in result.quantities
    with result_figure(result, (10.0, 4.0), "Capacitive film under constant forces") as figure:
        axes = np.atleast_1d(figure.subplots(1, 3 if amplified else 2))
        axes[0].plot(forces, capacitance, "o-", color=DATA, markersize=3, label="film")
        slope, intercept = (1e12 * float(result.quantities[f"line_{part}"].value) for part in ("slope", "intercept"))
        label = f"C = {slope:.4g} pF/N · F {'−' if intercept < 0 else '+'} {abs(intercept):.4g} pF"
        ends = np.array([0.0, forces[-1]])
        axes[0].plot(ends, slope * ends + intercept, "--", color=LINE, label=label)
        axes[0].set(xlabel="force in N", ylabel="capacitance in pF", ylim=(0, None))
        axes[0].set_title("capacitance and its line", loc="left")
        axes[0].legend(loc="lower right")
        strain = result.history_values("strain")[result.history_values("time") == 0.0]
        axes[1].plot(forces, 100 * strain, "o-", color=DATA, markersize=3)
        axes[1].set(xlabel="force in N", ylabel="compressive strain in %", ylim=(0, None))
        axes[1].set_title("strain of the dielectric", loc="left")
        if amplified:
            axes[2].plot(forces, result.quantities["reading_voltage"].numbers, "o-", color=DATA, markersize=3)
            axes[2].set(xlabel="force in N", ylabel="amplitude in V", ylim=(0, None))
            axes[2].set_title("charge amplifier", loc="left")
        for axis in axes:
            despined(axis)
    return figure
