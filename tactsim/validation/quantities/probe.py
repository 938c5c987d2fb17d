"""The probe with switches on its sides: thesis, chapter 5."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from tactsim.array import Array
from tactsim.contact.trapezoid import Trapezoid
from tactsim.errors import InputError
from tactsim.interfaces import drawing, quantity
from tactsim.model import FrozenModel
from tactsim.results.compared_numbers import CLOSE
from tactsim.sensors.switch_array import Formula, SwitchArray
from tactsim.sensors.switch_reading import read_switches
from tactsim.units import Frequency, Length, Positive, Speed, format_quantity
from tactsim.validation.curves import Data, Title, curves_figure, panel, series
from tactsim.validation.inputs import Inputs, RunName, StudyName
from tactsim.validation.study import RunOutcome

DIMENSION_UNITS = {"switches": "1", "left": "1", "right": "1", "pitch": "m", "travel": "m", "lean": "rad"}
LEAN_HEIGHT = 3e-3
"""Height in m above the face at which the lean of a side is measured."""
STIFFNESS = 200.0
"""Stiffness in N/m of the tissue under the probe and under a switch. Its size is of no account: only when the forces begin is."""


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


@quantity(unit="m")
def probe_contact_depth(inputs: Inputs, study: StudyName, run: RunName, height: Positive[Length]) -> float:
    """Depth in m of the probe at which the tissue touches its sides up to a height, the first time on the way in.

    Parameters
    ----------
    height : height above the face

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge or has no contact that high.
    """
    history = inputs.converged(study, run).history
    depth, touched = np.array(history["depth"]), np.array(history["contact_height"])
    beyond = np.flatnonzero(touched >= height)
    if not beyond.size or beyond[0] == 0:
        raise InputError(f"{study}, {run} has no contact up to {format_quantity(height, 'm')} above the face")
    sides = slice(int(beyond[0]) - 1, int(beyond[0]) + 1)
    return float(np.interp(height, touched[sides], depth[sides]))


class ProbeRun(FrozenModel):
    """A run of a study of the probe."""

    study: StudyName
    run: RunName


Tissues = Annotated[int, Field(ge=2, le=20, description="Number of tissues of both runs.")]
Rates = Annotated[tuple[Positive[Speed], ...], Field(min_length=1, description="Rates that are compared.")]
Depths = Annotated[tuple[Positive[Length], ...], Field(min_length=1, description="Depths that are compared.")]
TissueNumber = Annotated[int, Field(ge=1, description="Number of the tissue in the case, from 1.")]
EACH_MM = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3)
"""Depths in m at which forces are compared unless a table says others."""


@quantity(unit="1")
def probe_model_difference(
    inputs: Inputs, of: ProbeRun, beside: ProbeRun, *, tissues: Tissues, rates: Rates, depths: Depths = EACH_MM
) -> float:
    """Largest relative difference of the force on the probe between two models, over tissues, rates and depths; dimensionless.

    Parameters
    ----------
    of : the run that is judged, such as one of the fast model
    beside : the run whose forces it is related to, such as one by finite elements

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, or has no touch of a tissue and rate down to a depth.
    """
    judged, reference = (_forces(inputs, which, tissues, rates, depths) for which in (of, beside))
    return float(np.abs(judged / reference - 1).max())


@quantity(unit="1")
def probe_order_kept(
    inputs: Inputs, of: ProbeRun, beside: ProbeRun, *, tissues: Tissues, rates: Rates, depths: Depths = EACH_MM
) -> float:
    """Part of the pairs of tissues, over rates and depths, that two models order alike by their force; dimensionless, 1 for all.

    Parameters
    ----------
    of, beside : the runs

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, or has no touch of a tissue and rate down to a depth.
    """
    first, second = (_forces(inputs, which, tissues, rates, depths) for which in (of, beside))
    pairs = np.triu_indices(tissues, 1)
    signs = [np.sign(forces[pairs[0]] - forces[pairs[1]]) for forces in (first, second)]
    return float(np.mean(signs[0] == signs[1]))


@quantity(unit="1")
def probe_rank(inputs: Inputs, run: ProbeRun, press: Press, *, tissues: Tissues, depth: Positive[Length] = 5e-3) -> float:
    """Place of a tissue among all at its rate and a depth, 1 for the hardest; dimensionless.

    Parameters
    ----------
    run : where the forces come from
    press : the tissue, and the rate at which all are pressed
    depth : depth of the probe in the tissues

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, or has no touch of a tissue and rate down to the depth.
    """
    forces = _forces(inputs, run, tissues, (press.rate,), (depth,))[:, 0, 0]
    if press.tissue > tissues:
        raise InputError(f"tissue {press.tissue} of {tissues}; allowed: up to their number")
    return float(1 + np.count_nonzero(forces > forces[press.tissue - 1]))


@drawing
def probe_tissues_by_rate(
    inputs: Inputs, title: Title, runs: Annotated[dict[str, ProbeRun], Field(min_length=1)], *, tissues: Tissues, rates: Rates
) -> Data:
    """Force in N over depth in m of every tissue, one panel per rate, by one or two models: thesis Fig. 5.8.

    Parameters
    ----------
    runs : runs by the name of the model; the first is drawn with lines, others with points

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge.
    """
    panels = []
    for rate in rates:
        curves: list[Data] = []
        for name, which in runs.items():
            style = "points" if curves and len(curves) >= tissues else "line"
            depths = np.array(EACH_MM) if style == "points" else np.linspace(0.1e-3, EACH_MM[-1], 50)
            forces = _forces(inputs, which, tissues, (rate,), tuple(depths.tolist()))
            curves += [series(f"tissue {k + 1}, {name}", depths, forces[k, 0], style) for k in range(tissues)]
        panels.append(panel(f"force at {_speed(rate)}", "N", curves))
    return curves_figure(title, "depth", "m", panels, even_panels=True)


@drawing
def probe_rates_of_tissue(inputs: Inputs, title: Title, run: ProbeRun, rates: Rates, tissue: TissueNumber = 1) -> Data:
    """Force in N over depth in m of one tissue at several rates: thesis Fig. 5.7.

    Parameters
    ----------
    run : run of the probe

    Raises
    ------
    UnknownName, InputError
        If there is no such run, or it did not converge, or has no touch of the tissue at a rate.
    """
    outcome, depths = inputs.converged(run.study, run.run), np.linspace(0.1e-3, EACH_MM[-1], 50)
    curves = [
        series(
            _speed(rate),
            depths,
            np.array([_force_at(depth, Press(tissue=tissue, rate=rate), outcome, run.study) for depth in depths]),
        )
        for rate in rates
    ]
    return curves_figure(title, "depth", "m", [panel("force", "N", curves)])


def _speed(rate: float) -> str:
    """A rate of indentation as the thesis writes it."""
    return f"{1e3 * rate:g} mm/s"


def _forces(inputs: Inputs, which: ProbeRun, tissues: int, rates: tuple[float, ...], depths: tuple[float, ...]) -> Array:
    """Forces in N (tissue, rate, depth) on the way in."""
    outcome = inputs.converged(which.study, which.run)
    return np.array(
        [
            [[_force_at(depth, Press(tissue=k, rate=rate), outcome, which.study) for depth in depths] for rate in rates]
            for k in range(1, tissues + 1)
        ]
    )


def _force_at(asked: float, press: Press, outcome: RunOutcome, study: str) -> float:
    """Force in N at a depth in m on the way in, linear between the samples that the history keeps."""
    tissue, rate, depth, force = (np.array(outcome.history[name]) for name in ("tissue", "rate", "depth", "force"))
    samples = np.flatnonzero((tissue == press.tissue) & (np.abs(rate - press.rate) <= CLOSE * press.rate))
    if not samples.size or depth[samples].max() < asked * (1 - CLOSE):
        speed, deep = format_quantity(press.rate, "m/s"), format_quantity(asked, "m")
        raise InputError(f"{study}, {outcome.id} has no touch of tissue {press.tissue} at {speed} down to {deep}")
    inwards = samples[: int(depth[samples].argmax()) + 1]
    return float(np.interp(asked, depth[inwards], force[inwards]))
