"""A constant that a fit finds in the uniaxial curve of a material set."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.errors import UnknownName
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.uniaxial_curves import fitted


class FittedConstant(Evaluator):
    """A constant in Pa of a least-squares fit to the uniaxial compression curve of a set (3.1.9 with c11)."""

    unit: ClassVar[str] = "Pa"
    kind: Literal["fitted_constant"] = "fitted_constant"
    material: str
    """Shipped set whose curve is fitted."""
    form: str
    """Form of the fit, as in ``tactsim material --fit``."""
    constant: str
    """Name of the constant."""

    @classmethod
    def example(cls) -> Self:
        """The first constant of the soft elastomer."""
        return cls(material="icf_printed", form="3-parameter", constant="c10")

    def found(self, inputs: Inputs) -> float:
        """In Pa."""
        constants = fitted(self.material, self.form).material.model_dump(exclude={"kind", "bulk_modulus"})
        if self.constant not in constants:
            raise UnknownName("constant", self.constant, constants)
        return float(constants[self.constant])
