"""Figure of the compliance of the atrial tissue over the frequency, as Fig. 4.11."""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np

from tactsim.analytic.atrial import TIMES, table_4_1
from tactsim.validation.atrial_units import FREQUENCIES
from tactsim.validation.evaluator import Drawing, Inputs

LABELS = {"retardation_times": "times in s (as printed)", "viscosities": "viscosities in MPa s (as in 4.6.4)"}
POINTS = 200


class AtrialCompliances(Drawing):
    """Elastic and viscous compliance of Table 4.1 by eq. 4.3.8 in both readings; the measured ones are not printed."""

    kind: Literal["atrial_compliances"] = "atrial_compliances"
    title: str
    """Title of the figure."""

    @classmethod
    def example(cls) -> Self:
        """Both readings."""
        return cls(title="Fig. 4.11")

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: elastic compliance in 1/MPa above, viscous below, over the frequency in Hz."""
        frequency = np.geomspace(FREQUENCIES[0], FREQUENCIES[-1], POINTS)
        panels = []
        for name, part in (("elastic", np.real), ("viscous", lambda value: -np.imag(value))):
            curves = [
                {
                    "label": LABELS[times],
                    "x": frequency.tolist(),
                    "y": (1e6 * part(_compliance(times, frequency))).tolist(),
                    "style": "line",
                }
                for times in TIMES
            ]
            tests = {"label": "tested frequencies", "x": FREQUENCIES.tolist(), "style": "points"}
            curves.append({**tests, "y": (1e6 * part(_compliance("retardation_times", FREQUENCIES))).tolist()})
            panels.append({"y_axis": f"{name} compliance in 1/MPa", "unit": "", "curves": curves, "logarithmic": True})
        axis = {"x_axis": "frequency", "x_unit": "Hz", "x_logarithmic": True, "even_panels": True}
        return {"form": "curves", "title": self.title, **axis, "panels": panels}


def _compliance(times: str, frequency: np.ndarray) -> np.ndarray:
    return table_4_1(times).complex_compliance(2 * np.pi * frequency)
