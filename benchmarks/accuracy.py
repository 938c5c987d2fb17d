"""How far the main case and the default grasp are from finer meshes; prints JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

import tactsim as ts
from tactsim.experiments.grasp.model import grasp_mesh, grasp_model
from tactsim.experiments.grasp.path import grasp_path
from tactsim.interfaces.taxel_layout import JAWS
from tactsim.mechanics.fields.volume_ratios import poor_share

CASES = Path(__file__).parents[1] / "cases"
REFINED = 3.0
"""Elements of `annulus_icf` are this many times as short: a minute or two, 48 876 unknowns instead of 6 395."""
FINER = {"kind": "graded", "size": "1.6 mm", "inclusion_size": "0.8 mm", "edge_size": "0.3 mm", "growth": 0.5}
"""Cells of the grasp: 467 304 unknowns instead of 107 306, an eighth of which are solved."""
THRESHOLD_ASKED, TAXELS_ASKED = 1e-3, 3e-3
OFF, VOLUME_ASKED = 0.02, 0.999
"""Error of a volume ratio that counts, and the part of the volume that has less."""


def measure() -> dict[str, float]:
    """Threshold pressures in Pa; of the grasps the largest difference of a taxel over the largest one, unknowns, volume kept."""
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
        "volume_kept": _volume_kept("grasp_lump_icf"),
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
        (
            f"volume of `grasp_lump_icf.yaml` with ratios off by less than {100 * OFF:g} %",
            f"{100 * VOLUME_ASKED:g} %",
            f"{100 * taken['volume_kept']:.2f} %",
        ),
    ]


def _volume_kept(case: str) -> float:
    """Part of the volume of a grasp whose ratios are off by less than `OFF` at the end."""
    grasp = ts.load_case(CASES / f"{case}.yaml").experiment
    assert isinstance(grasp, ts.Grasp)
    model = grasp_model(grasp, grasp_mesh(grasp))
    last = list(grasp_path(grasp, model).states())[-1][0].contact
    return 1 - poor_share(model.body, model.body.volume_error(last.unknowns, last.kinematics), OFF)


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
