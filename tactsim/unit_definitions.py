"""The units that a quantity may have, as definitions for pint: those of SI, and those that laboratories and medicine print.

An angle has a dimension of its own, so that rad/s is no frequency in Hz. Any other unit that pint knows, from the furlong to the
parsec, is a slip. With these alone a process is ready to read quantities in a tenth of the time that all of pint's units take.
"""

from __future__ import annotations

from functools import cache

FEW_UNITS = "m, mm, inch, g, s, min, h, N, kgf, dyn, Pa, kPa, bar, mmHg, cmH2O, psi, V, A, ohm, S, F, J, eV, Hz, deg, rad, %"
PREFIXES = (
    "quecto- = 1e-30 = q-",
    "ronto- = 1e-27 = r-",
    "yocto- = 1e-24 = y-",
    "zepto- = 1e-21 = z-",
    "atto- = 1e-18 = a-",
    "femto- = 1e-15 = f-",
    "pico- = 1e-12 = p-",
    "nano- = 1e-9 = n-",
    "micro- = 1e-6 = µ- = μ- = u-",
    "milli- = 1e-3 = m-",
    "centi- = 1e-2 = c-",
    "deci- = 1e-1 = d-",
    "deca- = 1e+1 = da- = deka-",
    "hecto- = 1e2 = h-",
    "kilo- = 1e3 = k-",
    "mega- = 1e6 = M-",
    "giga- = 1e9 = G-",
    "tera- = 1e12 = T-",
    "peta- = 1e15 = P-",
    "exa- = 1e18 = E-",
    "zetta- = 1e21 = Z-",
    "yotta- = 1e24 = Y-",
    "ronna- = 1e27 = R-",
    "quetta- = 1e30 = Q-",
)
RARE_PREFIXES = ("quecto", "ronto", "yocto", "zepto", "atto", "femto", "tera", "peta", "exa", "zetta", "yotta", "ronna", "quetta")
"""Those that are read but in which no number is shown: an exponent reads better."""
PREFIXED = (
    "meter = [length] = m = metre",
    "second = [time] = s = sec",
    "ampere = [current] = A = amp",
    "gram = [mass] = g",
    "mole = [substance] = mol",
    "kelvin = [temperature]; offset: 0 = K = degK = °K = degree_Kelvin = degreeK",
    "radian = [angle] = rad",
    "liter = 1e-3 * meter ** 3 = l = L = ℓ = litre",
    "hertz = 1 / second = Hz",
    "newton = kilogram * meter / second ** 2 = N",
    "dyne = gram * centimeter / second ** 2 = dyn",
    "force_gram = 9.80665e-3 * newton = gf = gram_force = pond",
    "force_kilogram = 9.80665 * newton = kgf = kilogram_force",
    "pascal = newton / meter ** 2 = Pa",
    "bar = 1e5 * pascal",
    "torr = 101325 / 760 * pascal",
    "meter_Hg = 13595.1 * 9.80665 * pascal = mHg = m_Hg",
    "meter_H2O = 9806.65 * pascal = mH2O = m_H2O",
    "joule = newton * meter = J",
    "erg = dyne * centimeter",
    "calorie = 4.184 * joule = cal = thermochemical_calorie = cal_th",
    "electron_volt = 1.602176634e-19 * joule = eV = electronvolt",
    "watt = joule / second = W",
    "coulomb = ampere * second = C",
    "volt = joule / coulomb = V",
    "farad = coulomb / volt = F",
    "ohm = volt / ampere = Ω",
    "siemens = ampere / volt = S = mho",
    "weber = volt * second = Wb",
    "henry = weber / ampere = H",
    "tesla = weber / meter ** 2 = T",
    "poise = 0.1 * pascal * second = P",
    "stokes = 1e-4 * meter ** 2 / second = St",
)
"""They take a prefix: kilopascal, mmHg, cP."""
UNPREFIXED = (
    "micron = micrometer = µ = μ",
    "angstrom = 1e-10 * meter = Å = ångström = Å",
    "inch = 0.0254 * meter = in = international_inch = inches = international_inches",
    "foot = 0.3048 * meter = ft = international_foot = feet = international_feet",
    "thou = 2.54e-5 * meter = th = mil_length",
    "pound = 0.45359237 * kilogram = lb = avoirdupois_pound",
    "metric_ton = 1e3 * kilogram = t = tonne",
    "force_pound = 0.45359237 * 9.80665 * newton = lbf = pound_force",
    "pound_force_per_square_inch = force_pound / inch ** 2 = psi",
    "standard_atmosphere = 101325 * pascal = atm = atmosphere",
    "minute = 60 * second = min",
    "hour = 60 * minute = h = hr",
    "day = 24 * hour = d",
    "degree_Celsius = kelvin; offset: 273.15 = °C = celsius = degC = degreeC",
    "degree = 3.14159265358979323846 / 180 * radian = deg = ° = arcdeg = arcdegree = angular_degree",
    "percent = 0.01 = %",
)
"""Their names stand alone: a ``ct`` is a carat, not a hundredth of a tonne."""
DIMENSIONS = {
    "m": ("a length", "1 mm"),
    "Pa": ("a pressure", "1 kPa"),
    "N": ("a force", "1 N"),
    "s": ("a time", "1 s"),
    "Hz": ("a frequency", "1 Hz"),
    "m/s": ("a speed", "1 mm/s"),
    "rad": ("an angle", "1 deg"),
    "m^2": ("an area", "1 mm^2"),
    "m^3": ("a volume", "1 mm^3"),
    "ohm": ("a resistance", "1 kohm"),
    "S": ("a conductance", "1 mS"),
    "F": ("a capacitance", "1 pF"),
    "V": ("a voltage", "1 V"),
    "Pa*s": ("a viscosity", "1 kPa*s"),
    "J": ("an energy", "1 J"),
    "kg": ("a mass", "1 g"),
    "kg/m^3": ("a density", "1 g/cm^3"),
}
"""SI unit of a dimension -> its name, and an example."""


