"""The moment of a grasp that its pictures show: the last step, or with blood in an artery that of the highest pressure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tactsim.experiments.grasp.history import lumen_columns
from tactsim.experiments.grasp.scene import SimulatedGrasp
from tactsim.interfaces.both_jaws import TAXEL_FORCE, TAXEL_PRESSURE, has_taxels, jaws_over_time
from tactsim.interfaces.taxel_layout import JAWS, OUTWARD
from tactsim.results import Quantity, Result
from tactsim.units import format_quantity


def shown_moment(result: Result) -> Result:
    """The result as it was when the sum of all pressures in lumens was largest; as it ended, if there is none or no field of it.

    Steps are kept whole, so that histories can be drawn; the scene says in words which moment is shown.
    """
    lumens = lumen_columns(result)
    if not lumens or not result.frames or not has_taxels(result, TAXEL_FORCE, history=True):
        return result
    pressure = np.sum([result.history_values(name) for name in lumens], axis=0)
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
        scene=_moved(result, closing).model_copy(update={"moment": words}),
    )


def _quantities(result: Result, step: int, closing: float) -> dict[str, Quantity]:
    area = result.scene_as(SimulatedGrasp).matrix.area
    quantities = {"displacement": replace(result.quantities["displacement"], value=closing)}
    forces = jaws_over_time(result, TAXEL_FORCE)[step]
    for name, values in ((TAXEL_FORCE, forces), (TAXEL_PRESSURE, forces / area)):
        for side, value in zip(JAWS, values.tolist(), strict=True):
            quantities[f"{name}_{side}"] = replace(result.quantities[f"{name}_{side}"], value=value)
    return quantities


def _moved(result: Result, closing: float) -> SimulatedGrasp:
    """The scene with the jaws' places at that closing, from those at the end."""
    scene = result.scene_as(SimulatedGrasp)
    moved = float(result.quantities["displacement"].value) - closing
    places = {}
    for side, outward in OUTWARD.items():
        x, y, z = scene.jaw_places[side]
        places[side] = (x, y, z + outward * moved)
    return scene.model_copy(update={"jaw_places": places})
