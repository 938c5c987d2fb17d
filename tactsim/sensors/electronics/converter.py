"""Analog-to-digital converter: range, rounding, and a flag for what lies outside."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Voltage, format_quantity

LEAST_RANGE, MOST_RANGE = 1e-6, 1e6
"""Range in V of any converter, with a wide margin, in which no quotient overflows."""


class Converter(FrozenModel):
    r"""Rounds to the nearest of :math:`2^b` levels ``low + k step``, ``step = (high - low) / 2^b``.

    Source: thesis, 6.4 names the board (NI PCI-6225: 16 bits); the range of 0 to 5 V is an assumption, that of the supply.
    Where a signal with noise rests at 0 V, a range that begins there cuts and flags half of the noise; begin below zero then.
    """

    low: Voltage = 0.0
    """Lowest level."""
    high: Voltage = 5.0
    """End of the range, one step above the highest level."""
    bits: Annotated[int, Field(ge=1, le=32)] = 16
    """Resolution."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low >= self.high:
            low, high = format_quantity(self.low, "V"), format_quantity(self.high, "V")
            raise ValueError(f"low {low} must be below high {high}")
        if not LEAST_RANGE <= self.high - self.low <= MOST_RANGE:
            given, least, most = (format_quantity(value, "V") for value in (self.high - self.low, LEAST_RANGE, MOST_RANGE))
            raise ValueError(f"the range from low to high is {given}; allowed: {least} to {most}")
        return self

    @property
    def step(self) -> float:
        """Distance between levels in V."""
        return (self.high - self.low) / 2**self.bits

    def convert(self, voltage: Array) -> tuple[Array, Array]:
        """Levels in V nearest to finite voltages in V of any shape, and whether each is saturated.

        A sample is saturated if it lies more than half a step beyond the lowest or highest level; it reads that level. Any other
        sample is at most half a step away from its level.

        Raises
        ------
        InvalidQuantity
            If a voltage is not finite.
        """
        level = np.rint((np.asarray(voltage, dtype=float) - self.low) / self.step)
        last = 2**self.bits - 1
        if level.size and not (level.min() >= 0 and level.max() <= last):
            if not np.isfinite(level).all():
                raise InvalidQuantity(f"{np.count_nonzero(~np.isfinite(level))} of {level.size} voltages are not finite")
            saturated = (level < 0) | (level > last)
            return self.low + self.step * np.clip(level, 0, last), saturated
        return self.low + self.step * level, np.zeros(level.shape, dtype=bool)

    def at_end(self, voltage: Array) -> Array:
        """Whether converted voltages in V, of any shape, read the lowest or highest level, as those outside the range do too."""
        half = self.step / 2
        voltage = np.asarray(voltage, dtype=float)
        return (voltage < self.low + half) | (voltage > self.high - 3 * half)
