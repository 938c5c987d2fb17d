"""What finer matrices cost: the time of a grasp read by 16 x 16 taxels over that by 3 x 3, both on one solution; prints JSON."""

from __future__ import annotations

import json
import sys
import time
from functools import partial
from pathlib import Path

from timing import median_seconds

from tactsim.case.loading import load_case
from tactsim.experiments.grasp.grasp import Grasp
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.experiments.grasp.readings import jaw_readings
from tactsim.interfaces.taxel_layout import TaxelLayout

CASE = Path(__file__).parents[1] / "cases" / "grasp_lump_icf.yaml"
SIDES = (3, 16)
"""Rows, and columns, of each matrix."""
WIDTH, COVERED = 30e-3, 0.9
"""Width in m of each matrix, and the part of it that taxels cover, as in the case."""
REPEATS = 7
ASKED = 1.05


def measure() -> dict[str, float]:
    """Seconds of the solution, of reading both jaws in its last state, and the ratio when every state is read."""
    grasp = load_case(CASE).experiment
    assert isinstance(grasp, Grasp)
    begin = time.perf_counter()
    model = grasp_model(grasp, grasp_mesh(grasp))
    states = [state.contact for state, _ in grasp_path(grasp, model).states()]
    figures = {"solution_seconds": time.perf_counter() - begin, "states": float(len(states))}
    for side in SIDES:
        layout = TaxelLayout(rows=side, columns=side, pitch=WIDTH / side, size=COVERED * WIDTH / side)
        figures[f"reading_{side}_seconds"] = median_seconds(partial(jaw_readings, model, states[-1], layout), REPEATS)
    coarse, fine = (figures["solution_seconds"] + len(states) * figures[f"reading_{side}_seconds"] for side in SIDES)
    return figures | {"ratio": fine / coarse}


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """The row of the performance table: what, what is asked, what was measured."""
    what = "time of `grasp_lump_icf.yaml` with 16 x 16 taxels over that with 3 x 3, one solution"
    coarse, fine = (1e3 * taken[f"reading_{side}_seconds"] for side in SIDES)
    return [(what, f"{ASKED:g}", f"{taken['ratio']:.3f} ({fine:.0f} and {coarse:.0f} ms to read a state)")]


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(), indent=2) + "\n")
