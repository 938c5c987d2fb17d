"""The piezoresistive film, its calibration line and its electronics: thesis sections 2.1 to 2.3 and 3.1.2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.identification.calibration_line import fit_calibration_line
from tactsim.identification.film_line import identify_film
from tactsim.interfaces import quantity
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.signal_chain import SignalChain
from tactsim.sensors.films.composite_library import AnyComposite, named_composite
from tactsim.sensors.films.film import Film
from tactsim.sensors.films.film_equations import Reading, creep_strain, varying_coefficient_jump
from tactsim.sensors.films.film_equations import film_resistance as resistance_of
from tactsim.sensors.films.thermogravimetry import Thermogravimetry
from tactsim.sensors.films.tunnelling import tunnelling_decay, volume_fraction
from tactsim.units import Density, Force, Frequency, Length, Mass, NonNegative, Positive, Time

FilmComposite = Annotated[AnyComposite, Field(description="Name of a shipped composite, or its numbers.")]
FILLER_UNITS = {"volume": "1", "mass": "1", "sample_mass": "kg", "filler_volume": "m^3", "matrix_volume": "m^3"}
CONSTANT_UNITS = {
    "separation": "m",
    "decay": "1/m",
    "exponent": "1",
    "initial_resistance": "ohm",
    "contact_resistance": "ohm",
    "creep_rate": "1/s",
}
LITERAL, IDENTIFIED = named_composite("lingstat_literal"), named_composite("lingstat_identified")
HISTORY_STEPS = 50
"""Steps in which the creep law is integrated."""


@quantity(unit=lambda by: FILLER_UNITS[by])
def filler_fraction(
    *,
    filler_mass: Mass = 4.2083e-6,
    matrix_mass: Mass = 16.9496e-6,
    filler_density: Density = 560.0,
    matrix_density: Density = 910.0,
    by: Literal["volume", "mass", "sample_mass", "filler_volume", "matrix_volume"] = "volume",
) -> float:
    """Fraction of the filler by thermogravimetric analysis, or the mass in kg or a volume in m^3 that it comes from.

    Parameters
    ----------
    filler_mass, matrix_mass : what the furnace left, and what it burnt
    filler_density : of carbon black
    matrix_density : of polyethylene
    by : fraction of the volume or of the mass; mass of the whole sample; volume of one part
    """
    whole, densities = filler_mass + matrix_mass, {"filler_density": filler_density, "matrix_density": matrix_density}
    return {
        "volume": volume_fraction(filler_mass=filler_mass, matrix_mass=matrix_mass, **densities),
        "mass": filler_mass / whole,
        "sample_mass": whole,
        "filler_volume": filler_mass / filler_density,
        "matrix_volume": matrix_mass / matrix_density,
    }[by]


@quantity(unit="1")
def filler_fraction_deviation(
    *,
    sample_mass: Mass = 21.158e-6,
    filler_mass: Mass = 4.2083e-6,
    mass_resolution: Mass = 1e-10,
    filler_density: Density = 560.0,
    filler_density_deviation: Density = 0.0,
    matrix_density: Density = 910.0,
    matrix_density_deviation: Density = 0.0,
) -> float:
    """Standard uncertainty of the filler's fraction by volume, dimensionless, from those of masses and densities.

    Parameters
    ----------
    sample_mass, filler_mass : before the analysis, and what remained
    mass_resolution : last digit of the balance
    filler_density, matrix_density : of carbon black and of polyethylene
    filler_density_deviation, matrix_density_deviation : their standard uncertainties
    """
    return Thermogravimetry(
        sample_mass=sample_mass,
        filler_mass=filler_mass,
        mass_resolution=mass_resolution,
        filler_density=filler_density,
        filler_density_deviation=filler_density_deviation,
        matrix_density=matrix_density,
        matrix_density_deviation=matrix_density_deviation,
    ).volume_fraction_deviation


@quantity(unit=lambda number: CONSTANT_UNITS[number])
def film_constant(
    number: Literal["separation", "decay", "exponent", "initial_resistance", "contact_resistance", "creep_rate"],
    composite: FilmComposite = LITERAL,
    force: Force = 1.0,
) -> float:
    """In SI: s0, gamma, gamma s0, R0, both contacts' resistance at a force, or the rate E1 / mu1 of the creep at a force.

    Parameters
    ----------
    number : which of them
    force : force on the reference area, where the number depends on it
    """
    numbers: dict[str, Callable[[], float]] = {
        "separation": lambda: composite.separation,
        "decay": lambda: tunnelling_decay(composite.barrier),
        "exponent": lambda: composite.exponent,
        "initial_resistance": lambda: composite.initial_resistance,
        "contact_resistance": lambda: composite.contact_resistance / force**0.5,
        "creep_rate": lambda: composite.delayed.at(force) / composite.viscosity.at(force),
    }
    return float(numbers[number]())


@quantity(unit="ohm")
def film_resistance(
    *, composite: FilmComposite = IDENTIFIED, force: Force, time: Time, reading: Reading | Literal["history"] = "history"
) -> float:
    """Resistance in ohm of a film under a constant force, in a reading of eq. 2.3.1.

    Parameters
    ----------
    force : constant force on the reference area
    time : time since it began
    reading : printed or corrected equation; ``history`` integrates the creep law
    """
    if reading != "history":
        return float(resistance_of(composite, force, time, reading=reading))
    times = [time * k / HISTORY_STEPS for k in range(HISTORY_STEPS + 1)]
    return float(1 / Film(composite=composite).conductance(times, [force] * len(times))[-1])


@quantity(unit="1")
def film_sensitivity(
    number: Literal["exponent", "line_error", "printed_excess"], composite: FilmComposite = LITERAL, force: Force = 1.0
) -> float:
    """How a film departs from an ideal one, dimensionless.

    ``exponent`` is d ln C / d ln F; ``line_error`` the largest relative error of the resistance against the line of 3.1.2 from
    0.5 to 5 N; ``printed_excess`` how much more 2.1.14 with varying coefficients strains at once than 2.3.1.

    Parameters
    ----------
    number : which of them
    force : constant force on the reference area
    """
    film = Film(composite=composite)
    if number == "exponent":
        return float(film.sensitivity([0.0], [force])[0] * force / film.conductance([0.0], [force])[0])
    if number == "line_error":
        return float(np.abs(identify_film(composite, THESIS_LINE).errors).max())
    return float(varying_coefficient_jump(composite, force) / creep_strain(composite, force, 0.0) - 1)


@quantity(unit="ohm")
def calibrated_resistance(force: NonNegative[Force]) -> float:
    """Resistance 1/C in ohm of the sensor of 3.1.2 by its calibration line F = 20.94 C - 0.132.

    Parameters
    ----------
    force : force on the sensor
    """
    return float(1 / THESIS_LINE.conductance(force))


@quantity(unit=lambda constant: "N/S" if constant == "slope" else "N")
def recovered_line(
    constant: Literal["slope", "offset"],
    largest_force: Positive[Force] = 25.0,
    points: Annotated[int, Field(ge=3, le=10_000)] = 26,
) -> float:
    """Slope 1/m in N/S or offset -n/m in N of F over C, as a calibration by noiseless converted voltages finds them.

    Parameters
    ----------
    constant : which of them
    largest_force : the forces go evenly from 0 to this one
    points : number of forces
    """
    chain, force = SignalChain(low_pass=None), np.linspace(0.0, largest_force, points)
    voltage = chain.acquire(THESIS_LINE.conductance(force)).voltage
    fit = fit_calibration_line(force, voltage, supply=chain.supply, load=chain.load_resistor)
    return float(1 / fit.slope if constant == "slope" else -fit.intercept / fit.slope)


def _can_be_sampled(cutoff: float, order: int, sampling_rate: float | None) -> None:
    if sampling_rate is not None:
        LowPass(cutoff=cutoff, order=order).check(sampling_rate)


@quantity(unit="1", check=_can_be_sampled)
def filter_transfer(
    cutoff: Positive[Frequency],
    order: Annotated[int, Field(ge=1, le=8)] = 1,
    frequency: Positive[Frequency] = 60.0,
    sampling_rate: Positive[Frequency] | None = None,
) -> float:
    """Amplitude out over in of a Butterworth low pass, dimensionless.

    Parameters
    ----------
    cutoff, order : of the filter
    frequency : of the pick-up
    sampling_rate : of the digital filter; null is the analog one

    Raises
    ------
    InvalidQuantity
        If the filter cannot be sampled at this rate.
    """
    return float(LowPass(cutoff=cutoff, order=order).gain(np.array(frequency), sampling_rate))


@quantity(unit="N")
def full_scale_error(part: Annotated[float, Field(gt=-1, lt=1)], full_scale: Positive[Force]) -> float:
    """Force in N that an accuracy in parts of the full scale stands for.

    Parameters
    ----------
    part : part of the full scale, dimensionless
    full_scale : end of the range of force
    """
    return part * full_scale


@quantity(unit="N/m")
def stiffness_resolution(force: Force, displacement: Length) -> float:
    """Stiffness in N/m that a force resolution stands for.

    Parameters
    ----------
    force : smallest force that can be distinguished
    displacement : displacement of the tissue
    """
    return force / displacement


@quantity(unit="N")
def converter_force_step(force: Positive[Force]) -> float:
    """Force in N that a step of the converter stands for at a force, by the line of 3.1.2 and the electronics by default.

    Parameters
    ----------
    force : force on the sensor
    """
    conductance = np.array(THESIS_LINE.conductance(force))
    step = float(SignalChain(low_pass=None).conductance_step(conductance))
    return float(THESIS_LINE.force(conductance + step) - THESIS_LINE.force(conductance))
