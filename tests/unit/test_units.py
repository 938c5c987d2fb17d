"""Quantities: text with a unit in files, SI floats inside."""

from __future__ import annotations

import math

import numpy as np
import pint
import pytest
from pydantic import TypeAdapter, ValidationError

from tactsim.contact.coulomb import Coulomb
from tactsim.errors import InvalidQuantity, Refused
from tactsim.results.quantity import Quantity
from tactsim.unit_conversion import _registry, compact, factor_to
from tactsim.unit_definitions import PLAIN, PREFIXED, SHOWN_PREFIXES, UNPREFIXED, _powers_of_ten, prefix_power, single_words
from tactsim.units import Length, check_unit, compact_unit, conversion, format_quantity, is_unit, parse_quantity, written_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.8 mm", "m", 0.0008),
        ("800 um", "m", 0.0008),
        ("800µm", "m", 0.0008),
        (" +1e-3 km ", "m", 1.0),
        ("-.5m", "m", -0.5),
        ("20 deg", "rad", 0.349065850398866),
        ("20°", "rad", 0.349065850398866),
        ("3 N/mm**2", "Pa", 3e6),
        ("3 N/mm^2", "Pa", 3e6),
        ("5 kPa s", "Pa*s", 5e3),
        ("2 1/s", "1/s", 2.0),
        ("5 %", "", 0.05),
    ],
)
def test_text_is_read_in_any_unit_of_the_dimension(text: str, unit: str, value: float) -> None:
    assert parse_quantity(text, unit) == value


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("3", "has no unit"),
        ("3 Pa", "has the wrong dimension"),
        ("3 min", "has the wrong dimension"),
        ("3 mx", "has an unknown unit"),
        ("nan m", "is not finite"),
        ("-inf m", "is not finite"),
        ("1e308 km", "is not finite"),
        ("m", "is not a quantity"),
        ("3 mm2", r"unknown unit 'mm2' \(is it 'mm\^2'\?\)"),
        ("3 mx2", "unknown unit 'mx2';"),
        ("1,5 mm", "decimals begin with a point, not a comma"),
        ("\u22125 mm", "a minus is a hyphen, '-'"),
        ("\u20135 mm", "a minus is a hyphen, '-'"),
        ("1_0 m", "has an unknown unit"),
        ("٣ m", "is not a quantity"),
        ("3 m**9**9**9**9", "has an unknown unit"),
        ("3 " + "m*" * 50 + "m", "has an unknown unit"),
        ("3 ().__class__", "has an unknown unit"),
    ],
)
def test_what_is_no_quantity_is_reported(text: str, words: str) -> None:
    with pytest.raises(InvalidQuantity, match=words):
        parse_quantity(text, "m")


def test_a_bare_number_is_si_in_python_and_refused_in_a_file() -> None:
    adapter = TypeAdapter(Length)
    assert adapter.validate_python(0.5) == 0.5
    with pytest.raises(ValidationError, match=r"0\.5 has no unit; expected text such as '0\.5 mm' or '0\.5 m'"):
        adapter.validate_python(0.5, context={"units": "required"})
    with pytest.raises(ValidationError, match="True is not a quantity"):
        adapter.validate_python(True)


def test_values_are_printed_to_be_read() -> None:
    assert format_quantity(0.0008, "m") == "800 µm"
    assert format_quantity(1e7, "s") == "1e+07 s"
    assert format_quantity(0.02, "s") == "20 ms"
    assert format_quantity(0.25, "1") == "0.25"
    assert format_quantity(math.radians(30), "rad") == "30°"
    assert format_quantity(0.0, "Pa") == "0 Pa"
    assert format_quantity(0.42, "Pa") == "0.42 Pa"  # mPa is a letter from MPa
    assert format_quantity(0.0, "rad") == "0°"
    assert format_quantity(43150.0, "1") == "43150"
    assert format_quantity(3.0854, "N m") == "3.0854 N·m"
    assert format_quantity(0.004, "N m") == "4 mN·m"
    assert compact_unit(0.004, "N m") == "mN·m", "as beside a number"
    assert format_quantity(4e3, "N*m/m") == "4 kN·m/m", "a moment of a metre of depth is no force"
    assert compact_unit(3e6, "Pa s/N") == format_quantity(3e6, "Pa s/N").split()[1] == "MPa·s/N"
    assert conversion("Pa s/N", "MPa·s/N") == 1e-6


