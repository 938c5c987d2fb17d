"""Young's modulus at small strain."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs


class InitialModulus(Evaluator):
    """E = 3 G of an incompressible material set, in Pa: 6 (c10 + c01) for Mooney-Rivlin."""

    unit: ClassVar[str] = "Pa"
    kind: Literal["initial_modulus"] = "initial_modulus"
    material: str
    """Shipped set."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer of Table 3.1."""
        return cls(material="icf_printed")

    def found(self, inputs: Inputs) -> float:
        """In Pa."""
        return 3 * named_material(self.material).material.shear_modulus
