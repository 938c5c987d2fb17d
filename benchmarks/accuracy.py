"""How far the main case and the default grasp are from finer meshes; prints JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

import tactsim as ts
from tactsim.interfaces.taxel_layout import JAWS

CASES = Path(__file__).parents[1] / "cases"
REFINED = 3.0
"""Elements of `annulus_icf` are this many times as short: a minute or two, 48 876 unknowns instead of 6 395."""
FINER = {"kind": "graded", "size": "2 mm", "inclusion_size": "1 mm", "edge_size": "0.4 mm", "growth": 0.5}
"""Cells of the grasp: 257 924 unknowns instead of 77 332, an eighth of which are solved."""
THRESHOLD_ASKED, TAXELS_ASKED = 1e-3, 3e-3


def measure() -> dict[str, float]:
    """Threshold pressures in Pa, the largest difference of a taxel over the largest taxel, and the unknowns of both grasps."""
    pressures = [
        _run("annulus_icf", changes)["threshold_pressure"].value for changes in ({}, {"experiment.mesh.refinement": REFINED})
    ]
    grasps = [_run("grasp_lump_icf", changes) for changes in ({}, {"experiment.mesh": FINER})]
    usual, fine = (np.array([grasp[f"taxel_force_{side}"].value for side in JAWS]) for grasp in grasps)
    return {
        "threshold_pressure": pressures[0],
        "fine_threshold_pressure": pressures[1],
        "taxel_difference": float(np.abs(usual - fine).max() / fine.max()),
        "grasp_unknowns": float(grasps[0]["unknowns"].value),
        "fine_grasp_unknowns": float(grasps[1]["unknowns"].value),
    }


def rows(taken: dict[str, float]) -> list[tuple[str, str, str]]:
    """Rows of the performance table: what, what is asked, what was measured."""
    off = taken["threshold_pressure"] / taken["fine_threshold_pressure"] - 1
    usual, fine = (f"{taken[name]:,.0f}".replace(",", " ") for name in ("grasp_unknowns", "fine_grasp_unknowns"))
    return [
        (
            f"threshold pressure of `annulus_icf.yaml` against that on elements {REFINED:g} times as short",
            f"{100 * THRESHOLD_ASKED:g} %",
            f"{100 * off:+.3f} %",
        ),
        (
            f"taxels of `grasp_lump_icf.yaml`, {usual} unknowns, against {fine}, over the largest",
            f"{100 * TAXELS_ASKED:g} %",
            f"{100 * taken['taxel_difference']:.2f} %",
        ),
    ]


def _run(case: str, changes: dict[str, Any]) -> ts.Result:
    """The result of a shipped case with changes.

    Raises
    ------
    RuntimeError
        If it is no success.
    """
    result = ts.load_case(CASES / f"{case}.yaml", changes).run()
    if result.status != "converged":
        raise RuntimeError(f"{case}: {result.reason}")
    return result


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measure(), indent=2) + "\n")