@pytest.mark.parametrize("unit", ["m", "Pa", "m^2", "N", "rad", "Pa*s", "kg/m^3", "Pa/N"])
def test_what_is_written_is_read_as_the_same_float(unit: str) -> None:
    generator = np.random.default_rng(3)
    values = 10.0 ** generator.uniform(-9, 9, 100) * generator.choice([-1, 1], 100)
    for value in (*values.tolist(), 0.7 * 1e-3, 0.0):
        assert parse_quantity(written_quantity(value, unit), unit) == value


def test_what_is_written_is_written_to_be_read() -> None:
    assert written_quantity(7838.8393223224548, "Pa") == "7.838839322322455 kPa"
    assert [written_quantity(value, "m") for value in (0.04, 0.0, 8e-4)] == ["40 mm", "0 m", "800 µm"]
    assert written_quantity(parse_quantity("20 deg", "rad"), "rad") == "20 deg"


@pytest.mark.parametrize(("text", "unit"), [("6.28 rad/s", "Hz"), ("360 deg/s", "Hz"), ("1 Hz", "rad/s"), ("5 %", "rad")])
def test_an_angle_is_no_plain_number(text: str, unit: str) -> None:
    """Pint holds 1 rad/s for 1 Hz, 2 pi times too fast, as rheometers print angular frequencies."""
    assert parse_quantity("6 1/s", "Hz") == parse_quantity("6 Hz", "Hz") == 6.0
    with pytest.raises(InvalidQuantity, match="wrong dimension"):
        parse_quantity(text, unit)


def test_a_unit_that_does_not_begin_at_zero_is_refused() -> None:
    assert parse_quantity("3 mK", "K") == 0.003
    with pytest.raises(InvalidQuantity, match="has an unknown unit"):
        parse_quantity("3 degC", "K")


def test_customary_units_are_those_of_pint() -> None:
    everything = pint.UnitRegistry(cache_folder=None)
    for definition in (*PREFIXED, *UNPREFIXED):
        name, *others = (part.strip() for part in definition.split("="))
        for word in (name, *others[1:]):
            unit = f"{everything.Quantity(0.0, word).to_base_units().units:~}"
            if "°" in word or name in ("degree", "percent", "degree_Celsius", "kelvin", "radian"):
                continue  # no dimension, or an offset
            expected = everything.Quantity(1.0, word).to(unit).magnitude
            assert factor_to(unit, word) == pytest.approx(expected, rel=1e-14), word


@pytest.mark.parametrize("unit", sorted(PLAIN))
def test_a_plain_unit_is_read_and_shown_with_a_prefix_as_pint_does_it(unit: str) -> None:
    """What no library is loaded for, against the library."""
    pints = _registry()
    for prefix, power in _powers_of_ten().items():
        assert (
            factor_to(unit, prefix + unit) == float(f"1e{power}") == float(pints.Quantity(1.0, prefix + unit).to(unit).magnitude)
        )
    for value in (*spread_values(4, 300), 1e-3, 1000.0, 999.9999):
        unprefixed = (unit == "s" and abs(value) >= 1) or (unit == "Pa" and 1e-3 <= abs(value) < 1)
        check_shown_as_by_pint(value, unit, [] if unprefixed else [prefix + PLAIN[unit] for prefix in SHOWN_PREFIXES.values()])


def spread_values(seed: int, count: int) -> list[float]:
    """Numbers of either sign over thirty powers of ten."""
    generator = np.random.default_rng(seed)
    values: list[float] = (10.0 ** generator.uniform(-15, 15, count) * generator.choice([-1, 1], count)).tolist()
    return values


def check_shown_as_by_pint(value: float, unit: str, shown: list[str]) -> None:
    """With pint's prefix if the unit with it is one of those that are ``shown``, else without."""
    expected = _registry().Quantity(value, unit)
    short = expected.to_compact()
    if f"{short.units:~P}" in shown:
        expected = short
    for style in "PC":
        number, text = compact(value, unit, style)
        assert (f"{number:.5g}", text) == (f"{expected.magnitude:.5g}", format(expected.units, f"~{style}"))


