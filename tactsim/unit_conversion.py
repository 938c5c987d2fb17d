"""How units relate to each other: by their prefixes where nothing else tells them apart, by pint otherwise.

Most cases hold nothing but plain units with prefixes, and pint takes a third of a second to load.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import cache, lru_cache
from typing import Any

from tactsim.unit_definitions import (
    OVER_ANOTHER,
    PLAIN,
    PREFIXED,
    PREFIXES,
    RARE_PREFIXES,
    SHOWN_PREFIXES,
    UNPREFIXED,
    customary_words,
    prefix_power,
    single_words,
)

UNREADABLE = (ArithmeticError, ValueError, TypeError, AttributeError, AssertionError)
"""What pint raises, beside its own errors, on text that is no unit."""

METRES_FIRST = re.compile(r"^(m)([·*])([^/·*]+)")
"""A product that pint, which sorts by letters, begins with the metre: a torque in m·mN reads as one in millinewtons."""


class OtherDimension(ValueError):
    """A unit is one of another dimension."""


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry([*PREFIXES, *PREFIXED, *UNPREFIXED], cache_folder=None)


@cache
def _all_units() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


def in_pint(value: Any, unit: str) -> Any:
    """A quantity of pint's application registry, in which a user's own quantities are."""
    import pint

    return pint.get_application_registry().Quantity(value, "" if unit == "1" else unit)


@lru_cache(maxsize=1024)
def factor_to(unit: str, given_unit: str) -> float:
    """How many ``unit`` one ``given_unit`` is.

    Raises
    ------
    OtherDimension
        If their dimensions differ.
    ValueError
        If one of them is unknown, or does not begin at zero.
    """
    if (power := prefix_power(unit, given_unit)) is not None:
        return float(f"1e{power}")
    import pint

    try:
        zero, one = (float(_registry().Quantity(value, given_unit).to(unit).magnitude) for value in (0.0, 1.0))
    except pint.DimensionalityError:
        raise OtherDimension(f"{given_unit} is no {unit}") from None
    except (pint.errors.PintError, *UNREADABLE):
        raise ValueError(f"{given_unit} is no unit") from None
    if zero:
        raise ValueError(f"{given_unit} does not begin at zero")
    return one


@lru_cache(maxsize=1024)
def is_known(unit: str, words: tuple[str, ...]) -> bool:
    """Whether it is a unit; ``words`` are those in it."""
    if prefix_power(unit, unit) is not None or single_words() >= set(words):
        return True
    import pint

    try:
        return bool(_registry().Quantity(1.0, unit))
    except (pint.errors.PintError, *UNREADABLE):
        return False


def are_compatible(unit: str, other: str) -> bool:
    """Whether two units have the same dimension."""
    return bool(_registry().is_compatible_with(unit, other))


def unusual_word(words: Iterable[str]) -> str | None:
    """The first of the words of a unit that pint reads, but none that tissue is measured in."""
    uncustomary = [word for word in words if word not in customary_words()]
    return next((word for word in uncustomary if _all_units().parse_unit_name(word)), None)


def compact(value: float, unit: str, style: str) -> tuple[float, str]:
    """A value that is not 0, with the SI prefix in which it reads well, from p to G; nobody speaks of megaseconds, and
    a millipascal is a letter from a megapascal.

    Parameters
    ----------
    value : in ``unit``, which is one of SI
    style : how pint writes a unit: P for people (mm²), C in ASCII but for µ (mm**2)
    """
    if unit in ("", "1", "rad") or (unit == "s" and abs(value) >= 1) or (unit == "Pa" and 1e-3 <= abs(value) < 1):
        return value, unit
    words, inverse = unit.removeprefix("1/").split("/"), unit.startswith("1/")
    shown = OVER_ANOTHER if len(words) == 2 else PLAIN
    if len(words) <= 2 - inverse and shown.keys() >= set(words):
        return _prefixed(value, "/".join(shown[word] for word in words), inverse=inverse)
    given = _registry().Quantity(value, unit)
    quantity = given.to_compact()
    if any(word.startswith(RARE_PREFIXES) for word, _ in quantity.unit_items()):
        quantity = given
    text = format(quantity.units, f"~{style}")
    return quantity.magnitude, METRES_FIRST.sub(r"\3\2\1", text)


def _prefixed(value: float, unit: str, *, inverse: bool) -> tuple[float, str]:
    """What `compact` makes of a value in a unit of one word, or of one word over another, or in its inverse."""
    size, one = math.log10(abs(value)) / 3, "1/" if inverse else ""
    power = 3 * (math.ceil(-size) if inverse else math.floor(size))
    if power not in SHOWN_PREFIXES:
        return value, one + unit
    return value * float(f"1e{power}") ** (1 if inverse else -1), f"{one}{SHOWN_PREFIXES[power]}{unit}"
