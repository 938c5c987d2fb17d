"""What dynamic mechanical analysis would measure on the tissue of Table 4.1."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import table_4_1
from tactsim.units import Frequency
from tactsim.validation.evaluator import Evaluator, Inputs


class AtrialOscillation(Evaluator):
    """A complex modulus in Pa, a compliance in 1/Pa or tan delta at a frequency, of eq. 4.3.8."""

    kind: Literal["atrial_oscillation"] = "atrial_oscillation"
    quantity: Literal[
        "complex_modulus", "elastic_modulus", "viscous_modulus", "loss_tangent", "elastic_compliance", "viscous_compliance"
    ]
    """What is measured."""
    frequency: Annotated[Frequency, Field(gt=0)]
    """Frequency of the test."""
    times: Literal["retardation_times", "viscosities"] = "retardation_times"
    """Reading of the column of times."""

    @classmethod
    def example(cls) -> Self:
        """The slowest test."""
        return cls(quantity="complex_modulus", frequency=1.0)

    @property
    def found_unit(self) -> str:
        """Pa, 1/Pa or 1."""
        return "1" if self.quantity == "loss_tangent" else "1/Pa" if self.quantity.endswith("compliance") else "Pa"

    def found(self, inputs: Inputs) -> float:
        """In Pa, 1/Pa or 1."""
        compliance = complex(table_4_1(self.times).complex_compliance(2 * np.pi * self.frequency))
        modulus = 1 / compliance
        return {
            "complex_modulus": abs(modulus),
            "elastic_modulus": modulus.real,
            "viscous_modulus": modulus.imag,
            "loss_tangent": modulus.imag / modulus.real,
            "elastic_compliance": compliance.real,
            "viscous_compliance": -compliance.imag,
        }[self.quantity]
