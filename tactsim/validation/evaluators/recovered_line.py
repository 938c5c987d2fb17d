"""The line of 3.1.2 as a calibration of simulated readings finds it."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.identification.calibration_line import fit_calibration_line
from tactsim.sensors.calibration import THESIS_LINE
from tactsim.sensors.signal_chain import SignalChain
from tactsim.units import Force
from tactsim.validation.evaluator import Evaluator, Inputs


class RecoveredLine(Evaluator):
    """Slope 1/m in N/S or offset -n/m in N of F over C, from converted voltages at even forces, without noise."""

    kind: Literal["recovered_line"] = "recovered_line"
    constant: Literal["slope", "offset"]
    """Which one."""
    largest_force: Annotated[Force, Field(gt=0)] = 25.0
    """Forces go from 0 to this one."""
    points: Annotated[int, Field(ge=3, le=10_000)] = 26
    """Number of forces."""

    @property
    def found_unit(self) -> str:
        """N/S or N."""
        return "N/S" if self.constant == "slope" else "N"

    @classmethod
    def example(cls) -> Self:
        """The slope."""
        return cls(constant="slope")

    def found(self, inputs: Inputs) -> float:
        """In N/S or N."""
        chain, force = SignalChain(low_pass=None), np.linspace(0.0, self.largest_force, self.points)
        voltage = chain.acquire(THESIS_LINE.conductance(force)).voltage
        fit = fit_calibration_line(force, voltage, supply=chain.supply, load=chain.load_resistor)
        return float(1 / fit.slope if self.constant == "slope" else -fit.intercept / fit.slope)
