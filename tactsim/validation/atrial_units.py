"""The Kelvin units of Table 4.1 by the number that the table gives them, and eq. 4.7.2 in terms of them."""

from __future__ import annotations

import numpy as np

from tactsim.analytic.atrial import TAU, E, table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.errors import InputError, UnknownName

Array = np.ndarray
FREQUENCIES = np.arange(1.0, 37.0, 5.0)
"""Tested frequencies in Hz, thesis section 4.4."""
FAST = 1.0
"""Rate in 1/s above which a unit counts as fast: two units of the reading as viscosities, whose rates are 4.3 and 2.8."""


def numbered_units(times: str) -> tuple[Array, Array]:
    """Compliances J_i in 1/Pa and times in s of the units 1 to 8, each of shape (8,), in the order of Table 4.1.

    Raises
    ------
    UnknownName
        If the reading of the times is none of ``TIMES``.
    """
    model = table_4_1(times)
    column = np.array(TAU) / np.array(E) if times == "viscosities" else np.array(TAU)
    rank = np.argsort(np.argsort(column))
    return model.compliances[rank], model.times[rank]


def numbered_unit(times: str, number: int) -> tuple[float, float]:
    """Compliance in 1/Pa and time in s of one unit, counted from 1.

    Raises
    ------
    InputError
        If there is no such unit.
    """
    compliances, retardation = numbered_units(times)
    if not 1 <= number <= compliances.size:
        raise InputError(f"Table 4.1 has no unit {number}; allowed: 1 to {compliances.size}")
    return float(compliances[number - 1]), float(retardation[number - 1])


def units_by_speed(chosen: str) -> GeneralizedKelvin:
    """The reading as viscosities with all its units, only the ``fast`` or only the ``slow`` ones, and the free spring.

    Raises
    ------
    UnknownName
        If the choice is not known.
    """
    model = table_4_1("viscosities")
    fast = model.times < 1 / FAST
    choices = {"all": np.ones_like(fast), "fast": fast, "slow": ~fast}
    if chosen not in choices:
        raise UnknownName("choice of units", chosen, choices)
    kept = choices[chosen]
    return GeneralizedKelvin(model.glassy_compliance, model.compliances[kept], model.times[kept])


def truncated(values: Array | float, step: float) -> Array:
    """The values with all digits below ``step`` cut off toward zero, as the thesis writes its numbers."""
    return np.trunc(np.asarray(values) / step * (1 + 1e-12)) * step
