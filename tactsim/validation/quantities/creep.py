"""The film under a constant force: strain, coefficients over the force, resistance; thesis section 2.3."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.interfaces import drawing, quantity
from tactsim.sensors.films.composite_library import named_composite
from tactsim.sensors.films.film_equations import creep_strain
from tactsim.sensors.films.film_equations import film_resistance as resistance_of
from tactsim.sensors.films.tunnelling import relative_resistance
from tactsim.units import Force, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.quantities.film import IDENTIFIED, LITERAL, FilmComposite

COEFFICIENT_UNITS = {"instantaneous": "Pa", "delayed": "Pa", "viscosity": "Pa*s", "creep_time": "s"}
POINTS = 120
"""Points of a curve."""
FIRST_FORCE = 0.25
"""N, where the curves over the force begin: at 0 N the contact resistance is infinite."""


@quantity(unit=lambda coefficient: COEFFICIENT_UNITS[coefficient])
def creep_coefficient(
    coefficient: Literal["instantaneous", "delayed", "viscosity", "creep_time"],
    force: NonNegative[Force],
    composite: FilmComposite = LITERAL,
) -> float:
    """A coefficient of the standard linear solid at a force: E0 or E1 in Pa, mu1 in Pa s, or the time mu1 / E1 in s.

    Parameters
    ----------
    coefficient : which of them
    force : constant force on the reference area
    """
    if coefficient == "creep_time":
        return float(composite.viscosity.at(force) / composite.delayed.at(force))
    return float(getattr(composite, coefficient).at(force))


@quantity(unit="1")
def film_strain(force: Positive[Force], time: NonNegative[Time] = 1.0, composite: FilmComposite = LITERAL) -> float:
    """Strain of a film under a constant force, eq. 2.1.15 with E1 corrected, dimensionless.

    Parameters
    ----------
    force : constant force on the reference area
    time : time since it began
    """
    return float(creep_strain(composite, force, time))


@quantity(unit="1")
def film_relative_resistance(
    composite: FilmComposite = LITERAL, strain: Annotated[float, Field(ge=0, lt=1)] = 0.0, slope: bool = False
) -> float:
    """Resistance over that without strain, eq. 2.1.9, or its slope over the strain; dimensionless.

    Parameters
    ----------
    strain : compressive strain
    slope : whether the derivative is asked for, by central differences
    """
    if not slope:
        return float(relative_resistance(strain, composite.exponent))
    step = 1e-4 / composite.exponent  # the third derivative makes an error of step^2 gamma^3 s0^3 / 6, a part in 1e9
    ends = relative_resistance([strain - step, strain + step], composite.exponent)
    return float((ends[1] - ends[0]) / (2 * step))


@quantity(unit="1")
def contact_share(force: Positive[Force], time: NonNegative[Time] = 1.0, composite: FilmComposite = IDENTIFIED) -> float:
    """Part of the resistance that the contacts have under a constant force, dimensionless.

    Parameters
    ----------
    force : constant force on the reference area
    time : time since it began
    """
    contact = composite.contact_resistance / np.sqrt(force)
    return float(contact / resistance_of(composite, force, time))


FILM_LABELS = {
    "lingstat_literal": "Table 2.1 literally",
    "lingstat_identified": "identified to the line of 3.1.2",
    "lingstat_joint": "fitted to line and creep",
}
"""What figures call the shipped composites of Lingstat."""
SMALL = 1e-3
"""Relative change below which it is drawn in parts per million."""


@drawing
def film_curves(
    title: Title,
    over: Literal["force", "time"],
    composites: tuple[str, ...] = ("lingstat_literal", "lingstat_identified"),
    forces: tuple[Positive[Force], ...] = (2.0, 5.0, 8.0),
    largest: Positive[float] = 5.0,
) -> Data:
    """Resistance of films 1 s after a force over the force, or its relative change over the time at several forces.

    Parameters
    ----------
    over : quantity of the horizontal axis
    composites : names of shipped composites
    forces : constant forces of the curves over time
    largest : end of the horizontal axis in N or s
    """
    if over == "force":
        x = np.linspace(FIRST_FORCE, largest, POINTS)
        curves = [
            series(FILM_LABELS.get(name, name), x, np.asarray(resistance_of(named_composite(name), x, 1.0)))
            for name in composites
        ]
        return curves_figure(title, "force", "N", [panel("resistance after 1 s", "ohm", curves, logarithmic=True)])
    x = np.linspace(0.0, largest, POINTS)
    panels = []
    for name in composites:
        resistances = [np.asarray(resistance_of(named_composite(name), force, x)) for force in forces]
        changes = [each / each[0] - 1 for each in resistances]
        parts, unit = (1e6, "ppm") if max(np.abs(change).max() for change in changes) < SMALL else (100, "%")
        curves = [series(f"{force:g} N", x, parts * change) for force, change in zip(forces, changes, strict=True)]
        panels.append(panel(f"change of R in {unit}, {FILM_LABELS.get(name, name)}", "", curves))
    return curves_figure(title, "time", "s", panels, even_panels=True)


@drawing
def film_surface(
    title: Title,
    composites: tuple[str, ...] = ("lingstat_literal", "lingstat_identified"),
    largest_force: Positive[Force] = 8.0,
    duration: Positive[Time] = 60.0,
) -> Data:
    """Form ``surfaces``: resistance of films in ohm over force and time, a panel each.

    Parameters
    ----------
    composites : names of shipped composites
    largest_force : end of the axis of force
    duration : end of the axis of time
    """
    force, time = np.linspace(FIRST_FORCE, largest_force, POINTS), np.linspace(0.0, duration, POINTS)
    panels = [
        {
            "title": FILM_LABELS.get(name, name),
            "z": [np.asarray(resistance_of(named_composite(name), each, time)).tolist() for each in force],
        }
        for name in composites
    ]
    axes = {
        "x": time.tolist(),
        "x_axis": "time in s",
        "y": force.tolist(),
        "y_axis": "force in N",
        "z_axis": "resistance",
        "unit": "ohm",
    }
    return {"form": "surfaces", "title": title, **axes, "panels": panels}
