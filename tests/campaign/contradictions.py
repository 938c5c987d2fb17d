"""What a converged result must not say, whatever the solver says of itself."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, sin
from typing import Any

from tactsim.units import parse_quantity

BALANCE = 1e-6
"""Largest difference of a sum of forces from its parts over the larger: round-off of a hundred thousand terms."""
LEAST_VOLUME = 0.0
"""A volume ratio at or below it is a body turned inside out."""
FORCE_ERROR = 5e-3
"""Largest part of the force that penetration may take away; `docs/guide/run.md`."""
PENETRATION = 1e-2
"""Largest penetration over the displacement: what the schema says of a closing, and five times what it says of a body."""
REACHED = 1e-9
"""Relative difference of a displacement from the one that was asked for: round-off of a sum of steps."""
PLACES_TOLD = 3
"""Places of numbers that are not finite, of which a hundred can stand in one array."""


def contradictions(result: dict[str, Any], experiment: dict[str, Any] | None = None) -> list[str]:
    """What is wrong with a ``result.json``, by the ``experiment`` of its case where that is known.

    Values that are not finite, which are stored as null, forces out of balance, bodies penetrated, volumes turned inside out, and
    an end before what the case asked for.
    """
    values = {name: quantity["value"] for name, quantity in result["quantities"].items()}
    steps = {f"step {step['step']}": step["values"] for step in result.get("steps", ())}
    if lost := [*_not_finite(values), *_not_finite(steps)]:
        more = f" and {len(lost) - PLACES_TOLD} more" if len(lost) > PLACES_TOLD else ""
        return [f"{', '.join(lost[:PLACES_TOLD])}{more}: not finite"]
    faults = [
        *_out_of_balance(values, _normal_of_lower_jaw(result)),
        *_penetrated(values),
        *_cut_short(values, result["reason"], experiment or {}),
    ]
    if values.get("min_volume_ratio", 1.0) <= LEAST_VOLUME:
        faults.append(f"a volume ratio of {values['min_volume_ratio']:g}")
    threshold = values.get("threshold_force")
    if isinstance(threshold, float) and threshold <= 0:
        faults.append("a threshold force that pulls")
    return faults


def _not_finite(value: Any, place: str = "") -> Iterator[str]:
    """Places of null and of numbers that are not finite, at any depth."""
    if isinstance(value, dict | list):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value, 1):
            yield from _not_finite(each, f"{place} {key}".strip())
    elif value is None or (isinstance(value, float) and not abs(value) < float("inf")):
        yield place


def _normal_of_lower_jaw(result: dict[str, Any]) -> tuple[float, float, float]:
    """Unit vector across its face into the tissue; it turns about x first, then about y."""
    jaw = (result.get("scene") or {}).get("jaws", {}).get("lower", {})
    x, y = jaw.get("tilt_x", 0.0), jaw.get("tilt_y", 0.0)
    return cos(x) * sin(y), -sin(x), cos(x) * cos(y)


def _out_of_balance(values: dict[str, Any], lower: tuple[float, float, float]) -> Iterator[str]:
    """Parts of a jaw that are not its whole, and a body that is pressed from one side only."""
    pairs = []
    for side, whole in (("upper", "the reaction"), ("lower", "the force on that jaw")):
        if f"taxel_force_{side}" in values:
            taxels = sum(sum(row) for row in values[f"taxel_force_{side}"])
            parts = taxels + values[f"gap_force_{side}"] + values[f"outside_force_{side}"]
            across = -sum(part * n for part, n in zip(values["jaw_force_lower"], lower, strict=True))
            force = values["reaction_force"] if side == "upper" else across
            pairs.append((f"taxels, gaps and outside of the {side} jaw are", parts, whole, force))
    if "jaw_force_lower" in values:
        for axis, (upper, lower) in enumerate(zip(values["jaw_force_upper"], values["jaw_force_lower"], strict=True)):
            pairs.append((f"the upper jaw presses along {'xyz'[axis]} with", upper, "the lower one against it with", -lower))
    if "base_force" in values:
        pressed = values["reaction_force"] + values.get("sensor_force", 0.0)  # of an annulus, whose inner sensor presses too
        pairs.append(("the body presses with", pressed, "the base against it with", values["base_force"]))
    largest = max([abs(force) for _, *forces in pairs for force in (forces[0], forces[2])], default=0.0)
    for what, one, than, other in pairs:
        if abs(one - other) > BALANCE * largest:
            yield f"{what} {one:g} N, {than} {other:g} N"


def _penetrated(values: dict[str, Any]) -> Iterator[str]:
    if values.get("penetration_force_error", 0.0) > FORCE_ERROR:
        yield f"penetration takes away {values['penetration_force_error']:.2%} of the force"
    if "max_penetration" in values and "displacement" in values:  # a design has displacements, and no contact to penetrate
        deepest, moved = values["max_penetration"], values["displacement"]
        if deepest > PENETRATION * abs(moved):
            yield f"a penetration of {deepest:g} m at a displacement of {moved:g} m"


def _cut_short(values: dict[str, Any], reason: str, experiment: dict[str, Any]) -> Iterator[str]:
    """An end before the displacement that a case asks for."""
    if experiment.get("kind") == "grasp" and experiment["loading"]["control"] == "displacement":
        pieces = [piece for piece in experiment["loading"]["pieces"] if piece["kind"] != "hold"]
        if "to" not in pieces[-1]:  # a sine, whose end its frequency says to four digits only
            return
        asked = pieces[-1]["to"]
    elif experiment.get("kind") in ("indentation", "indentation_3d") and reason == "displacement reached":
        asked = experiment["displacement"]
    else:
        return
    metres = parse_quantity(asked, "m")
    if abs(values["displacement"] - metres) > REACHED * metres:
        yield f"a displacement of {values['displacement']:g} m where the case asks for {metres:g} m"
