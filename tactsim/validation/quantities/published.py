"""Figures of published problems: what was computed beside what others printed."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.errors import InputError
from tactsim.interfaces import drawing
from tactsim.model import FrozenModel
from tactsim.units import parse_quantity
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.inputs import Inputs, RunName, StudyName

RATIOS_DRAWN = 200
"""Points of an exact curve."""


class PrintedNumber(FrozenModel):
    """A number that others printed."""

    at: str
    """Where or when, with its unit."""
    quantity: str
    """The quantity that answers it."""
    value: str
    """The number with its unit."""


Printed = Annotated[tuple[PrintedNumber, ...], Field(min_length=1)]


def _points(printed: Printed, x_unit: str, unit: str) -> tuple[Array, Array]:
    """Places and numbers in SI."""
    return (
        np.array([parse_quantity(one.at, x_unit) for one in printed]),
        np.array([parse_quantity(one.value, unit) for one in printed]),
    )


@drawing
def printed_beside_quantities(
    inputs: Inputs,
    *,
    title: Title,
    study: StudyName,
    run: RunName,
    printed: Printed,
    x_axis: str,
    x_unit: str,
    y_axis: str,
    unit: str,
) -> Data:
    """Quantities of one simulation along a line, beside the printed numbers.

    Parameters
    ----------
    printed : the numbers, in the order in which they are drawn
    x_axis : what runs along the axis
    x_unit : SI unit of that
    y_axis : what is compared
    unit : SI unit of that

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or has no such quantity.
    """
    outcome = inputs.converged(study, run)
    x, y = _points(printed, x_unit, unit)
    computed = series("computed", x, np.array([outcome.value(one.quantity) for one in printed]))
    return curves_figure(title, x_axis, x_unit, [panel(y_axis, unit, [computed, series("printed", x, y, "points")])])


@drawing
def printed_beside_course(
    inputs: Inputs, *, title: Title, study: StudyName, run: RunName, recorded: str, printed: Printed, y_axis: str, unit: str
) -> Data:
    """What one simulation recorded over time, beside numbers at some times.

    Parameters
    ----------
    recorded : name of the value that every step recorded
    printed : the numbers
    y_axis : what is compared
    unit : SI unit of that

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or did not record this.
    """
    outcome = inputs.converged(study, run)
    if recorded not in outcome.history:
        raise InputError(f"{study}, {run} has recorded no {recorded}")
    time, value = np.array(outcome.history["time"]), np.array(outcome.history[recorded])
    curves = [series("computed", time[time > 0], value[time > 0]), series("expected", *_points(printed, "s", unit), "points")]
    return curves_figure(title, "time", "s", [panel(y_axis, unit, curves)], x_logarithmic=True)


@drawing
def bonded_disc_ratios(inputs: Inputs, title: Title, bonded: StudyName, smooth: StudyName) -> Data:
    """Force on a glued over that on a smooth disc on a half-space, exact and computed, over Poisson's ratio; dimensionless.

    The runs of both studies go by Poisson's ratio. Exact: (1 - nu) ln(3 - 4 nu) / (1 - 2 nu) (Mossakovskii 1954; Spence 1968,
    doi:10.1098/rspa.1968.0105).

    Raises
    ------
    UnknownName, InputError
        If a run is missing, or did not converge.
    """
    names = [outcome.id for outcome in inputs.study(bonded)]
    forces = {study: np.array([inputs.converged(study, name).value("force") for name in names]) for study in (bonded, smooth)}
    nu = np.linspace(0, 0.4999, RATIOS_DRAWN)
    exact = (1 - nu) * np.log(3 - 4 * nu) / (1 - 2 * nu)
    computed = series("computed", np.array([float(name) for name in names]), forces[bonded] / forces[smooth], "points")
    return curves_figure(title, "Poisson's ratio", "", [panel("glued over smooth", "", [series("exact", nu, exact), computed])])