@pytest.mark.parametrize("unit", ["N/m", "S/N", "V/N", "Pa/s", "m/s", "J/m", "S/F", "Pa/A", "ohm/N"])
def test_a_quotient_is_read_and_shown_with_a_prefix_above_the_line_as_pint_does_it(unit: str) -> None:
    symbol = f"{_registry().Quantity(1.0, unit).units:~P}"
    for given in (f"m{unit}", f"kilo{unit}"):
        assert prefix_power(unit, given) == round(np.log10(_registry().Quantity(1.0, given).to(unit).magnitude))
    assert prefix_power(unit, f"{unit}/s") is prefix_power(unit, f"{unit}**2") is prefix_power(f"{unit}/V", f"{unit}/V") is None
    for value in spread_values(5, 60):
        check_shown_as_by_pint(value, unit, [prefix + symbol for prefix in SHOWN_PREFIXES.values()])


@pytest.mark.parametrize("unit", ["m", "Pa", "s", "ohm"])
def test_an_inverse_is_shown_with_a_prefix_as_pint_does_it(unit: str) -> None:
    for value in spread_values(6, 60):
        check_shown_as_by_pint(value, f"1/{unit}", [f"1/{prefix}{PLAIN[unit]}" for prefix in SHOWN_PREFIXES.values()])


def test_a_prefix_does_not_make_a_unit_out_of_another() -> None:
    with pytest.raises(InvalidQuantity, match="'ct', which is not a unit that is read"):  # a carat; not a hundredth of a tonne
        parse_quantity("5 ct", "kg")


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("m", "expected a length with its unit, such as '1 mm'"),
        ("kPa", "expected a pressure with its unit, such as '1 kPa'"),
        ("rad", "expected an angle with its unit, such as '1 deg'"),
        ("", "expected a number with its unit, such as '1 %'"),
        ("S/N", "expected a number with its unit, such as '1 S/N'"),
    ],
)
def test_a_message_names_the_dimension(unit: str, words: str) -> None:
    with pytest.raises(InvalidQuantity, match=f"{words}$"):
        parse_quantity("3", unit)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(2e-11, "F", "20 pF"), (1e-30, "m", "1e-30 m"), (1e300, "Hz", "1e+300 Hz"), (1e13, "Pa", "1e+13 Pa"), (2e9, "Pa", "2 GPa")],
)
def test_a_number_has_a_customary_prefix_or_an_exponent(value: float, unit: str, text: str) -> None:
    assert format_quantity(value, unit) == text
    assert compact_unit(value, unit) == text.split()[1]
    assert parse_quantity(written_quantity(value, unit), unit) == value


def test_a_length_of_a_result_is_no_number() -> None:
    assert Coulomb(friction=Quantity(0.3, "1", "")).friction == 0.3
    with pytest.raises(Refused, match=r"Coulomb: friction: '0.002 m' is not allowed; expected a number"):
        Coulomb(friction=Quantity(2e-3, "m", ""))


def test_every_word_that_is_known_without_pint_is_known_to_it():
    registry = _registry()
    unread = [word for word in single_words() if not registry.parse_unit_name(word)]
    assert unread == []
    assert all(map(is_unit, ("N m", "kg/m^3", "1/Pa", "kPa*s", "rad/s", "%", "cmH2O")))
    assert not any(map(is_unit, ("Nn", "N Nn", "m/", "kms", "parrot/s")))


@pytest.mark.parametrize("unit", ["Nn", "kg/parrot", 3, None])
def test_a_unit_in_which_nothing_can_be_reported_is_refused_with_its_place(unit):
    with pytest.raises(InvalidQuantity, match=f"^Weighing: {unit!r} is no unit that is known; expected text such as 'N' or '1'$"):
        check_unit("Weighing", unit)


@pytest.mark.parametrize("space", ["\u00a0", "\u202f", "\u2009"])
def test_a_space_of_a_paper_or_a_web_page_is_a_space(space):
    assert parse_quantity(f"9.08{space}mN", "N") == parse_quantity("9.08 mN", "N")
    assert parse_quantity(f"3 Pa{space}s", "Pa*s") == 3.0
