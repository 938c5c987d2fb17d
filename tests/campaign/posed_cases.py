"""Random sensible cases that are harder than those of their kind: jaws and bodies that lean, forces, layers, curved tissue."""

from __future__ import annotations

from math import atan, degrees
from typing import Any

import numpy as np

from campaign.random_cases import Case, Generator, grasp, indentation, length, number_of, quantity, tissue

STEEPEST = 4.0
"""Largest tilt of a jaw in degrees; half the angle of friction if that is less, as beyond it the block slips out."""
ASKEW = 0.1
"""Largest part of a tilt in degrees that the jaws do not share as mirror images. Where both lean the same way, the block is held
at first by opposite edges, and turns."""
LEAST_FORCE, LARGEST_FORCE = 0.01, 0.06
"""On a jaw in N per kPa of shear modulus and cm^2 of a block's face: they close it by some 2 to 13 %."""
SHEAR = {"icf_stable": 3.6, "b1a_stable": 90.0}
"""Small-strain shear modulus in kPa of the shipped tissues."""


def posed_grasp(rng: Generator) -> Case:
    """A grasp whose jaws lean towards or away from each other by up to four degrees each; three in ten by force."""
    case = grasp(rng)
    law = case["contact"]
    most = STEEPEST if law["kind"] == "stick" else min(STEEPEST, degrees(atan(law["friction"])) / 2)
    size = [number_of(extent) for extent in case["block"]["size"]]
    apart = {axis: most * rng.uniform(-1, 1) / 2**0.5 for axis in ("tilt_x", "tilt_y")}
    for side, sign in (("upper", 1), ("lower", -1)):
        tilts = {axis: f"{sign * lean + ASKEW * rng.uniform(-1, 1):.3g} deg" for axis, lean in apart.items() if most}
        case[side] = {**tilts, "offset": [length(1e-3 * extent * rng.uniform(-0.05, 0.05)) for extent in size[:2]]}
    if rng.random() < 0.3:
        force = quantity(random_force(rng, case, LARGEST_FORCE), "N")
        case["loading"] = {"control": "force", "pieces": [{"kind": "ramp", "to": force, "duration": "1 s"}]}
    return case


def layered_indentation(rng: Generator) -> Case:
    """An indentation of a specimen with up to two layers, or a curved top, or a base on which it slips."""
    case = indentation(rng)
    specimen = case["specimen"]
    thickness, radius = number_of(specimen["thickness"]), number_of(specimen["radius"])
    layers = [length(1e-3 * thickness * rng.uniform(0.05, 0.3)) for _ in range(int(rng.integers(0, 3)))]
    if layers:
        specimen["layers"] = [{"material": tissue(rng), "thickness": each} for each in layers]
    if rng.random() < 0.5:
        least = max(radius, (radius**2 + thickness**2) / thickness)  # its cap is half as deep as the specimen is thick, or less
        surface_radius = length(1e-3 * least * rng.uniform(1.1, 4.0))
        specimen |= {"surface": str(rng.choice(["convex", "concave"])), "surface_radius": surface_radius}
    if rng.random() < 0.3:
        specimen["base"] = "slipping"
    return case


def posed_indentation(rng: Generator) -> Case:
    """An indentation in 3D, half as deep, whose body leans by up to five degrees or stands beside the axis; few elements."""
    case = indentation(rng)
    radius = number_of(case["body"].get("outer_radius") or case["body"]["radius"])
    case["displacement"] = f"{number_of(case['displacement']) / 2:.4g} mm"
    case["mesh"] = {"growth": 1.0, "finest": length(1e-3 * radius / 10), "sectors": 3}
    if rng.random() < 0.7:
        case |= {axis: f"{rng.uniform(-5, 5):.3g} deg" for axis in ("tilt_x", "tilt_y")}
    if rng.random() < 0.5:
        room = number_of(case["specimen"]["radius"]) - 1.2 * radius
        case["offset"] = length(1e-3 * rng.uniform(0.0, 0.3) * room)
    return case


def random_force(rng: Generator, case: Case, largest: float) -> float:
    """A force in N on the jaws of a grasp, from ``LEAST_FORCE`` to the ``largest`` in its units."""
    width, depth, _ = map(number_of, case["block"]["size"])
    return rng.uniform(LEAST_FORCE, largest) * _shear(case["block"]["tissue"]) * width * depth / 100


def _shear(material: str | dict[str, Any]) -> float:
    """Small-strain shear modulus in kPa."""
    if isinstance(material, str):
        return SHEAR[material]
    return 2e-3 * float(np.sum([number_of(material[key]) for key in ("c10", "c01") if key in material]))
