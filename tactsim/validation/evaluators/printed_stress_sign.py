"""Where the printed stress formula turns negative in tension."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from scipy.optimize import brentq

from tactsim.errors import InputError
from tactsim.identification.uniaxial import uniaxial_stress_as_printed
from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs

SEARCHED = (1.001, 5.0)
"""Stretches between which the change of sign is looked for; the stress is zero at 1."""


class PrintedStressSign(Evaluator):
    """Stretch in tension at which the stress of 3.1.9 as printed (no c11) changes its sign."""

    kind: Literal["printed_stress_sign"] = "printed_stress_sign"
    material: str
    """Shipped set with c10 and c01."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer."""
        return cls(material="icf_printed")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        constants = named_material(self.material).material.model_dump()

        def stress(stretch: float) -> float:
            return float(uniaxial_stress_as_printed(constants["c10"], constants["c01"], np.array(stretch)))

        if stress(SEARCHED[0]) * stress(SEARCHED[1]) > 0:
            raise InputError(f"the printed stress of {self.material} keeps its sign up to a stretch of {SEARCHED[1]:g}")
        return float(brentq(stress, *SEARCHED, xtol=1e-12))
