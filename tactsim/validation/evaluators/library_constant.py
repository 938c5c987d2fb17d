"""A constant of a shipped material set."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.errors import UnknownName
from tactsim.materials.library import named_material
from tactsim.validation.evaluator import Evaluator, Inputs


class LibraryConstant(Evaluator):
    """A constant in Pa as the library holds it."""

    unit: ClassVar[str] = "Pa"
    kind: Literal["library_constant"] = "library_constant"
    material: str
    """Shipped set."""
    constant: str
    """Name of the constant."""

    @classmethod
    def example(cls) -> Self:
        """The first constant of the soft elastomer."""
        return cls(material="icf_printed", constant="c10")

    def found(self, inputs: Inputs) -> float:
        """In Pa."""
        constants = named_material(self.material).material.model_dump(exclude={"kind", "bulk_modulus"})
        if self.constant not in constants:
            raise UnknownName("constant", self.constant, constants)
        return float(constants[self.constant])
