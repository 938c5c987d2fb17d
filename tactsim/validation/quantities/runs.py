"""What the simulations of a table's studies give: quantities, ratios, counts, and how far the closed forms carry."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.analytic.annular_punch import solve_annular_punch
from tactsim.array import Array
from tactsim.errors import InputError, UnknownName
from tactsim.interfaces import drawing, quantity
from tactsim.materials.any_material import AnyMaterial
from tactsim.model import FrozenModel
from tactsim.units import Length, Positive
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.inputs import Inputs, RunName, StudyName
from tactsim.validation.quantities.annulus import OUTER_RADIUS
from tactsim.validation.study import RunOutcome

StudyAndRun = tuple[str, str]
"""Study and run."""
ClosedForm = Literal["half_space", "layer"]


def _value(inputs: Inputs, run: StudyAndRun, quantity: str) -> float:
    """A quantity of a run in SI."""
    return inputs.run(*run).value(quantity)


@quantity(unit=lambda si_unit: si_unit)
def run_quantity(inputs: Inputs, study: StudyName, run: RunName, quantity: str, si_unit: str = "1") -> float:
    """A quantity of a simulation in SI.

    Parameters
    ----------
    quantity : name of the quantity
    si_unit : SI unit of the quantity

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or has no such quantity.
    """
    return _value(inputs, (study, run), quantity)


@drawing
def run_history(
    inputs: Inputs, title: Title, study: StudyName, run: RunName, curves: dict[str, str], *, y_axis: str, si_unit: str
) -> Data:
    """Values of a simulation over its time.

    Parameters
    ----------
    curves : name of the history value by what it is called in the figure
    y_axis : what they are
    si_unit : their SI unit

    Raises
    ------
    UnknownName, InputError
        If there is no such run or no such value, or the run did not converge.
    """
    history = inputs.converged(study, run).history
    for name in ("time", *curves.values()):
        if name not in history:
            raise UnknownName(f"history value of {study}, {run}", name, history)
    time = np.array(history["time"])
    drawn = [series(words, time, np.array(history[name])) for words, name in curves.items()]
    return curves_figure(title, "time", "s", [panel(y_axis, si_unit, drawn)])


@quantity(unit="1")
def run_ratio(inputs: Inputs, run: StudyAndRun, over: StudyAndRun, quantity: str = "threshold_pressure") -> float:
    """A quantity of a simulation over that of another, dimensionless.

    Parameters
    ----------
    run, over : study and run of the numerator and of the denominator
    quantity : name of the quantity

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or one did not converge or has no such quantity.
    """
    return _value(inputs, run, quantity) / _value(inputs, over, quantity)


@quantity(unit="1")
def converged_runs(inputs: Inputs, study: StudyName) -> float:
    """Number of runs of a study that converged: a bracket must not become narrower unnoticed.

    Raises
    ------
    UnknownName
        If there is no such study.
    """
    return float(sum(outcome.converged for outcome in inputs.study(study)))


class ComparedRun(FrozenModel):
    """A simulation of an annulus pressed into an elastic layer, and what a closed form must know of it."""

    run: str
    """Run of the study."""
    material: AnyMaterial
    """Material of the layer."""
    thickness: Positive[Length]
    """Thickness of the layer on its fixed base."""
    inner_radius: Positive[Length] = 1.5e-3
    """Inner radius of the annulus."""
    outer_radius: Positive[Length] = OUTER_RADIUS
    """Outer radius of the annulus."""

    def departure(self, outcome: RunOutcome, form: ClosedForm) -> tuple[Array, Array]:
        """Displacement over the outer radius, and force over that of the closed form minus one, (n,) at the accepted steps.

        Raises
        ------
        InputError
            If the run has no history.
        """
        if not outcome.history:
            raise InputError(f"{self.run} has no history: {outcome.reason}")
        depth = np.array(outcome.history["displacement"]) / self.outer_radius
        slenderness = self.outer_radius / self.thickness if form == "layer" else 0.0
        solved = solve_annular_punch(self.inner_radius / self.outer_radius, radius_over_thickness=slenderness)
        stiffness = 8 * self.material.shear_modulus * self.outer_radius**2 * solved.force_factor
        return depth, np.array(outcome.history["reaction_force"]) / (stiffness * depth) - 1


@quantity(unit="1")
def closed_form_depth(
    inputs: Inputs, study: StudyName, compared: ComparedRun, form: ClosedForm = "layer", part: Positive[float] = 0.1
) -> float:
    """Displacement over the outer radius from which on force and closed form differ by more than a part.

    Zero if they differ from the beginning, the largest displacement if they never do.

    Parameters
    ----------
    compared : the simulation
    form : closed form
    part : relative difference of the force

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it has no history.
    """
    depth, departure = compared.departure(inputs.run(study, compared.run), form)
    difference = np.abs(departure)
    beyond = np.flatnonzero(difference > part)
    if not beyond.size:
        return float(depth[-1])
    first = int(beyond[0])
    if first == 0:
        return 0.0
    return float(np.interp(part, difference[first - 1 : first + 1], depth[first - 1 : first + 1]))


@drawing
def closed_form_limits(
    inputs: Inputs, title: Title, study: StudyName, runs: Annotated[tuple[ComparedRun, ...], Field(min_length=1)]
) -> Data:
    """Force of the simulations over that of both closed forms, over displacement over outer radius; all dimensionless.

    Parameters
    ----------
    runs : the simulations

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or one has no history.
    """
    panels = []
    forms: tuple[tuple[ClosedForm, str], ...] = (("layer", "layer"), ("half_space", "half-space"))
    for form, words in forms:
        departures = {run.run: run.departure(inputs.run(study, run.run), form) for run in runs}
        curves = [series(name, depth, 1 + departure) for name, (depth, departure) in departures.items()]
        panels.append(panel(f"force over the closed form of the {words}", "", curves, logarithmic=True))
    return curves_figure(title, "displacement over the outer radius", "", panels, x_logarithmic=True, even_panels=True)
