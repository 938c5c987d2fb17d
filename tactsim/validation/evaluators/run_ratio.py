"""One simulation over another."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from tactsim.errors import InputError
from tactsim.validation.evaluator import Evaluator, Inputs

RunName = Annotated[tuple[str, str], Field()]
"""Study and run."""


class RunRatio(Evaluator):
    """A quantity of one run over that of another."""

    kind: Literal["run_ratio"] = "run_ratio"
    run: RunName
    """Study and run of the numerator."""
    over: RunName
    """Study and run of the denominator."""
    quantity: str = "threshold_pressure"
    """Name of the quantity."""

    @classmethod
    def example(cls) -> Self:
        """The hard elastomer over the soft one."""
        return cls(run=("b1a", "default"), over=("icf", "default"))

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        values = []
        for study, identifier in (self.run, self.over):
            outcome = inputs.run(study, identifier)
            if not outcome.converged or self.quantity not in outcome.quantities:
                raise InputError(f"{study}, {identifier} has no {self.quantity}: {outcome.reason}")
            values.append(outcome.quantities[self.quantity])
        return values[0] / values[1]
