"""The load of section 4.7 in the Laplace domain."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.analytic.histories import harmonic
from tactsim.units import Force
from tactsim.validation.evaluator import Evaluator, Inputs

UNITS = {"static": "N", "numerator": "N/s", "delay": "s", "constant": "1/s^2", "largest": "N"}
FREQUENCY, DELAY, STATIC = 1.0, 2.0, -0.2
"""Hz, s and N of the load as the text gives it; compression negative, section 4.7."""


class LoadTransform(Evaluator):
    """A number of p = static / s + numerator exp(-delay s) / (s^2 + constant), or the largest force of that history."""

    kind: Literal["load_transform"] = "load_transform"
    number: Literal["static", "numerator", "delay", "constant", "largest"]
    """Which number."""
    amplitude: Annotated[Force, Field(gt=0)] = 0.2
    """Amplitude of the harmonic load; 0.2 N in the text."""

    @classmethod
    def example(cls) -> Self:
        """The amplitude of the text."""
        return cls(number="numerator")

    @property
    def found_unit(self) -> str:
        """N, N/s, s or 1/s^2."""
        return UNITS[self.number]

    def found(self, inputs: Inputs) -> float:
        """In N, N/s, s or 1/s^2."""
        last = harmonic(self.amplitude, FREQUENCY, start=DELAY, mean=STATIC).segments[-1]
        (wave,) = last.harmonics
        return {
            "static": last.value,
            "numerator": wave.amplitude * wave.angular_frequency,
            "delay": last.start,
            "constant": wave.angular_frequency**2,
            "largest": last.value + wave.amplitude,
        }[self.number]
