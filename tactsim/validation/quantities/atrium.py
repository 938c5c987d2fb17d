"""The atrial tissue of Table 4.1: its constants, its creep and what dynamic mechanical analysis would measure; chapter 4."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import TAU, TIMES, E, table_4_1
from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import drawing, quantity
from tactsim.units import Frequency, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series

Times = Annotated[Literal["retardation_times", "viscosities"], Field(description="Reading of the column of times of Table 4.1.")]
Compliance = Annotated[
    Literal["tensile", "half_shear"], Field(description="Reading of the compliance of Table 4.1: 1/E, or 1/(2G).")
]
Unit = Annotated[int, Field(ge=1, le=8, description="Row of Table 4.1.")]
FREQUENCIES = np.arange(1.0, 37.0, 5.0)
"""Tested frequencies in Hz, thesis section 4.4."""
TIMES_LABELS = {"retardation_times": "times in s (as printed)", "viscosities": "viscosities in MPa s (as in 4.6.4)"}
POINTS = 200
"""Points of a drawn curve."""


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


@quantity(unit=lambda constant: "Pa" if constant == "modulus" else "s")
def atrial_constant(constant: Literal["modulus", "time"], number: Annotated[int, Field(ge=0, le=8)]) -> float:
    """E_0 or E_i in Pa, or tau_i in s, taken out of the creep compliance that the library builds from Table 4.1.

    Parameters
    ----------
    constant : column of the table
    number : row of the table; 0 is the free spring, which has no time

    Raises
    ------
    InputError
        If the time of the free spring is asked for.
    """
    if constant == "modulus" and number == 0:
        return 1 / table_4_1().glassy_compliance
    compliance, time = numbered_unit("retardation_times", number)
    return 1 / compliance if constant == "modulus" else time


@quantity(unit="1/s")
def atrial_rate(number: Unit, times: Times = "viscosities") -> float:
    """Rate 1 / tau_i in 1/s of a Kelvin unit: E_i / C_i if the column of times holds viscosities (E7)."""
    return 1 / numbered_unit(times, number)[1]


@quantity(unit="1/Pa")
def atrial_compliance(number: Unit | None = None, time: NonNegative[Time] | None = None, times: Times = "viscosities") -> float:
    """Compliance D of Table 4.1 in 1/Pa: of one unit, or its creep after a time, or after infinite time.

    Parameters
    ----------
    number : unit of the table; null for the whole
    time : time since a step of stress; null for infinite time
    """
    if number is not None:
        return numbered_unit(times, number)[0]
    model = table_4_1(times)
    return model.equilibrium_compliance if time is None else float(model.creep(time))


def _oscillation_unit(quantity: str) -> str:
    return "1" if quantity == "loss_tangent" else "1/Pa" if quantity.endswith("compliance") else "Pa"


@quantity(unit=_oscillation_unit)
def atrial_oscillation(
    quantity: Literal[
        "complex_modulus", "elastic_modulus", "viscous_modulus", "loss_tangent", "elastic_compliance", "viscous_compliance"
    ],
    frequency: Positive[Frequency],
    times: Times = "retardation_times",
) -> float:
    """A modulus in Pa, a compliance in 1/Pa or tan delta at a frequency, of eq. 4.3.8.

    Parameters
    ----------
    quantity : what is measured
    frequency : frequency of the test
    """
    compliance = complex(table_4_1(times).complex_compliance(2 * np.pi * frequency))
    modulus = 1 / compliance
    return {
        "complex_modulus": abs(modulus),
        "elastic_modulus": modulus.real,
        "viscous_modulus": modulus.imag,
        "loss_tangent": modulus.imag / modulus.real,
        "elastic_compliance": compliance.real,
        "viscous_compliance": -compliance.imag,
    }[quantity]


@quantity(unit="1")
def atrial_time_group(size: Annotated[int, Field(ge=2, le=8)] | None = None, spread: Positive[float] = 0.0261) -> float:
    """Smallest spread, largest over smallest less 1, of any ``size`` of the eight printed times; or how many lie within a spread.

    Parameters
    ----------
    size : number of times whose spread is asked for
    spread : spread within which the largest group is counted, if no size is given
    """
    times = np.sort(numbered_units("retardation_times")[1])
    if size is not None:
        return float((times[size - 1 :] / times[: times.size - size + 1]).min() - 1)
    return float((times[None, :] / times[:, None] - 1 <= spread).sum(axis=1, where=times >= times[:, None]).max())


@quantity(unit="1")
def identifiable_constants(data_error: Annotated[float, Field(gt=0, lt=1)]) -> float:
    """Number of combinations of the constants of Table 4.1 that its data can determine.

    It is the number of singular values of `sensitivities` above the error of the data: a change of the constants by a factor of
    e along any other direction is lost in that error.

    Parameters
    ----------
    data_error : relative error of each compliance
    """
    return float((np.linalg.svd(sensitivities(), compute_uv=False) > data_error).sum())


def sensitivities() -> Array:
    r"""How the eight elastic and eight viscous compliances of eq. 4.3.8 change with the 17 constants, shape (16, 17).

    .. math::
        \frac{\partial \ln (D_e, D_v)(\omega_j)}{\partial \ln (E_0, \ldots, E_8, \tau_1, \ldots, \tau_8)}, \quad
        D^* = \frac{1}{E_0} + \sum_i \frac{1}{E_i (1 + i \omega \tau_i)}
    """
    compliances, times = numbered_units("retardation_times")
    glassy = np.full((FREQUENCIES.size, 1), table_4_1().glassy_compliance + 0j)
    phase = 2j * np.pi * FREQUENCIES[:, None] * times
    units = compliances / (1 + phase)
    total = glassy + units.sum(axis=1, keepdims=True)
    columns = np.hstack([-glassy, -units, -units * phase / (1 + phase)])
    return np.vstack([columns.real / total.real, columns.imag / total.imag])


@quantity(unit=lambda quantity: "1" if quantity == "count" else "Hz")
def even_frequencies(
    quantity: Literal["highest", "spacing", "count"],
    lowest: Positive[Frequency] = 1.0,
    highest: Positive[Frequency] = 36.0,
    spacing: Positive[Frequency] = 5.0,
    count: Annotated[int, Field(ge=2)] = 8,
) -> float:
    """Highest frequency in Hz of a series of tests at even spacing, or its spacing, or their number, from the other two.

    Parameters
    ----------
    quantity : what is asked for; its value below does not matter
    lowest, highest : first and last test
    spacing : difference of successive tests
    count : number of tests
    """
    if quantity == "count":
        return (highest - lowest) / spacing + 1
    return (highest - lowest) / (count - 1) if quantity == "spacing" else lowest + spacing * (count - 1)


@drawing
def atrial_moduli(title: Title, times: Times) -> Data:
    """Complex, elastic and viscous modulus in Pa and tan delta of Table 4.1 over the frequency in Hz, as Fig. 4.10.

    The measured moduli are not printed.
    """
    frequency = np.linspace(FREQUENCIES[0], FREQUENCIES[-1], POINTS)
    line, tested = (1 / table_4_1(times).complex_compliance(2 * np.pi * f) for f in (frequency, FREQUENCIES))
    moduli = [
        series("complex modulus", frequency, np.abs(line)),
        series("elastic modulus", frequency, line.real),
        series("viscous modulus", frequency, line.imag),
        series("tested frequencies", FREQUENCIES, np.abs(tested), "points"),
    ]
    tangents = [
        series("tan delta", frequency, line.imag / line.real),
        series("tested frequencies", FREQUENCIES, tested.imag / tested.real, "points"),
    ]
    return curves_figure(title, "frequency", "Hz", [panel("modulus", "Pa", moduli), panel("tan delta", "", tangents)])


@drawing
def atrial_compliances(title: Title) -> Data:
    """Elastic and viscous compliance in 1/MPa of Table 4.1 by eq. 4.3.8 over the frequency in Hz in both readings, as Fig. 4.11.

    The measured compliances are not printed.
    """
    frequency = np.geomspace(FREQUENCIES[0], FREQUENCIES[-1], POINTS)

    def compliance(times: str, frequency: Array) -> Array:
        return 1e6 * table_4_1(times).complex_compliance(2 * np.pi * frequency)

    panels = []
    for name, part in (("elastic", np.real), ("viscous", lambda value: -np.imag(value))):
        curves = [series(TIMES_LABELS[times], frequency, part(compliance(times, frequency))) for times in TIMES]
        tested = part(compliance("retardation_times", FREQUENCIES))
        curves.append(series("tested frequencies", FREQUENCIES, tested, "points"))
        panels.append(panel(f"{name} compliance in 1/MPa", "", curves, logarithmic=True))
    return curves_figure(title, "frequency", "Hz", panels, x_logarithmic=True, even_panels=True)
