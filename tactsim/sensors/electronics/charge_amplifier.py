"""Charge amplifier of a capacitive sensor, and its inverse."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.model import FrozenModel
from tactsim.units import Capacitance, Voltage


class ChargeAmplifier(FrozenModel):
    r"""Amplitude of the output when an alternating voltage drives the sensor into the virtual ground of the amplifier.

    .. math:: V_o = V_x \frac{C}{C_f}

    It is proportional to the capacitance, whatever the capacitance of the leads to ground.

    Source: the gain of an inverting amplifier with capacitors for both impedances; the values are assumptions.
    """

    excitation: Annotated[Voltage, Field(gt=0, le=1e6)] = 1.0
    """Amplitude of the voltage on the sensor."""
    feedback: Annotated[Capacitance, Field(gt=0, le=1.0)] = 20e-12
    """Capacitor from the output to the input of the amplifier."""

    def voltage(self, capacitance: Array) -> Array:
        """Amplitude in V at the output for capacitances in F of any shape."""
        return self.excitation * np.asarray(capacitance, dtype=float) / self.feedback

    def capacitance(self, voltage: Array) -> Array:
        """Capacitance in F for amplitudes in V of any shape.

        Raises
        ------
        InvalidQuantity
            If a voltage is not finite.
        """
        values = np.asarray(voltage, dtype=float)
        if not np.isfinite(values).all():
            raise InvalidQuantity(f"{np.count_nonzero(~np.isfinite(values))} of {values.size} voltages are not finite")
        return values * self.feedback / self.excitation
