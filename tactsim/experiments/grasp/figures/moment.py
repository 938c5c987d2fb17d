"""The moment of a grasp that its pictures show: the last step, or with blood in an artery that of the highest pressure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tactsim.experiments.grasp.figures.parts import SIDES, history
from tactsim.interfaces.taxel_layout import TaxelLayout
from tactsim.results import Quantity, Result
from tactsim.units import format_quantity

OUTWARD = {"upper": 1.0, "lower": -1.0}


def shown_moment(result: Result) -> Result:
    """The result as it was when the sum of all pressures in lumens was largest; as it ended, if there is none or no field of it.

    Steps are kept whole, so that histories can be drawn; ``moment`` in the details says in words what is shown.
    """
    lumens = sorted({name for step in result.steps for name in step.values if name.startswith("lumen_pressure")})
    if not lumens or not result.frames or "taxel_force_upper_history" not in result.quantities:
        return result
    pressure = np.sum([history(result, name) for name in lumens], axis=0)
    step = int(np.argmax(pressure))
    time = result.steps[step].values["time"]
    numbers = [k for k, frame in enumerate(result.frames) if np.isclose(frame.time, time, rtol=1e-9, atol=1e-12)]
    if not numbers or step == len(result.steps) - 1:
        return result
    closing = result.steps[step].values["displacement"]
    words = (
        f"lumen at its highest pressure, {format_quantity(float(pressure[step]), 'Pa')}, at {format_quantity(float(time), 's')}"
    )
    return replace(
        result,
        frames=result.frames[: numbers[-1] + 1],
        quantities=result.quantities | _quantities(result, step, closing),
        details=result.details | _places(result, closing) | {"moment": words},
    )


def _quantities(result: Result, step: int, closing: float) -> dict[str, Quantity]:
    area = TaxelLayout.model_validate(result.details["matrix"]).area
    found = {"displacement": replace(result.quantities["displacement"], value=closing)}
    for side in SIDES:
        force = np.asarray(result.quantities[f"taxel_force_{side}_history"].value, dtype=float)[step]
        found[f"taxel_force_{side}"] = replace(result.quantities[f"taxel_force_{side}"], value=force.tolist())
        found[f"taxel_pressure_{side}"] = replace(result.quantities[f"taxel_pressure_{side}"], value=(force / area).tolist())
    return found


def _places(result: Result, closing: float) -> dict[str, object]:
    """The jaws' places at that closing, from those at the end."""
    told = result.details.get("jaw_places")
    if told is None:
        return {}
    moved = float(result.quantities["displacement"].value) - closing
    return {"jaw_places": {side: [*told[side][:2], told[side][2] + OUTWARD[side] * moved] for side in SIDES}}
