"""What the figures of a grasp need of its result: block, jaws in their last place, taxels and histories."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tactsim.contact.jaw import Jaw
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.plotting.plane_cut import deformed, regions_of
from tactsim.results import FieldFrame, Result
from tactsim.units import format_quantity

Array = np.ndarray

SIDES = ("upper", "lower")
LETTERS = {"upper": "U", "lower": "L"}
"""How the thesis's Fig. 6.3 calls the taxels of each jaw."""


TOUCH, MOST_APPROACHES = 1e-7, 300
"""Gap over the size of the block that counts as touch, and steps on the way there."""


@dataclass(frozen=True)
class Grasp:
    """A grasp at its last accepted step.

    Attributes
    ----------
    size : (3,) of the undeformed block in m, which begins at the origin
    jaws : by side
    places : (3,) in m of the middle of each jaw's face, by side
    layout : of the taxels on each jaw
    pressures : (rows, columns) in Pa of the taxels, by side
    forces : (rows, columns) in N that press into the taxels, by side
    """

    size: Array
    jaws: Mapping[str, Jaw]
    places: Mapping[str, Array]
    layout: TaxelLayout
    pressures: Mapping[str, Array]
    forces: Mapping[str, Array]

    @property
    def largest_pressure(self) -> float:
        """Largest pressure in Pa on any taxel, and at least something, so that a scale can end there."""
        return max(1e-12, *(float(np.max(self.pressures[side])) for side in SIDES))

    @property
    def smallest_pressure(self) -> float:
        """Smallest pressure in Pa on any taxel, at most zero."""
        return min(0.0, *(float(np.min(self.pressures[side])) for side in SIDES))


def grasp_of(result: Result) -> Grasp:
    """The grasp that a result describes."""
    details, quantities = result.details, result.quantities
    pressures, forces = (
        {side: np.asarray(quantities[f"taxel_{name}_{side}"].value, float) for side in SIDES} for name in ("pressure", "force")
    )
    size = np.asarray(details["block_size"], float)
    jaws = {side: Jaw.model_validate(details["jaws"][side]) for side in SIDES}
    layout = TaxelLayout.model_validate(details["matrix"])
    return Grasp(size, jaws, {side: _place(result, size, jaws[side]) for side in SIDES}, layout, pressures, forces)


def _place(result: Result, size: Array, jaw: Jaw) -> Array:
    """Place (3,) in m of the middle of a jaw's face: as the result tells, or at the block's middle where it meets the tissue."""
    told = result.details.get("jaw_places")
    if told is not None:
        return np.asarray(told[jaw.side], float)
    outward = 1.0 if jaw.side == "upper" else -1.0
    closing = float(result.quantities["displacement"].value)
    place = np.array([size[0] / 2, size[1] / 2, (size[2] if outward > 0 else 0.0) - outward * closing])
    if not result.frames:
        return place
    nodes = deformed(result.frames[-1]).T
    place[2] += outward * float(size.max())
    for _ in range(MOST_APPROACHES):
        gap = float(jaw.signed_distance(nodes - place[:, None])[0].min())
        place[2] -= outward * gap
        if gap < TOUCH * size.max():
            break
    return place


def history(result: Result, name: str) -> Array:
    """A history value (steps,), NaN where a step has none."""
    return np.array([step.values.get(name, np.nan) for step in result.steps])


def ending(result: Result) -> str:
    """What is shown in words: how far the jaws have closed, and which moment it is if not the last."""
    closing, moment = result.quantities["displacement"].value, result.details.get("moment")
    return f"each jaw closed by {format_quantity(float(closing), 'm')}" + (f"; {moment}" if moment else "")


def inclusions_of(frame: FieldFrame) -> dict[int, Array]:
    """Nodes of every inclusion, by its number."""
    regions, elements = regions_of(frame), frame.cells["tetra10"]
    return {int(k): np.unique(elements[regions == k]) for k in np.unique(regions) if k > 0}


def described(details: Mapping[str, Any], number: int) -> str:
    """How the result calls an inclusion, such as "sphere 1"."""
    inclusions = details.get("inclusions") or []
    kind = inclusions[number - 1].get("kind", "inclusion") if number <= len(inclusions) else "inclusion"
    return f"{kind} {number}"
