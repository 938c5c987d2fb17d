"""All constants of a film that the thesis does not measure, fitted to its line of conductance and its creep together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from tactsim.array import Array
from tactsim.errors import ConvergenceError, InvalidQuantity
from tactsim.identification.film_line import ACCURATE_FORCES, projected_on_line
from tactsim.sensors.electronics.calibration import LinearCalibration
from tactsim.sensors.electronics.film_calibration import LINE_POINTS
from tactsim.sensors.films.composite import CREEP_COEFFICIENTS, Composite

CREEP_FORCES = (2.0, 4.0, 6.0, 8.0)
"""In N: forces of the creep tests, thesis section 2.3."""
STARTS, SPREAD = 8, 0.5
"""Starts of the search: the given constants, and those drawn around their logarithms with this standard deviation."""
REACH = 4.0
"""Largest change of the logarithm of a constant."""
EXACTLY = 1e-14
"""Relative change that ends the search: with 1e-10 and slopes by one-sided differences, constants of the creep moved by 1e-5 from
one processor to another."""


@dataclass(frozen=True, eq=False)
class JointFilm:
    """A composite fitted to a line and to creep together.

    ``errors`` (n,) of the resistance at ``forces`` (n,) in N against the line; ``creep_changes`` (3, 4), by which factor less one
    E0, E1 and mu1 differ at ``CREEP_FORCES`` from the given ones.
    """

    composite: Composite
    forces: Array
    errors: Array
    creep_changes: Array


def identify_film_jointly(
    composite: Composite,
    line: LinearCalibration,
    *,
    creep_weight: float | None = None,
    forces: tuple[float, float] = ACCURATE_FORCES,
) -> JointFilm:
    r"""R0, R_1 and the barrier, and on request the six constants of the creep, by least squares of line and creep together.

    .. math:: \overline{\left(R(F) (m F + n) - 1\right)^2} + w^2\, \overline{\ln^2 \frac{E(F_k)}{E'(F_k)}} \to \min

    The first mean is over evenly spaced forces, the second over E0, E1 and mu1 at the forces of the creep tests, E' as given.
    The resistances enter linearly and are eliminated by non-negative least squares at every step (variable projection).

    Parameters
    ----------
    composite : Composite
        Gives filler and creep, and the barrier to begin with; its resistances are not used.
    line : LinearCalibration
        The conductance C = m F + n.
    creep_weight : float, optional
        w >= 0; None keeps the creep as it is given.
    forces : (float, float)
        As in ``identify_film``.

    Raises
    ------
    InvalidQuantity
        If the line, the range or the weight is out of its range, or the best film has no contact resistance or none of its own.
    ConvergenceError
        If no start leads to a least.

    Source: errata E28; variable projection: Golub & Pereyra 1973, doi:10.1137/0710036.
    """
    if creep_weight is not None and not 0 <= creep_weight < np.inf:
        raise InvalidQuantity(f"creep_weight is {creep_weight}; allowed: finite and >= 0, or None for the creep as given")
    count = 1 if creep_weight is None else 1 + 2 * len(CREEP_COEFFICIENTS)

    def residuals(logarithms: Array) -> Array:
        film = changed(composite, logarithms)
        parts = [projected_on_line(film, line, forces).errors / np.sqrt(LINE_POINTS)]
        if creep_weight:
            creep = np.log1p(_creep_changes(composite, film))
            parts.append(creep_weight * creep.ravel() / np.sqrt(creep.size))
        return np.concatenate(parts)

    logarithms = _least(residuals, count)
    film = changed(composite, logarithms)
    projection = projected_on_line(film, line, forces)
    initial, contact = projection.resistances.tolist()
    if min(initial, contact) <= 0:
        raise InvalidQuantity(
            f"the line {line} with creep_weight {creep_weight} gives resistances {initial:g} and {contact:g} ohm; "
            "both must be positive: weigh the creep more"
        )
    fitted = film.model_copy(update={"initial_resistance": initial, "contact_resistance": contact})
    return JointFilm(fitted, projection.forces, projection.errors, _creep_changes(composite, film))


def changed(composite: Composite, logarithms: Array) -> Composite:
    """The composite with gamma s0, by the barrier, and if given its constants of creep times exp(``logarithms``), (1,), (7,)."""
    factors = np.exp(logarithms)
    update: dict[str, object] = {"barrier": composite.barrier * float(factors[0]) ** 2}
    for name, (slope, intercept) in zip(CREEP_COEFFICIENTS, factors[1:].reshape(-1, 2).tolist(), strict=False):
        line = getattr(composite, name)
        update[name] = line.model_copy(update={"slope": line.slope * slope, "intercept": line.intercept * intercept})
    return composite.model_copy(update=update)


def _creep_changes(given: Composite, film: Composite) -> Array:
    """By which factor less one E0, E1 and mu1 differ, shape (3, 4)."""
    forces = np.array(CREEP_FORCES)
    return np.array([getattr(film, name).at(forces) / getattr(given, name).at(forces) - 1 for name in CREEP_COEFFICIENTS])


def _least(residuals: object, count: int) -> Array:
    """Logarithms (count,) with the least sum of squares of several starts."""
    starts = SPREAD * np.random.default_rng(0).standard_normal((STARTS, count))
    starts[0] = 0.0
    exactly = {"jac": "3-point", "xtol": EXACTLY, "ftol": EXACTLY, "gtol": EXACTLY}
    fits = [scipy.optimize.least_squares(residuals, start, bounds=(-REACH, REACH), **exactly) for start in starts]
    fits = [fit for fit in fits if fit.success]
    if not fits:
        raise ConvergenceError("no film was fitted to line and creep together: no start of the search led to a least")
    return np.asarray(min(fits, key=lambda fit: fit.cost).x)
