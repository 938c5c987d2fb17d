"""Values of options: text as it was typed, turned into a number, and refused by the name of the option."""

from __future__ import annotations

from tactsim.errors import InvalidQuantity
from tactsim.units import parse_quantity


def quantity_of(option: str, text: str, unit: str) -> float:
    """The number in ``unit`` that an option such as ``--noise`` was given as text, such as "2 mN".

    Raises
    ------
    InvalidQuantity
        If it is no number with a unit of that dimension.
    """
    try:
        return float(parse_quantity(text, unit))
    except InvalidQuantity as error:
        raise InvalidQuantity(f"{option}: {error}") from None
