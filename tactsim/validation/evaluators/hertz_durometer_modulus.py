"""The modulus that a Shore reading means by Hertz."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from tactsim.analytic.durometer import DurometerScale, hertz_modulus
from tactsim.contact.rod import Rod
from tactsim.validation.evaluator import Evaluator, Inputs


class HertzDurometerModulus(Evaluator):
    """Young's modulus in Pa of the incompressible half-space on which Hertz's sphere under the spring gives the reading."""

    unit: ClassVar[str] = "Pa"
    kind: Literal["hertz_durometer_modulus"] = "hertz_durometer_modulus"
    reading: float
    """Shore reading."""
    scale: DurometerScale = DurometerScale()
    """Travel and spring."""
    indentor: Rod = Rod()
    """The indentor, of which the end counts."""

    @classmethod
    def example(cls) -> Self:
        """The hard elastomer of Table 3.2."""
        return cls(reading=36)

    def found(self, inputs: Inputs) -> float:
        """In Pa."""
        return hertz_modulus(self.reading, self.scale, self.indentor.radius)
