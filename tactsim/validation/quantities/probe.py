"""The probe with switches on its sides: thesis, chapter 5."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.contact.trapezoid import Trapezoid
from tactsim.errors import InputError
from tactsim.interfaces import quantity
from tactsim.model import FrozenModel
from tactsim.sensors.switch_array import Formula, SwitchArray
from tactsim.sensors.switch_reading import read_switches
from tactsim.units import Frequency, Length, Positive, Speed, format_quantity
from tactsim.validation.inputs import Inputs, RunName, StudyName
from tactsim.validation.study import RunOutcome

DIMENSION_UNITS = {"switches": "1", "left": "1", "right": "1", "pitch": "m", "travel": "m", "lean": "rad"}
LEAN_HEIGHT = 3e-3
"""Height in m above the face at which the lean of a side is measured."""
STIFFNESS = 200.0
"""In N/m, of the tissue under the probe; a switch carries as much over what is below it. Only when they begin counts."""
SAME = 1e-9
"""Relative difference of two rates or depths that is round-off."""


@quantity(unit=lambda dimension: DIMENSION_UNITS[dimension])
def probe_dimension(dimension: Literal["switches", "left", "right", "pitch", "travel", "lean"]) -> float:
    """In SI: number or place of the switches, or the lean of a side from the normal of its surface 3 mm above the face.

    Parameters
    ----------
    dimension : which of them
    """
    array = SwitchArray()
    if dimension == "lean":
        probe = Trapezoid()
        _, normal, _ = probe.signed_distance(np.array([[float(probe.half_width(LEAN_HEIGHT))], [LEAN_HEIGHT]]))
        return float(np.arctan2(-normal[1, 0], normal[0, 0]))
    if dimension == "pitch":
        return float(np.diff(array.heights).mean())
    if dimension == "travel":
        return float(array.heights[-1])
    return float(array.count if dimension == "switches" else array.sides.count(dimension))


@quantity(unit="m/s")
def switch_mean_rate(
    rate: Positive[Speed] = 1e-3, formula: Formula = "corrected", sampling_rate: Positive[Frequency] = 1000.0
) -> float:
    """Mean rate in m/s by eq. 5.2.2 on clean samples of a touch at a constant rate whose tissue follows the sides of the probe.

    Parameters
    ----------
    rate : rate of indentation
    formula : reading of eq. 5.2.2
    sampling_rate : samples per second

    Raises
    ------
    InputError
        If the samples are too few for every switch to close.
    """
    array = SwitchArray(formula=formula)
    time = np.arange(0.0, 1.1 * array.travel / rate, 1 / sampling_rate)
    reached = np.maximum(rate * time[:, None] - array.heights, 0.0)
    (touch,) = read_switches(array, time, STIFFNESS * rate * time, STIFFNESS * reached).touches
    mean_rate = touch.mean_rate(array)
    if mean_rate is None:
        raise InputError("not every switch closed; sample faster")
    return mean_rate


class Press(FrozenModel):
    """A tissue at a rate."""

    tissue: Annotated[int, Field(ge=1)]
    """Number of the tissue in the case, from 1."""
    rate: Positive[Speed]
    """Rate of indentation."""


@quantity(unit="1")
def probe_force_ratio(
    inputs: Inputs, study: StudyName, run: RunName, press: Press, over: Press, *, depth: Positive[Length] = 5e-3
) -> float:
    """Force on the probe over that of another tissue or rate, both at the same depth on the way in; dimensionless.

    Parameters
    ----------
    press, over : numerator and denominator
    depth : depth of the probe in the tissue

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, or has no touch of this tissue and rate down to the depth.
    """
    outcome = inputs.run(study, run)
    if not outcome.converged:
        raise InputError(f"{study}, {run} has no forces: {outcome.reason}")
    return _force_at(depth, press, outcome, study) / _force_at(depth, over, outcome, study)


def _force_at(asked: float, press: Press, outcome: RunOutcome, study: str) -> float:
    """Force in N at a depth in m on the way in, linear between the samples that the history keeps."""
    tissue, rate, depth, force = (np.array(outcome.history[name]) for name in ("tissue", "rate", "depth", "force"))
    samples = np.flatnonzero((tissue == press.tissue) & (np.abs(rate - press.rate) <= SAME * press.rate))
    if not samples.size or depth[samples].max() < asked * (1 - SAME):
        speed, deep = format_quantity(press.rate, "m/s"), format_quantity(asked, "m")
        raise InputError(f"{study}, {outcome.id} has no touch of tissue {press.tissue} at {speed} down to {deep}")
    inwards = samples[: int(depth[samples].argmax()) + 1]
    return float(np.interp(asked, depth[inwards], force[inwards]))
