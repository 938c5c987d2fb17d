"""How far one material set is from another in uniaxial stress."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.identification.uniaxial import uniaxial_nominal_stress
from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs

POINTS = 200
"""Even stretches at which the sets are compared."""


class MaterialError(Evaluator):
    """Relative error of the uniaxial nominal stress of a material set against a reference set."""

    kind: Literal["material_error"] = "material_error"
    material: str
    """Shipped set that is judged."""
    reference: str
    """Shipped set that it stands for."""
    between: tuple[Annotated[float, Field(gt=0, lt=1)], Literal[1]] = (0.6, 1)
    """Stretches; at 1 both stresses vanish, so the last point lies one spacing below."""
    measure: Literal["max", "rms"]
    """Largest error, or root mean square."""

    @classmethod
    def example(cls) -> Self:
        """The stable set of the soft elastomer."""
        return cls(material="icf_stable", reference="icf_printed", measure="max")

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        stretch = np.linspace(*self.between, POINTS + 1)[:-1]
        judged, reference = (
            uniaxial_nominal_stress(named_material(name).material, stretch) for name in (self.material, self.reference)
        )
        error = judged / reference - 1
        return float(np.abs(error).max() if self.measure == "max" else np.sqrt(np.mean(error**2)))
