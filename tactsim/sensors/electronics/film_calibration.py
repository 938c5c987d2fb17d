"""The straight line that a film itself gives, when it is calibrated with constant forces."""

from __future__ import annotations

import numpy as np

from tactsim.array import Array
from tactsim.errors import InvalidQuantity
from tactsim.interfaces import SensorFilm
from tactsim.sensors.electronics.calibration import LinearCalibration

READ_AFTER = 1.0
"""Time in s from the beginning of a constant force to its reading: thesis, section 2.2.1."""
LINE_POINTS = 91
"""Constant forces of a line, evenly spaced between two bounds."""


def film_line(film: SensorFilm, forces: tuple[float, float]) -> LinearCalibration:
    """Least-squares line C = m F + n through conductances read ``READ_AFTER`` constant forces, in N, between two bounds began.

    Raises
    ------
    InvalidQuantity
        If the bounds are not 0 <= low < high, or the film cannot bear such forces.
    """
    if not 0 <= forces[0] < forces[1]:
        raise InvalidQuantity(f"forces of the calibration are {forces} N; allowed: 0 <= low < high")
    applied = np.linspace(*forces, LINE_POINTS)
    try:
        conductance = read_under(film, applied)
    except InvalidQuantity as error:
        raise InvalidQuantity(f"calibration_forces up to {forces[1]:g} N: {error}") from None
    return least_squares_line(applied, conductance)


def read_under(film: SensorFilm, forces: Array, delay: float = READ_AFTER) -> Array:
    """Signal (n,) of a film at rest, such as its conductance in S, a ``delay`` in s after constant forces (n,) in N began."""
    return film.read([0.0, delay], np.tile(forces, (2, 1)))[-1]


def least_squares_line(force: Array, conductance: Array) -> LinearCalibration:
    """The line through conductances (n,) in S over forces (n,) in N; they must rise on the whole."""
    slope, intercept = slope_and_intercept(force, conductance)
    return LinearCalibration(slope=slope, intercept=intercept)


def slope_and_intercept(x: Array, y: Array) -> tuple[float, float]:
    """Of the least-squares line through values ``y`` (n,) over ``x`` (n,).

    In closed form, as ``scipy.stats`` takes longer to load than a film to read.
    """
    away = x - x.mean()
    slope = float(away @ (y - y.mean()) / (away @ away))
    return slope, float(y.mean() - slope * x.mean())
