"""The exponents of eq. 4.7.2, which the thesis multiplies out."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.validation.atrial_units import truncated, units_by_speed
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.evaluators.load_transform import FREQUENCY

STEP = 0.01
"""Last printed digit in 1/s."""


class DynamicExponent(Evaluator):
    """An exponent or angular frequency of 4.7.2 in 1/s: with both fast rates x1 > x2 multiplied out, x1 + x2 less one of them."""

    unit: ClassVar[str] = "1/s"
    kind: Literal["dynamic_exponent"] = "dynamic_exponent"
    exponent: Literal["both", "first", "second", "angular_frequency"]
    """x1 + x2; what is left beside the unit of rate x1, or x2; 2 pi f."""
    as_written: bool = False
    """Whether the sum is rounded to 0.01 1/s and the rate taken off cut there, as in the thesis."""

    @classmethod
    def example(cls) -> Self:
        """The common exponent."""
        return cls(exponent="both")

    def found(self, inputs: Inputs) -> float:
        """In 1/s."""
        if self.exponent == "angular_frequency":
            return 2 * np.pi * FREQUENCY
        first, second = 1 / units_by_speed("fast").times
        both = round((first + second) / STEP) * STEP if self.as_written else first + second
        rate = {"both": 0.0, "first": first, "second": second}[self.exponent]
        return float(both - (truncated(rate, STEP) if self.as_written else rate))
