"""How far the taxels of a grasp are from a symmetry that it should have."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np

from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.taxel_readings import SIDES, taxels_at


class TaxelAsymmetry(Evaluator):
    """Largest difference of mirrored taxels over the largest force of a taxel."""

    kind: Literal["taxel_asymmetry"] = "taxel_asymmetry"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    mirror: Literal["left_right", "front_back", "upper_lower"]
    """Columns, rows or jaws that are exchanged."""

    @classmethod
    def example(cls) -> Self:
        """A lump in the middle."""
        return cls(study="lumps", run="middle", mirror="left_right")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        forces = np.stack([taxels_at(inputs, (self.study, self.run), side) for side in SIDES])
        axis = {"upper_lower": 0, "front_back": 1, "left_right": 2}[self.mirror]
        return float(np.abs(forces - np.flip(forces, axis)).max() / np.abs(forces).max())
