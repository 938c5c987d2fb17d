"""Random sensible cases: indentations, grasps, and examples of other kinds with other numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from tactsim.case.writing import case_document
from tactsim.interfaces import Experiment
from tactsim.registry import kind_class

Case = dict[str, Any]
Generator = np.random.Generator
TISSUES = ("icf_stable", "b1a_stable")
NUMBER = re.compile(r"^(-?[0-9.]+(?:e-?[0-9]+)?) (.+)$")


def length(metres: float) -> str:
    """A length as a user writes it, to four digits."""
    return quantity(1e3 * metres, "mm")


def quantity(value: float, unit: str) -> str:
    """A value in a unit as a user writes it, to four digits."""
    return f"{value:.4g} {unit}"


def number_of(text: str) -> float:
    """The number of a value that is written so."""
    return float(text.split()[0])


def random_shear(rng: Generator) -> float:
    """A shear modulus from 500 Pa to 300 kPa."""
    return float(500 * 600 ** rng.random())


def tissue(rng: Generator) -> str | Case:
    """A shipped set, a neo-Hookean or a Mooney-Rivlin tissue from 0.5 to 300 kPa, nearly or exactly incompressible."""
    if rng.random() < 0.4:
        return str(rng.choice(TISSUES))
    shear = random_shear(rng)
    bulk: Case = {"bulk_modulus": f"{shear * 10 ** rng.uniform(1.5, 4):.4g} Pa"} if rng.random() < 0.5 else {}
    if rng.random() < 0.5:
        return {"kind": "neo_hookean", "c10": f"{shear / 2:.4g} Pa", **bulk}
    share = rng.uniform(0.2, 1.0)
    return {"kind": "mooney_rivlin_2", "c10": f"{share * shear / 2:.4g} Pa", "c01": f"{(1 - share) * shear / 2:.4g} Pa", **bulk}


def contact(rng: Generator) -> Case:
    """No friction, Coulomb friction up to 1, or sticking."""
    choice = rng.random()
    if choice < 0.1:
        return {"kind": "stick"}
    return {"kind": "coulomb", "friction": 0.0 if choice < 0.2 else round(float(rng.uniform(0.05, 1.0)), 3)}


def indentation(rng: Generator) -> Case:
    """An annulus, a ball or a flat punch pressed by up to a quarter of a specimen of 4 to 20 mm; coarse meshes."""
    outer = rng.uniform(1.5e-3, 5e-3)
    thickness = rng.uniform(4e-3, 20e-3)
    bodies: list[Callable[[], Case]] = [
        lambda: {
            "kind": "annulus",
            "inner_radius": length(outer * rng.uniform(0.3, 0.7)),
            "outer_radius": length(outer),
            "fillet": length(outer * rng.uniform(0.04, 0.1)),
        },
        lambda: {"kind": "sphere", "radius": length(outer)},
        lambda: {"kind": "punch", "radius": length(outer), "fillet": length(outer * rng.uniform(0.05, 0.15))},
    ]
    body = bodies[int(rng.integers(len(bodies)))]()
    case: Case = {
        "specimen": {"material": tissue(rng), "thickness": length(thickness), "radius": length(outer * rng.uniform(1.6, 5.0))},
        "body": body,
        "contact": contact(rng),
        "displacement": length(thickness * rng.uniform(0.02, 0.25)),
        "mesh": {"growth": 0.6, "finest": length(outer / 25)},
    }
    if body["kind"] == "annulus":
        case["recess"] = length(outer * rng.uniform(0.05, 0.3))
    if body["kind"] != "annulus" or rng.random() < 0.5:
        case["stop"] = "displacement"
    return case


def grasp(rng: Generator) -> Case:
    """A block of 16 to 40 mm with up to two lumps between two jaws that close by up to 8 % of the height each; coarse meshes."""
    size = [rng.uniform(16e-3, 40e-3), rng.uniform(16e-3, 40e-3), rng.uniform(10e-3, 25e-3)]
    case: Case = {
        "block": {"size": [length(extent) for extent in size], "tissue": tissue(rng)},
        "contact": contact(rng),
        "matrix": {"rows": 3, "columns": 3, "pitch": length(min(size[:2]) / 4), "size": length(min(size[:2]) / 5)},
        "loading": {
            "control": "displacement",
            "pieces": [{"kind": "ramp", "to": length(size[2] * rng.uniform(0.01, 0.08)), "duration": "1 s"}],
        },
        "mesh": {"kind": "structured", "cells": [6, 6, 4]},
    }
    count = int(rng.choice([0, 1, 1, 2]))
    if count:
        radius = min(size) * rng.uniform(0.1, 0.22)
        case["inclusions"] = [_lump(rng, size, radius, place, count) for place in range(count)]
        case["mesh"] = {"kind": "tetrahedra", "size": length(max(size) / 6)}
    return case


def _lump(rng: Generator, size: list[float], radius: float, place: int, count: int) -> Case:
    """A ball in its share of the block, at least 1 mm and a third of its radius below every surface."""
    room = radius + max(radius / 3, 1e-3)
    low, high = size[0] * place / count + room, size[0] * (place + 1) / count - room
    middle = [rng.uniform(low, high) if high > low else (low + high) / 2, *(rng.uniform(room, s - room) for s in size[1:])]
    material = {"kind": "neo_hookean", "c10": f"{500 * 1000 ** rng.random():.4g} Pa"}
    return {"shape": {"kind": "sphere", "center": [length(x) for x in middle], "radius": length(radius)}, "material": material}


def varied_example(kind: str, rng: Generator) -> Case:
    """The example of a kind, every quantity with a unit multiplied by 0.8 to 1.25, lists by one factor."""
    document = case_document(kind_class(Experiment, kind).example())["experiment"]
    varied: Case = _varied({key: value for key, value in document.items() if key != "kind"}, rng)
    return varied


def _varied(value: Any, rng: Generator) -> Any:
    if isinstance(value, dict):
        return {key: _varied(each, rng) for key, each in value.items()}
    if isinstance(value, list | tuple):
        factor = 1.25 ** rng.uniform(-1, 1)
        return [_scaled(each, factor) if isinstance(each, str) else _varied(each, rng) for each in value]
    return _scaled(value, 1.25 ** rng.uniform(-1, 1)) if isinstance(value, str) else value


def _scaled(text: str, factor: float) -> str:
    quantity = NUMBER.match(text)
    return f"{float(quantity[1]) * factor:.6g} {quantity[2]}" if quantity else text
