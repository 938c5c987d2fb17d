"""Sign of the corrected stress formula in tension."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np

from tactsim.identification.uniaxial import uniaxial_nominal_stress
from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs


class CorrectedStress(Evaluator):
    """True uniaxial stress in Pa at a stretch by 3.1.9 corrected: W1 and W2 keep the terms of c11."""

    unit: ClassVar[str] = "Pa"
    kind: Literal["corrected_stress"] = "corrected_stress"
    material: str
    """Shipped set."""
    stretch: float
    """Stretch along the load."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer at the stretch where the printed form vanishes."""
        return cls(material="icf_printed", stretch=1.2)

    def found(self, inputs: Inputs) -> float:
        """In Pa."""
        material = named_material(self.material).material
        return float(uniaxial_nominal_stress(material, np.array([self.stretch]))[0]) * self.stretch
