"""Voltage divider of a resistive sensor and a load resistor, and its inverse."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity

LARGEST = 1e12
"""Largest conductance in S, far beyond any sensor, so that no product overflows."""


def divider_voltage(conductance: Array, *, supply: float, load: float) -> Array:
    r"""Voltage in V across the load resistor; 0 V for a sensor that does not conduct.

    .. math:: V_o = \frac{R}{R + r} V^+ = V^+ \frac{R C}{1 + R C}

    Parameters
    ----------
    conductance
        ``C = 1/r >= 0`` of the sensor in S, any shape.
    supply, load
        ``V+`` in V and ``R`` in ohm, both positive.

    Raises
    ------
    InvalidQuantity
        If a conductance is negative, not finite or beyond `LARGEST`.

    Source: thesis, 2.2.1 and Fig. 2.4b.
    """
    conductance = np.asarray(conductance, dtype=float)
    if conductance.size and not (conductance.min() >= 0 and conductance.max() <= LARGEST):  # NaN fails both
        bad = conductance[~((conductance >= 0) & (conductance <= LARGEST))]
        raise InvalidQuantity(
            f"{bad.size} of {conductance.size} conductances are not usable, first {bad[0]:g} S; allowed: 0 to {LARGEST:g} S"
        )
    loaded = load * conductance
    return supply * loaded / (1 + loaded)


def divider_conductance(voltage: Array, *, supply: float, load: float) -> Array:
    r"""Conductance in S of the sensor at a voltage across the load; noise below 0 V gives a conductance below zero.

    .. math:: C = \frac{1}{(V^+/V_o - 1) R} = \frac{V_o}{(V^+ - V_o) R}

    It has the shape of ``voltage``; ``supply`` is in V, ``load`` in ohm.

    Raises
    ------
    InvalidQuantity
        If a voltage is not finite or not below the supply, where no resistance of the sensor can bring it.

    Source: thesis, 2.2.1.
    """
    voltage = np.asarray(voltage, dtype=float)
    if voltage.size and not (voltage.max() < supply and voltage.min() > -np.inf):  # NaN fails both
        bad = voltage[~(np.isfinite(voltage) & (voltage < supply))]
        raise InvalidQuantity(
            f"{bad.size} of {voltage.size} voltages have no conductance, first {bad[0]:g} V; allowed: below the supply of "
            f"{supply:g} V; lower the noise or leave the flagged samples out"
        )
    return voltage / ((supply - voltage) * load)


def divider_slope(conductance: Array, *, supply: float, load: float) -> Array:
    r"""Change of the voltage with the conductance in V/S.

    .. math:: \frac{dV_o}{dC} = \frac{V^+ R}{(1 + R C)^2}

    It has the shape of ``conductance`` in S; ``supply`` is in V, ``load`` in ohm.

    Source: thesis, 2.2.1, differentiated.
    """
    return supply * load / (1 + load * np.asarray(conductance, dtype=float)) ** 2
