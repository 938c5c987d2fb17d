"""What line and creep of the thesis's film allow together: error of the line, drift, and a fit of both; 2.3 and 3.1.2."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.identification.film_joint import JointFilm, changed, identify_film_jointly
from tactsim.identification.film_line import ACCURATE_FORCES, identify_film
from tactsim.interfaces import drawing, quantity
from tactsim.sensors.electronics.calibration import THESIS_LINE
from tactsim.sensors.electronics.film_calibration import LINE_POINTS, READ_AFTER, read_under
from tactsim.sensors.films.film import Film
from tactsim.units import Force, NonNegative, Positive, Time
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.quantities.film import IDENTIFIED, LITERAL, FilmComposite

JOINT_UNITS = {"barrier": "J", "initial_resistance": "ohm", "contact_resistance": "ohm"}


@quantity(unit="1")
def film_drift(
    composite: FilmComposite = IDENTIFIED,
    force: Positive[Force] = 1.0,
    duration: Positive[Time] = 60.0,
    since: NonNegative[Time] = 0.0,
) -> float:
    """Relative growth of the conductance under a constant force, dimensionless.

    Parameters
    ----------
    force : constant force on the reference area
    duration : how long it grows
    since : time after the force began from which the growth counts; the thesis calibrates at 1 s
    """
    film = Film(composite=composite)
    times = [0.0, since, since + duration] if since else [0.0, duration]
    first, last = film.conductance(times, [force] * len(times))[-2:]
    return float(last / first - 1)


@quantity(unit="1")
def film_line_error(
    end: Literal["most", "least"],
    composite: FilmComposite = IDENTIFIED,
    forces: tuple[Positive[Force], Positive[Force]] = ACCURATE_FORCES,
    full_scale: Positive[Force] = 5.0,
    delay: Positive[Time] = READ_AFTER,
) -> float:
    """Force that the line of 3.1.2 reads from a film, less the true one, in parts of the full scale; dimensionless.

    Parameters
    ----------
    end : largest or smallest over the range
    forces : range of the constant forces
    full_scale : force that the error is divided by
    delay : time after the force was applied at which it is read
    """
    applied = np.linspace(*forces, LINE_POINTS)
    conductance = read_under(Film(composite=composite), applied, delay)
    errors = (THESIS_LINE.force(conductance) - applied) / full_scale
    return float(errors.max() if end == "most" else errors.min())


@quantity(unit=lambda number: JOINT_UNITS.get(number, "1"))
def joint_film(
    number: Literal["line_error", "drift", "creep_change", "exponent", "barrier", "initial_resistance", "contact_resistance"],
    creep_weight: NonNegative[float] | None = None,
    force: Positive[Force] = 1.0,
) -> float:
    """In SI, of the film that is fitted to the line of 3.1.2 and to the creep of 2.3.1 together.

    ``line_error`` is the largest relative error of the resistance against the line from 0.5 to 5 N; ``drift`` the relative growth
    of the conductance in a minute; ``creep_change`` the largest factor, less one, by which E0, E1 or mu1 differs from its printed
    line at 2 to 8 N; the others are fitted constants.

    Parameters
    ----------
    number : which of them
    creep_weight : weight of the creep against the line; null keeps the creep as printed
    force : force of the drift
    """
    joint = _jointly(creep_weight)
    if number == "line_error":
        return float(np.abs(joint.errors).max())
    if number == "creep_change":
        return float(np.abs(joint.creep_changes).max())
    return film_drift(joint.composite, force) if number == "drift" else float(getattr(joint.composite, number))


@cache
def _jointly(creep_weight: float | None) -> JointFilm:
    """The fit, of which the rows of a table ask for several numbers."""
    return identify_film_jointly(LITERAL, THESIS_LINE, creep_weight=creep_weight)


@drawing
def film_line_and_drift(
    title: Title,
    exponents: Annotated[tuple[Positive[float], ...], Field(min_length=2)] = (110, 130, 150, 170, 190, 210, 230, 254),
) -> Data:
    """Error of the reading by the line of 3.1.2 and drift in a minute over gamma s0, the creep as printed, R0 and R_1 fitted.

    Parameters
    ----------
    exponents : values of gamma s0, set by the barrier
    """
    fits = []
    for exponent in exponents:
        composite = changed(LITERAL, np.log([exponent / LITERAL.exponent]))
        fit = identify_film(composite, THESIS_LINE)
        resistances = {"initial_resistance": fit.initial_resistance, "contact_resistance": fit.contact_resistance}
        fits.append(composite.model_copy(update=resistances))
    ends: tuple[Literal["most"], Literal["least"]] = ("most", "least")
    x = np.array(exponents, dtype=float)
    errors = [
        series(
            "largest error" if end == "most" else "least error", x, np.array([100 * film_line_error(end, fit) for fit in fits])
        )
        for end in ends
    ]
    drifts = [
        series(f"growth at {force:g} N", x, np.array([100 * film_drift(fit, force) for fit in fits])) for force in (1.0, 5.0)
    ]
    panels = [panel("error of the reading, % of 5 N", "", errors), panel("growth of C in a minute, %", "", drifts)]
    return curves_figure(title, "gamma s0", "", panels, even_panels=True)
