"""Figure of the moduli of the atrial tissue over the frequency, as Fig. 4.10."""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np

from tactsim.analytic.atrial import table_4_1
from tactsim.validation.atrial_units import FREQUENCIES
from tactsim.validation.evaluator import Drawing, Inputs

POINTS = 200


class AtrialModuli(Drawing):
    """Complex, elastic and viscous modulus and tan delta that Table 4.1 stands for; the measured ones are not printed."""

    kind: Literal["atrial_moduli"] = "atrial_moduli"
    title: str
    """Title of the figure."""
    times: Literal["retardation_times", "viscosities"]
    """Reading of the column of times."""

    @classmethod
    def example(cls) -> Self:
        """As printed."""
        return cls(title="Fig. 4.10", times="retardation_times")

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: moduli in Pa above, tan delta below, over the frequency in Hz; points at the tested frequencies."""
        frequency = np.linspace(FREQUENCIES[0], FREQUENCIES[-1], POINTS)
        line, tested = (1 / table_4_1(self.times).complex_compliance(2 * np.pi * f) for f in (frequency, FREQUENCIES))
        upper = [
            _curve("complex modulus", frequency, np.abs(line)),
            _curve("elastic modulus", frequency, line.real),
            _curve("viscous modulus", frequency, line.imag),
            _curve("tested frequencies", FREQUENCIES, np.abs(tested), "points"),
        ]
        lower = [
            _curve("tan delta", frequency, line.imag / line.real),
            _curve("tested frequencies", FREQUENCIES, tested.imag / tested.real, "points"),
        ]
        panels = [{"y_axis": "modulus", "unit": "Pa", "curves": upper}, {"y_axis": "tan delta", "unit": "", "curves": lower}]
        return {"form": "curves", "title": self.title, "x_axis": "frequency", "x_unit": "Hz", "panels": panels}


def _curve(label: str, x: np.ndarray, y: np.ndarray, style: str = "line") -> dict[str, Any]:
    return {"label": label, "x": x.tolist(), "y": y.tolist(), "style": style}
