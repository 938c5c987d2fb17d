"""Random sensible cases in time: tissue that relaxes, closed on or pressed into, held, moved in sines and let go."""

from __future__ import annotations

from typing import Any

from campaign.posed_cases import random_force
from campaign.random_cases import Case, Generator, grasp, indentation, number_of, quantity, random_shear, tissue

FLOWING = 0.15
"""Share of tissues that flow: those of atrial tissue."""
MOST_RELAXED = 0.9
"""Largest part of the stiffness of other tissue that relaxes."""
LARGEST_FORCE = 0.05
"""On a jaw in N per kPa of shear modulus at once and cm^2 of a block's face."""


def relaxing_tissue(rng: Generator) -> str | Case:
    """Atrial tissue, or tissue of which up to nine tenths relax with one to three times from 10 ms to 100 s."""
    if rng.random() < FLOWING:
        return "atrial"
    material = tissue(rng)
    if isinstance(material, str):
        material = {"kind": "neo_hookean", "c10": quantity(random_shear(rng) / 2, "Pa")}
    count = int(rng.integers(1, 4))
    shares = rng.dirichlet([1.0] * count) * rng.uniform(0.1, MOST_RELAXED)
    times = sorted(10 ** rng.uniform(-2, 2, count))
    relaxation = {"fractions": [round(float(share), 4) for share in shares], "times": [quantity(time, "s") for time in times]}
    return {**material, "relaxation": relaxation}


def relaxing_grasp(rng: Generator) -> Case:
    """A grasp of a block that relaxes: closed within 0.05 to 5 s, and held, moved in sines, or opened by up to a third."""
    case = grasp(rng)
    case["block"]["tissue"] = relaxing_tissue(rng)
    most = number_of(case["loading"]["pieces"][0]["to"])
    if rng.random() < 0.25 and case["block"]["tissue"] != "atrial":
        case["loading"] = {"control": "force", "pieces": _pieces(rng, random_force(rng, case, LARGEST_FORCE), "N")}
    else:
        case["loading"] = {"control": "displacement", "pieces": _pieces(rng, most, "mm")}
    case["time"] = {"tolerance": 0.02}
    return case


def relaxing_indentation(rng: Generator) -> Case:
    """An annulus, a ball or a flat punch on tissue that relaxes, at up to an eighth of its thickness; coarse meshes."""
    case = indentation(rng)
    depth = number_of(case["displacement"]) / 2
    for key in ("displacement", "stop", "recess"):
        case.pop(key, None)
    case["specimen"]["material"] = relaxing_tissue(rng)
    case["loading"] = {"control": "displacement", "pieces": _pieces(rng, depth, "mm")}
    case["time"] = {"tolerance": 0.02}
    return case


def _pieces(rng: Generator, most: float, unit: str) -> list[dict[str, Any]]:
    """A ramp to the value ``most`` in its ``unit``, and in half of the cases each what follows it."""
    seconds = 0.05 * 100 ** rng.random()
    pieces: list[dict[str, Any]] = [{"kind": "ramp", "to": quantity(most, unit), "duration": quantity(seconds, "s")}]
    if rng.random() < 0.5:
        pieces.append({"kind": "hold", "duration": quantity(seconds * 10 ** rng.uniform(-0.5, 1), "s")})
    if rng.random() < 0.5:
        sine = {"amplitude": quantity(most * rng.uniform(0.02, 0.2), unit), "frequency": quantity(0.5 / seconds, "Hz")}
        pieces.append({"kind": "sine", **sine, "duration": quantity(4 * seconds, "s")})
    elif rng.random() < 0.5:
        pieces.append({"kind": "ramp", "to": quantity(most * rng.uniform(0.67, 1), unit), "duration": quantity(seconds, "s")})
    return pieces
