"""Initial resistance and contact resistance of a composite from a measured straight line of conductance over force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.sensors.electronics.calibration import LinearCalibration
from tactsim.sensors.electronics.film_calibration import LINE_POINTS, READ_AFTER, read_under
from tactsim.sensors.films.composite import Composite
from tactsim.sensors.films.film import Film

ACCURATE_FORCES = (0.5, 5.0)
"""Range in N in which the thesis (7.1) wants accuracy."""


@dataclass(frozen=True)
class FilmLine:
    """A composite identified to a line: resistances in ohm, forces (n,) in N and relative errors (n,) of the resistance."""

    initial_resistance: float
    contact_resistance: float
    forces: Array
    errors: Array


def identify_film(
    composite: Composite,
    line: LinearCalibration,
    *,
    forces: tuple[float, float] = ACCURATE_FORCES,
) -> FilmLine:
    r"""Resistances R0 and R_1 with the least squares of relative errors of the resistance at evenly spaced forces.

    .. math:: \frac{R_1}{\sqrt{F}} + R_0 (1 - \varepsilon) e^{-\gamma s_0 \varepsilon} = \frac{1}{m F + n}

    Parameters
    ----------
    composite : Composite
        Gives filler and creep; its resistances are not used.
    line : LinearCalibration
        The conductance C = m F + n.
    forces : (float, float)
        Range in N.

    Raises
    ------
    InvalidQuantity
        If the line or the range is not positive, or one of the resistances comes out as zero.

    Source: errata E28; thesis, eqs. 2.1.17 and 2.2.1.
    """
    projection = projected_on_line(composite, line, forces)
    initial, touching = projection.resistances
    if min(initial, touching) <= 0:
        raise InvalidQuantity(f"the line {line} gives resistances {initial:g} and {touching:g} ohm; both must be positive")
    return FilmLine(float(initial), float(touching), projection.forces, projection.errors)


@dataclass(frozen=True, eq=False)
class LineProjection:
    """Resistances (2,) in ohm, zero or above, of film and contacts that fit a line best, with forces (n,) in N, errors (n,)."""

    resistances: Array
    forces: Array
    errors: Array


def projected_on_line(composite: Composite, line: LinearCalibration, forces: tuple[float, float]) -> LineProjection:
    """The resistances of ``identify_film``, which may be zero; its arguments.

    Raises
    ------
    InvalidQuantity
        If the line or the range is not positive.
    """
    applied = np.linspace(*forces, LINE_POINTS)
    measured = line.slope * applied + line.intercept
    if not (0 < forces[0] < forces[1] and np.all(measured > 0)):
        raise InvalidQuantity(f"line {line} in SI over {forces} N at {READ_AFTER} s; allowed: rising forces, C > 0")
    # With both resistances at 1 ohm the film's resistance is R_pol / R0 + 1 / sqrt(F).
    unit = Film(composite=composite.model_copy(update={"initial_resistance": 1.0, "contact_resistance": 1.0}))
    contact = 1 / np.sqrt(applied)
    relative = 1 / read_under(unit, applied) - contact
    columns = np.column_stack([relative, contact]) * measured[:, None]
    resistances, _ = scipy.optimize.nnls(columns, np.ones(LINE_POINTS))
    return LineProjection(resistances, applied, columns @ resistances - 1)
