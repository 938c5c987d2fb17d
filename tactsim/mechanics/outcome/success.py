"""Whether a run with contact is a success: the one place that decides, and what it says if it is none."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from tactsim.fem.equilibrium.newton_options import NewtonOptions
from tactsim.results.result import Status, StepRecord
from tactsim.units import format_quantity

LARGEST_FORCE_ERROR = 5e-3
"""Largest part of the force that penetration may take away: a quarter of the two per cent that the meshes of the shipped cases
leave, so that the regularisation of the contact is never what limits an answer."""
ROUND_OFF = 1e-9
"""Relative excess of a penetration over its tolerance that is round-off."""
FINITE = ("displacement", "reaction_force", "max_penetration", "min_volume_ratio", "penetration_force_error")
"""History values that must be finite wherever a run records them."""
SATURATED = 0.99
"""Estimate beyond which nearly all of the force is missing and nothing more follows from it."""


def judged(
    status: Status, reason: str, reported: Iterable[StepRecord], tolerance: float, balance: float = NewtonOptions.tolerance
) -> tuple[Status, str]:
    """Status and reason of a run whose path ended as given, from the states that it reports.

    ``tolerance`` in m is the largest penetration that was allowed, ``balance`` the largest relative residual. A run
    that failed or was interrupted stays so.
    """
    if status is not Status.CONVERGED:
        return status, reason
    for step in reported:
        if fault := _fault(step, tolerance, balance):
            return Status.FAILED, f"{fault}, {_where(step.values)}"
    return status, reason


def _fault(step: StepRecord, tolerance: float, balance: float) -> str | None:
    """What is wrong with a reported state, None if nothing is."""
    values = step.values
    for name in FINITE:
        if name in values and not math.isfinite(values[name]):
            return f"the {name.replace('_', ' ')} is {values[name]}, not a finite number"
    if not step.residual <= balance:
        return f"the residual is {step.residual:.1e}; allowed: {balance:g}"
    if values["min_volume_ratio"] <= 0:
        return f"an element is inside out, its volume ratio {values['min_volume_ratio']:.3g}; allowed: above 0"
    if values["max_penetration"] > tolerance * (1 + ROUND_OFF):
        penetration, allowed = (format_quantity(length, "m") for length in (values["max_penetration"], tolerance))
        return f"the penetration is {penetration}; allowed: {allowed}"
    error = values["penetration_force_error"]
    if error > LARGEST_FORCE_ERROR:
        enough = sufficient_tolerance(values["max_penetration"], tolerance, error)
        return (
            f"penetration takes away {100 * error:.2f} % of the force by its estimate; allowed: "
            f"{100 * LARGEST_FORCE_ERROR:.1f} %; "
            f"take penetration_tolerance: at most {format_quantity(enough, 'm')}"
        )
    return None


def _where(values: Mapping[str, float]) -> str:
    """At which displacement of the bodies a state is, or at which time."""
    name, unit = ("displacement", "m") if "displacement" in values else ("time", "s")
    return f"at a {name} of {format_quantity(values[name], unit)}"


def sufficient_tolerance(penetration: float, tolerance: float, error: float) -> float:
    """A tolerance in m with which the error of the force would fall to what a success allows, rounded down to one digit.

    Contact and tissue are two springs in series: the missing part of the force is e / (1 - e) of what remains. Where
    nothing penetrates it is creep that costs, in proportion to the tolerance.
    """
    missing = min(error, SATURATED)
    enough = (penetration if penetration > 0 else tolerance) * LARGEST_FORCE_ERROR * (1 - missing) / missing
    digit = 10.0 ** math.floor(math.log10(enough))
    return digit * math.floor(enough / digit * (1 + ROUND_OFF))


def within_layer(reason: str, deepest: float, thickness: float | None) -> tuple[Status, str]:
    """Status and reason of a closed form with displacements up to ``deepest`` in m, on a layer if a thickness in m is given."""
    if thickness is None or deepest < thickness:
        return Status.CONVERGED, reason
    given, most = format_quantity(deepest, "m"), format_quantity(thickness, "m")
    return Status.FAILED, f"the displacement reaches {given}; allowed: less than the thickness of the layer, {most}; press less"
