"""A quantity of one simulation."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.errors import InputError
from tactsim.validation.evaluator import Evaluator, Inputs


class RunQuantity(Evaluator):
    """What a simulation found."""

    kind: Literal["run_quantity"] = "run_quantity"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    quantity: str
    """Name of the quantity."""
    si_unit: str = "1"
    """SI unit of the quantity."""

    @property
    def found_unit(self) -> str:
        """The SI unit."""
        return self.si_unit

    @classmethod
    def example(cls) -> Self:
        """Largest difference of a run from the closed form."""
        return cls(study="small_load", run="step", quantity="closed_form_difference")

    def found(self, inputs: Inputs) -> float:
        """The quantity in SI."""
        outcome = inputs.run(self.study, self.run)
        if not outcome.converged or self.quantity not in outcome.quantities:
            raise InputError(f"{self.study}, {self.run} has no {self.quantity}: {outcome.reason}")
        return outcome.quantities[self.quantity]
