"""The annular threshold sensor of chapter 3: its area, its threshold, its recess and the specimens that it accepts."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import scipy
from pydantic import Field

from tactsim.analytic.annular_area import annular_area as area_of_annulus
from tactsim.array import Array
from tactsim.errors import CaseError, InputError
from tactsim.experiments.threshold.source import CurveSource
from tactsim.interfaces import drawing, quantity
from tactsim.interfaces.run import returned_by
from tactsim.units import Force, Length, Positive, Pressure, format_quantity
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.inputs import Inputs, RunName, StudyName

InnerRadius = Annotated[Length, Field(description="Radius of the hole.")]
OuterRadius = Annotated[Length, Field(description="Radius of the face.")]


@quantity(unit="m^2")
def annular_area(*, inner_radius: InnerRadius = 0.0, outer_radius: OuterRadius) -> float:
    """Area in m^2 of the sensor's face, pi (ro^2 - ri^2).

    Parameters
    ----------
    inner_radius : radius of the hole; zero for the full disc
    """
    return area_of_annulus(inner_radius, outer_radius)


@quantity(unit="N")
def threshold_force(pressure: Pressure, inner_radius: InnerRadius, outer_radius: OuterRadius) -> float:
    """Force in N that belongs to a printed threshold pressure on the annular area.

    Parameters
    ----------
    pressure : threshold pressure
    """
    return pressure * area_of_annulus(inner_radius, outer_radius)


@quantity(unit="1")
def threshold_at_level(
    inputs: Inputs, curve: str, level: Positive[Force], *, inner_radius: InnerRadius, outer_radius: OuterRadius, recess: Length
) -> float:
    """Force on the plate when the small sensor bears a level, over that at the touch; slowly, without noise and filter.

    Dimensionless, 1 for a sensor that triggers at the touch.

    Parameters
    ----------
    curve : stored forces of both sensors, relative to the table
    level : force on the small sensor at which it triggers
    recess : depth of the small sensor

    Raises
    ------
    InputError
        If the curve ends below the level.
    """
    path = str(inputs.folder / curve)
    source = CurveSource(path=path, inner_radius=inner_radius, outer_radius=outer_radius, recess=recess)
    approach = returned_by(source.tissue()).approach(1e-3)

    def beyond(time: float) -> float:
        return float(approach.at(np.array(time))[1]) - level

    if beyond(approach.duration) < 0:
        raise InputError(f"{curve}: the small sensor never bears {format_quantity(level, 'N')}")
    plate = approach.at(np.array(scipy.optimize.brentq(beyond, approach.touch, approach.duration)))[0]
    return float(plate) / approach.threshold_force


@quantity(unit="m")
def least_thickness(
    inputs: Inputs,
    case: str,
    between: tuple[Positive[Length], Positive[Length]],
    bisections: Annotated[int, Field(ge=1, le=60)] = 24,
) -> float:
    """Thickness in m of a specimen below which a case is refused, by bisection: every thicker one is accepted.

    Parameters
    ----------
    case : case file, relative to the table
    between : a thickness that is refused and one that is accepted
    bisections : how often the interval is halved

    Raises
    ------
    CaseError
        If the first thickness is accepted or the second refused.
    """
    refused, accepted = between
    for end, wanted in ((refused, False), (accepted, True)):
        if _accepts(inputs, case, end) != wanted:
            raise CaseError(f"{case}: a thickness of {end:g} m is {'refused' if wanted else 'accepted'}")
    for _ in range(bisections):
        middle = (refused + accepted) / 2
        refused, accepted = (refused, middle) if _accepts(inputs, case, middle) else (middle, accepted)
    return accepted


def _accepts(inputs: Inputs, case: str, thickness: float) -> bool:
    """Whether the case is valid with this thickness, and a displacement of half of it."""
    from tactsim.case import load_case

    overrides = {"specimen.thickness": thickness, "displacement": thickness / 2}
    try:
        load_case(inputs.folder / case, [f"experiment.{key}={value!r} m" for key, value in overrides.items()])
    except CaseError:
        return False
    return True


@quantity(unit="1")
def equal_force_ratio(
    inputs: Inputs, study: StudyName, run: RunName, recess: Positive[Length], hardness: Annotated[float, Field(gt=1)]
) -> float:
    """A/L for a harder tissue over A/L for the simulated one, so that both have the same threshold force; dimensionless.

    All forces scale with the modulus, so the force of the history of one run, times the hardness, is that of the harder tissue
    at every smaller recess.

    Parameters
    ----------
    recess : recess L for the simulated tissue
    hardness : modulus of the harder tissue over that of the simulated one

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or the tissue of the run does not rise as far as the recess.
    """
    rise, force = _rise_and_force(inputs, study, run)
    if rise.size < 2 or rise.max() < recess * (1 - 1e-4):
        raise InputError(f"{study}, {run} does not reach a rise of {recess:g} m")
    rising = rise[: rise.argmax() + 1]
    threshold = np.interp(recess, rising, force[: rising.size])
    shallower = np.interp(threshold / hardness, force[: rising.size], rising)
    return float(recess / shallower)


@drawing
def recess_over_hardness(
    inputs: Inputs,
    title: Title,
    study: StudyName,
    run: RunName,
    *,
    tissue: str,
    hole: Positive[Length],
    shallowest: Positive[Length],
    hardness: Annotated[tuple[float, ...], Field(min_length=1)],
) -> Data:
    """Threshold force in N over A/L: a single run gives every smaller recess, and the force scales with the modulus.

    Parameters
    ----------
    tissue : what the run simulates
    hole : inner diameter A of the annulus
    shallowest : smallest recess that is drawn
    hardness : moduli over that of the simulated tissue

    Raises
    ------
    UnknownName
        If there is no such run.
    """
    rise, force = _rise_and_force(inputs, study, run)
    shown = rise >= shallowest
    curves = [series(f"{tissue}, modulus x {factor:g}", hole / rise[shown], factor * force[shown]) for factor in hardness]
    return curves_figure(title, "A/L", "", [panel("threshold force", "N", curves, logarithmic=True)])


def _rise_and_force(inputs: Inputs, study: str, run: str) -> tuple[Array, Array]:
    """Heights in m of the tissue in the hole and forces in N on the annulus at the steps of a run, empty without any."""
    history = inputs.run(study, run).history
    rise, force = (np.array(history.get(name, ())) for name in ("tissue_rise", "reaction_force"))
    return rise, force
