"""How much a pulse changes the force of the taxels."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.units import Time
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.taxel_readings import SIDES, grasp, taxel_history


class TaxelPulse(Evaluator):
    """Largest difference between the greatest and the least force of a taxel, over all taxels of both jaws, from a time on."""

    unit: ClassVar[str] = "N"
    kind: Literal["taxel_pulse"] = "taxel_pulse"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    start: Annotated[Time, Field(ge=0)]
    """Time at which the pulse begins."""

    @classmethod
    def example(cls) -> Self:
        """After a rise of a second."""
        return cls(study="pulse", run="above diastole", start=1.0)

    def found(self, inputs: Inputs) -> float:
        """In N."""
        outcome = grasp(inputs, (self.study, self.run))
        beating = np.array(outcome.history["time"]) >= self.start * (1 - 1e-9)
        if beating.sum() < 2:
            raise InputError(f"{self.run} has {beating.sum()} steps from {self.start:g} s on; a change needs two")
        return max(float(np.ptp(taxel_history(outcome, side)[beating], axis=0).max()) for side in SIDES)
