"""Arithmetic on numbers that the thesis prints: it shows whether they fit each other, and nothing about the model."""

from __future__ import annotations

from tactsim.errors import InputError
from tactsim.interfaces import quantity
from tactsim.units import conversion, parse_quantity


def _can_be_divided(numerator: str, denominator: str) -> None:
    unit = denominator.strip().partition(" ")[2]
    if not unit:
        raise ValueError(f"{denominator!r} has no unit")
    if parse_quantity(denominator, unit) == 0:
        raise ValueError(f"{denominator!r} is zero")
    conversion(numerator.strip().partition(" ")[2], unit)


@quantity(unit="1", check=_can_be_divided)
def quotient(numerator: str, denominator: str) -> float:
    """Quotient of two quantities of the same dimension.

    Parameters
    ----------
    numerator, denominator : numbers with their units

    Raises
    ------
    InputError
        If the denominator is zero.
    """
    unit = denominator.strip().partition(" ")[2]
    below = parse_quantity(denominator, unit)
    if below == 0:
        raise InputError(f"{denominator!r} is zero")
    return parse_quantity(numerator, unit) / below
