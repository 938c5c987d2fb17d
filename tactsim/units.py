"""Quantities: text with a unit in files, SI floats inside.

A pydantic field typed ``Length`` accepts ``"0.8 mm"`` and holds ``0.0008``. A bare number is SI in Python; in a case file
(validation context ``{"units": "required"}``) it is an error, because nobody can tell its unit.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Mapping
from decimal import Decimal
from functools import lru_cache
from typing import Annotated, Any, TypeVar

from pydantic import (
    BeforeValidator,
    Field,
    PlainSerializer,
    SerializationInfo,
    ValidationInfo,
    WithJsonSchema,
)

from tactsim.errors import InvalidQuantity, shown
from tactsim.unit_conversion import OtherDimension, are_compatible, compact, factor_to, is_known, unusual_word
from tactsim.unit_definitions import DIMENSIONS, FEW_UNITS

_QUANTITY = re.compile(
    r"(?P<number>[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan|inf(?:inity)?))(?:\s*(?P<unit>[^\s\d.].*|1\s*/.*))?",
    re.ASCII | re.DOTALL | re.IGNORECASE,
)
# One power of one digit per unit: pint evaluates longer towers, which a hostile file could make endless.
_WORD = r"[cm]?mH2O|[^\W\d_]+(?:_[^\W\d_]+)*"
_FACTOR = rf"(?:{_WORD})(?:(?:\*\*|\^)-?\d)?|[%°]"
_UNIT = re.compile(rf"(?=.{{1,40}}$)(?:1\s*/\s*)?(?:{_FACTOR})(?:\s*[*/·]\s*(?:{_FACTOR})|\s+(?:{_FACTOR}))*")

LONGEST_COUNT = 1e9
"""Whole numbers below it are written with all their digits."""
DASHES = ("\u2212", "\u2013")
"""The minus sign and the dash that papers and web pages have before a negative number."""
DECIMAL_POINT = "decimals begin with a point, not a comma"


@lru_cache(maxsize=1024)
def is_unit(text: str) -> bool:
    """Whether ``text`` is a unit that numbers can be shown in; "" and "1" are that of a plain number."""
    return text in ("", "1") or (_UNIT.fullmatch(text) is not None and is_known(text, tuple(re.findall(_WORD, text))))


def check_unit(what: str, unit: Any) -> None:
    """Refuses a unit in which nothing can be reported; ``what`` begins the message.

    Raises
    ------
    InvalidQuantity
        If it is no text, or unknown.
    """
    if not isinstance(unit, str) or not is_unit(unit):
        raise InvalidQuantity(f"{what}: {shown(unit)} is no unit that is known; expected text such as 'N' or '1'")


@lru_cache(maxsize=1024)
def _asked(unit: str) -> str:
    """What a message asks for where a quantity of the dimension of ``unit`` belongs."""
    if unit in ("", "1", "%"):
        return "a number with its unit, such as '1 %'"
    known = (words for other, words in DIMENSIONS.items() if are_compatible(other, unit))
    name, example = next(known, ("a number", f"1 {unit}"))
    return f"{name} with its unit, such as {example!r}"


def parse_quantity(text: str, unit: str) -> float:
    """The value of ``text`` ("0.8 mm") in ``unit`` ("m").

    Raises
    ------
    InvalidQuantity
        If the text is not a finite number with a customary unit of the same dimension, or a number so small that it becomes 0.
    """

    def expected() -> str:
        return f"expected {_asked(unit)}"

    def unknown() -> InvalidQuantity:
        powers = re.sub(r"(?<=[^\W\d_])(?=\d)", "^", given_unit)
        hint = f" (is it {powers!r}?)" if powers != given_unit and is_unit(powers) else ""
        return InvalidQuantity(f"{shown(text)} has an unknown unit {shown(given_unit)}{hint}; {expected()}")

    parts = _QUANTITY.fullmatch(re.sub(r"\s", " ", text.strip()))  # papers and web pages have spaces that do not break
    if parts is None or (parts["unit"] or "").startswith(","):
        point = DECIMAL_POINT if re.match(r"\s*[-+]?\d*,\d", text) else expected()
        point = "a minus is a hyphen, '-'" if text.lstrip()[:1] in DASHES else point
        raise InvalidQuantity(f"{shown(text)} is not a quantity; {point}")
    value, given_unit = float(parts["number"]), parts["unit"]
    if not math.isfinite(value):
        raise InvalidQuantity(f"{shown(text)} is not finite; {expected()}")
    if not given_unit:
        raise InvalidQuantity(f"{shown(text)} has no unit; {expected()}")
    if not _UNIT.fullmatch(given_unit):
        raise unknown()
    if unusual := unusual_word(re.findall(_WORD, given_unit)):
        raise InvalidQuantity(
            f"{shown(text)} is in {shown(unusual)}, which is not a unit that is read; allowed are {FEW_UNITS} ..."
        )
    try:
        converted = _converted(parts["number"], factor_to(unit, given_unit))
    except OtherDimension:
        raise InvalidQuantity(f"{shown(text)} has the wrong dimension; {expected()}") from None
    except ValueError:
        raise unknown() from None
    if not math.isfinite(converted):
        raise InvalidQuantity(f"{shown(text)} is not finite; {expected()}")
    if converted == 0 and re.search("[1-9]", re.split("[eE]", parts["number"])[0]):
        raise InvalidQuantity(f"{shown(text)} is too small to be told from 0; {expected()}")
    return converted


def _converted(number: str, factor: float) -> float:
    """A number as it is written times a factor, such that "0.8 mm" and "800 um" are the same float.

    The factor of a prefix moves the decimal point, and no digit is lost; the product with any other is taken to 15 digits.
    """
    value, power = float(number), _power_of_ten(factor)
    if power is None or value == 0:
        return float(f"{value * factor:.15g}")
    digits, _, exponent = number.lower().partition("e")
    return float(f"{digits}e{int(exponent or 0) + power}")


def _power_of_ten(factor: float) -> int | None:
    """The exponent of a factor that is a power of ten but for the round-off of its computation, None of any other."""
    power = round(math.log10(factor)) if factor > 0 else 0
    return power if math.isclose(factor, float(f"1e{power}"), rel_tol=1e-14) else None


def conversion(given_unit: str, unit: str) -> float:
    """How many ``unit`` one ``given_unit`` is.

    Raises
    ------
    InvalidQuantity
        If either is unknown, or their dimensions differ.
    """
    try:
        return factor_to(unit or "1", given_unit or "1") if (unit or "1") != (given_unit or "1") else 1.0
    except OtherDimension:
        raise InvalidQuantity(f"{shown(unit)} is not a unit of what is in {shown(given_unit)}") from None
    except ValueError:
        raise InvalidQuantity(f"{shown(unit)} is no unit that is known, such as {shown(given_unit)}") from None


def compact_unit(value: float, unit: str) -> str:
    """The unit with the SI prefix in which a value in SI reads well, such as ``kPa``."""
    if not value or not math.isfinite(value):
        return unit
    return compact(value, unit, "P")[1]


def format_quantity(value: float, unit: str) -> str:
    """``value`` in SI with a prefix that reads well: ``0.0008, "m"`` gives ``"800 µm"``; angles in degrees, counts whole."""
    if unit in ("", "1"):
        is_count = abs(value) < LONGEST_COUNT and value == round(value)
        return str(round(value)) if is_count else f"{value:.4g}"
    if unit == "rad" and math.isfinite(value):
        return f"{math.degrees(value):.5g}°"
    if value == 0 or not math.isfinite(value):
        return f"{value:g} {unit}"
    number, compact_unit = compact(value, unit, "P")
    return f"{number:.5g} {compact_unit}"


LARGEST = 1e60
"""In SI: what is larger is a slip of the keyboard, and its fifth power no number any more."""


def _is_pint(value: Any) -> bool:
    """Whether it is a quantity of pint, of whatever registry."""
    return "pint" in sys.modules and isinstance(value, sys.modules["pint"].Quantity)


def written(value: Any) -> Any:
    """A value from Python as a case file holds it: quantities of pint and of results as text, numpy as numbers."""
    if _is_pint(value) and not hasattr(value.magnitude, "__len__"):
        return f"{value.magnitude:.15g} {value.units:~C}".rstrip()
    if hasattr(value, "unit") and hasattr(value, "value"):
        return f"{value.value} {value.unit}".removesuffix(" 1")
    if hasattr(value, "tolist") and not _is_pint(value):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: written(item) for key, item in value.items()}
    return [written(item) for item in value] if isinstance(value, list | tuple) or _is_pint(value) else value


def _reader(unit: str, usual: str) -> Callable[[Any, ValidationInfo], float]:
    def read(value: Any, info: ValidationInfo) -> float:
        value = value if isinstance(value, str | int | float) else written(value)
        if isinstance(value, str):
            return bounded(parse_quantity(value, unit), value)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InvalidQuantity(f"{shown(value)} is not a quantity; expected text such as '1 {usual}'")
        if info.context and info.context.get("units") == "required":
            units = " or ".join(f"'{value:g} {one}'" for one in dict.fromkeys((usual, unit)))
            raise InvalidQuantity(f"{shown(value)} has no unit; expected text such as {units}")
        try:
            return bounded(float(value), value)
        except OverflowError:  # a whole number beyond all floats
            return math.inf

    def bounded(number: float, given: Any) -> float:
        if LARGEST < abs(number) < math.inf:
            raise InvalidQuantity(f"{shown(given)} is larger than anything in nature; allowed: up to {LARGEST:g} {unit}")
        return number

    return read


MOST_ZEROS = 7
"""Digits before the first one, or after the last, from which on a written number has an exponent."""


def written_quantity(value: float, unit: str) -> str:
    """``value`` in SI as a file writes it, which is read as the same float: ``0.04, "m"`` gives ``"40 mm"``."""
    if unit == "rad" and parse_quantity(degrees := f"{math.degrees(value):.15g} deg", unit) == value:
        return degrees
    if value and math.isfinite(value) and unit != "rad":
        magnitude, spelled = compact(value, unit, "C")
        given_unit = spelled.replace("**", "^")
        power = _power_of_ten(factor_to(unit, given_unit))
        number = f"{magnitude:.15g}" if power is None else _shifted(value, -power)
        if parse_quantity(text := f"{number} {given_unit}", unit) == value:
            return text
    return f"{_shifted(value, 0)} {unit}"


def _shifted(value: float, power: int) -> str:
    """The fewest digits that tell the float apart, with the decimal point moved; an exponent instead of many zeros."""
    number = Decimal(repr(value)).scaleb(power).normalize()
    return f"{number:f}" if number == 0 or abs(number.adjusted()) < MOST_ZEROS else f"{number:e}"


def _writer(unit: str) -> Callable[[float, SerializationInfo], Any]:
    def write(value: float, info: SerializationInfo) -> Any:
        return written_quantity(value, unit) if info.context and info.context.get("units") == "written" else value

    return write


def quantity_type(unit: str, example: str) -> Any:
    """A pydantic type that reads text in any unit of this dimension and holds the SI float."""
    pattern = r"^\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\s*[^0-9\s].*$"
    schema = {"type": "string", "pattern": pattern, "examples": [example], "unit": unit}
    return Annotated[
        float,
        BeforeValidator(_reader(unit, example.partition(" ")[2])),
        PlainSerializer(_writer(unit)),
        WithJsonSchema(schema, mode="validation"),
        Field(json_schema_extra={"unit": unit}),
    ]


Length = quantity_type("m", "1.5 mm")
Pressure = quantity_type("Pa", "3.2 kPa")
Area = quantity_type("m^2", "80 mm^2")
Force = quantity_type("N", "0.5 N")
Time = quantity_type("s", "2 s")
Frequency = quantity_type("Hz", "5 Hz")
Speed = quantity_type("m/s", "1 mm/s")
Angle = quantity_type("rad", "20 deg")
Resistance = quantity_type("ohm", "10 kohm")
Conductance = quantity_type("S", "0.5 mS")
Capacitance = quantity_type("F", "20 pF")
Voltage = quantity_type("V", "5 V")
Viscosity = quantity_type("Pa*s", "2.9 MPa*s")
Energy = quantity_type("J", "0.05 eV")
Mass = quantity_type("kg", "4.2 mg")
Density = quantity_type("kg/m^3", "0.91 g/cm^3")
ForcePerVolume = quantity_type("N/m^3", "9.81 kN/m^3")
ConductancePerForce = quantity_type("S/N", "0.05 mS/N")
PressurePerForce = quantity_type("Pa/N", "60.9 kPa/N")
ViscosityPerForce = quantity_type("Pa*s/N", "1.2 MPa*s/N")

Number = TypeVar("Number")
Positive = Annotated[Number, Field(gt=0)]
"""``Positive[Length]``: greater than zero."""
NonNegative = Annotated[Number, Field(ge=0)]
"""``NonNegative[Time]``: zero or greater."""


def rough_time(seconds: float) -> str:
    """A time in s in words, as far as a guess goes: in seconds, minutes or hours.

    >>> rough_time(65.4), rough_time(1500), rough_time(9000)
    ('65 s', '25 min', '2.5 h')
    """
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
