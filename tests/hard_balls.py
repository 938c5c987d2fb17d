"""Hard balls in a block between smooth jaws that close a little, for tests of what the mesh around them does to the taxels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tactsim.experiments.grasp.grasp import Grasp
from tactsim.interfaces.taxel_layout import JAWS

HARD = {"kind": "neo_hookean", "c10": 500e3}


def pressed_balls(
    centers: Sequence[tuple[float, float, float]], radius: float, tissue: Any, cells: Mapping[str, float]
) -> np.ndarray:
    """Forces (jaw, row, column) in N after a closing of 0.1 mm; lengths in m, ``cells`` are the sizes of graded ones."""
    result = Grasp.model_validate(
        {
            "block": {"size": (40e-3, 40e-3, 20e-3), "tissue": tissue},
            "inclusions": [{"shape": {"kind": "sphere", "center": at, "radius": radius}, "material": HARD} for at in centers],
            "matrix": {"rows": 3, "columns": 3, "pitch": 10e-3, "size": 9e-3},
            "contact": {"kind": "coulomb", "friction": 0.0},
            "loading": {"control": "displacement", "pieces": [{"kind": "ramp", "to": 1e-4, "duration": 1.0}]},
            "mesh": {"kind": "graded", **cells},
            "time": {"steps": 1},
        }
    ).run()
    assert result.status == "converged"
    return np.array([result.quantities[f"taxel_force_{side}"].value for side in JAWS])
