"""The mean rate that the switch array reads from a clean touch at a known rate."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.sensors.switch_array import Formula, SwitchArray
from tactsim.sensors.switch_reading import read_switches
from tactsim.units import Frequency, Speed
from tactsim.validation.evaluator import Evaluator, Inputs

STIFFNESS = 200.0
"""In N/m, of the tissue under the probe; a switch carries as much over what is below it. Only when they begin counts."""


class SwitchMeanRate(Evaluator):
    """Eq. 5.2.2 on clean samples of a touch at a constant rate whose tissue follows the sides of the probe."""

    unit: ClassVar[str] = "m/s"
    kind: Literal["switch_mean_rate"] = "switch_mean_rate"
    rate: Annotated[Speed, Field(gt=0)] = 1e-3
    """Rate of indentation."""
    formula: Formula = "corrected"
    """Reading of eq. 5.2.2."""
    sampling_rate: Annotated[Frequency, Field(gt=0)] = 1000.0
    """Samples per second."""

    @classmethod
    def example(cls) -> Self:
        """1 mm/s."""
        return cls()

    def found(self, inputs: Inputs) -> float:
        """In m/s."""
        array = SwitchArray(formula=self.formula)
        time = np.arange(0.0, 1.1 * array.travel / self.rate, 1 / self.sampling_rate)
        reached = np.maximum(self.rate * time[:, None] - array.heights, 0.0)
        (touch,) = read_switches(array, time, STIFFNESS * self.rate * time, STIFFNESS * reached).touches
        rate = touch.mean_rate(array)
        if rate is None:
            raise InputError("not every switch closed; sample faster")
        return rate
