"""The seven elastomers of Table 3.3, ranked by sensor, durometer and hand: thesis, section 3.2."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from tactsim.analytic.durometer import DurometerScale, hertz_modulus
from tactsim.contact.rod import Rod
from tactsim.errors import InputError, UnknownName
from tactsim.experiments.durometer.elastomer_report import RankingReport
from tactsim.interfaces import quantity
from tactsim.validation.inputs import Inputs, RunName, StudyName

Measurements = Annotated[tuple[float, ...], Field(min_length=2)]
SCALE, INDENTOR = DurometerScale(), Rod()
"""The durometer of type OO."""


@quantity(unit="1")
def ranking_agreement(first: Measurements, second: Measurements) -> float:
    r"""Kendall's rank correlation, dimensionless, from -1 to 1; 1 if every pair is ordered alike.

    .. math:: \tau = \frac{2}{n (n - 1)} \sum_{i < j} \mathrm{sgn}(x_i - x_j)\, \mathrm{sgn}(y_i - y_j)

    Parameters
    ----------
    first, second : two measurements of each thing, in the same order

    Raises
    ------
    InputError
        If there is not the same number of both.

    Source: Kendall 1938, doi:10.1093/biomet/30.1-2.81.
    """
    if len(first) != len(second):
        raise InputError(f"{len(first)} numbers cannot be ranked against {len(second)}")
    alike = np.sign(np.subtract.outer(first, first)) * np.sign(np.subtract.outer(second, second))
    return float(alike.sum() / (len(first) * (len(first) - 1)))


@quantity(unit="Pa")
def hertz_durometer_modulus(reading: float, scale: DurometerScale = SCALE, indentor: Rod = INDENTOR) -> float:
    """Young's modulus in Pa of the incompressible half-space on which Hertz's sphere under the spring gives a Shore reading.

    Parameters
    ----------
    reading : Shore reading
    scale : travel and spring
    indentor : the indentor, of which the end counts

    Raises
    ------
    InvalidQuantity
        If no modulus gives the reading.
    """
    return hertz_modulus(reading, scale, indentor.radius)


@quantity(unit=lambda quantity: RankingReport.UNITS.get(quantity, "1"))
def elastomer_value(
    inputs: Inputs,
    study: StudyName,
    run: RunName,
    shape: Annotated[int, Field(ge=1)],
    elastomer: Annotated[int, Field(ge=1)],
    *,
    quantity: str = "predicted_reading",
) -> float:
    """What a simulated ranking has for one elastomer, in SI.

    Parameters
    ----------
    shape : shape of the energy, counted from 1 in the order of the case
    elastomer : elastomer, counted from 1 in the order of Table 3.3
    quantity : name in the history

    Raises
    ------
    UnknownName, InputError
        If there is no such run or name, or the run did not converge or has no such elastomer.
    """
    history = inputs.converged(study, run).history
    if quantity not in history:
        raise UnknownName(f"history value of {study}, {run}", quantity, history)
    shapes, elastomers = (np.array(history[name]) for name in ("shape", "elastomer"))
    here = np.flatnonzero((shapes == shape) & (elastomers == elastomer))
    if len(here) != 1:
        raise InputError(f"{study}, {run} has no elastomer {elastomer} with a shape {shape}")
    return float(history[quantity][here[0]])