SHOWN_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""Exponent of the factor of a prefix in which numbers are shown -> its symbol."""
PLAIN = {unit: unit for unit in ("m", "s", "A", "Hz", "N", "Pa", "J", "W", "C", "V", "F", "S")} | {"ohm": "Ω"}
"""Units that most quantities have -> how they are shown; a prefix before one of them can be nothing else."""
OVER_ANOTHER = PLAIN | {"N*m": "N·m"}
"""Units that are shown as they are over another one: pint makes a moment per length, N*m/m, a force."""


@cache
def _powers_of_ten() -> dict[str, int]:
    """Prefix, as name or symbol -> the exponent of its factor."""
    powers = {"": 0}
    for line in PREFIXES:
        exponent = line.split("=")[1].partition("e")[2]
        powers |= {name.removesuffix("-"): int(exponent) for name in _names(line) if name.endswith("-")}
    return powers


def prefix_power(unit: str, given_unit: str) -> int | None:
    """The exponent of ten by which a plain unit with an SI prefix, or one over the same, differs from it; None of other pairs."""
    (unit, *below), (given_unit, *given_below) = unit.split("/"), given_unit.split("/")
    if below != given_below or len(below) > 1 or not PLAIN.keys() >= set(below):
        return None
    prefix = given_unit.removesuffix(unit) if unit in PLAIN and given_unit.endswith(unit) else None
    return None if prefix is None else _powers_of_ten().get(prefix)


@cache
def customary_words() -> frozenset[str]:
    """Every spelling of a customary unit, with its prefixes, and each with the s of a plural, which few of them take."""
    return single_words() | {f"{name}s" for name in single_words()}


@cache
def single_words() -> frozenset[str]:
    """Every spelling of one of a customary unit, with its prefixes: all of them are read."""
    prefixes, prefixed, unprefixed = (
        {name.removesuffix("-") for line in lines for name in _names(line)} for lines in (PREFIXES, PREFIXED, UNPREFIXED)
    )
    return frozenset({*unprefixed, *prefixed, *(prefix + name for prefix in prefixes for name in prefixed)})


def _names(definition: str) -> list[str]:
    """The names in a definition such as ``meter = [length] = m = metre``."""
    name, _, *others = (part.strip() for part in definition.split("="))
    return [name, *others]
