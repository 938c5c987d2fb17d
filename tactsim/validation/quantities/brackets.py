"""How far the simulations of a table span: brackets of a quantity, the run at their lower end, spreads, and their figure."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from tactsim.errors import InputError
from tactsim.interfaces import drawing, quantity
from tactsim.model import FrozenModel
from tactsim.units import parse_quantity
from tactsim.validation.curves import Data, Title
from tactsim.validation.inputs import Inputs, RunName, StudyName
from tactsim.validation.limits import Interval
from tactsim.validation.study import RunOutcome

Area = Literal["annulus", "disc", "both"]
Studies = Annotated[tuple[str, ...], Field(min_length=1, description="Studies of the table that are looked at together.")]
Pressed = Literal["threshold_pressure", "threshold_displacement"]
UNITS: dict[Pressed, str] = {"threshold_pressure": "Pa", "threshold_displacement": "m"}


def _readings(outcome: RunOutcome, quantity: str, area: Area = "both") -> list[float]:
    """The quantity in SI; a pressure over the annulus, over the full disc, or both (erratum E16).

    Source: the annular area is what turns the pressures of Table 3.3 into its forces; "total area, on the larger sensor" in 3.2
    may mean the disc.
    """
    value = outcome.value(quantity)
    if quantity != "threshold_pressure":
        return [value]
    over_disc = value * outcome.disc_share
    return {"annulus": [value], "disc": [over_disc], "both": [over_disc, value]}[area]


def _converged(inputs: Inputs, studies: tuple[str, ...]) -> dict[tuple[str, str], RunOutcome]:
    """The runs that count, by study and name."""
    runs = {(study, outcome.id): outcome for study in studies for outcome in inputs.study(study) if outcome.converged}
    if not runs:
        raise InputError(f"no run of {', '.join(studies)} converged")
    return runs


@quantity(unit=lambda quantity: UNITS[quantity])
def bracket(inputs: Inputs, studies: Studies, quantity: Pressed, area: Area = "both") -> Interval:
    """The smallest and the largest simulated value, in Pa or m.

    Only runs that converged count. For ``threshold_pressure`` the interval spans the pressures over both areas of erratum E16.

    Parameters
    ----------
    quantity : quantity of the runs
    area : which area a pressure refers to

    Raises
    ------
    UnknownName, InputError
        If there is no such study, or no run converged.
    """
    values = [value for outcome in _converged(inputs, studies).values() for value in _readings(outcome, quantity, area)]
    return Interval(min(values), max(values))


@quantity(unit="Pa")
def lowest_pressure(inputs: Inputs, studies: Studies, study: StudyName, run: RunName, area: Literal["annulus", "disc"]) -> float:
    """Threshold pressure in Pa of the run that has the lowest one of several studies; only runs that converged count.

    Parameters
    ----------
    area : which area the pressure refers to (erratum E16)

    Raises
    ------
    UnknownName, InputError
        If there is no such study or run, the run did not converge, or another one is lower: the message names that.
    """
    named = inputs.converged(study, run)
    runs = _converged(inputs, studies)
    lowest = min(runs, key=lambda name: _readings(runs[name], "threshold_pressure", area)[0])
    if lowest != (study, run):
        raise InputError(f"the lowest threshold pressure is that of {', '.join(lowest)}, not of {study}, {run}")
    return _readings(named, "threshold_pressure", area)[0]


@quantity(unit="1")
def threshold_spread(
    inputs: Inputs, studies: Studies, study: StudyName, run: RunName, *, end: Literal["lowest", "highest"]
) -> float:
    """The lowest or the highest threshold pressure of several studies over that of one run, dimensionless.

    Parameters
    ----------
    end : which end of the spread

    Raises
    ------
    UnknownName, InputError
        If there is no such study or run, or the run did not converge.
    """
    values = bracket(inputs, studies, "threshold_pressure", "annulus")
    over = inputs.converged(study, run).value("threshold_pressure")
    return (values.low if end == "lowest" else values.high) / over


class PrintedLine(FrozenModel):
    """A printed number drawn across the runs of a study."""

    label: str
    """What it is."""
    value: str
    """The number with its unit."""


class Panel(FrozenModel):
    """The runs of some studies."""

    studies: Studies
    """Studies of the table, from top to bottom."""
    title: str
    """What it simulates."""
    printed: tuple[PrintedLine, ...]
    """Printed numbers to compare with."""


@drawing
def range_bars(inputs: Inputs, title: Title, panels: Annotated[tuple[Panel, ...], Field(min_length=1)]) -> Data:
    """Form ``ranges``: the threshold pressures in Pa of each run over both areas beside the printed numbers, as Table 3.2.

    A run that has not converged has no values.

    Parameters
    ----------
    panels : what is drawn from left to right

    Raises
    ------
    UnknownName
        If there is no such study.
    """

    def bar(outcome: RunOutcome) -> Data:
        return {"label": outcome.id, "values": _readings(outcome, "threshold_pressure") if outcome.converged else []}

    drawn = [
        {
            "title": compared.title,
            "bars": [bar(outcome) for study in compared.studies for outcome in inputs.study(study)],
            "groups": [len(inputs.study(study)) for study in compared.studies],
            "lines": [{"label": line.label, "value": parse_quantity(line.value, "Pa")} for line in compared.printed],
        }
        for compared in panels
    ]
    return {"form": "ranges", "title": title, "axis": "threshold pressure", "unit": "Pa", "panels": drawn}
