"""What a simulation of Table 3.3 finds for one elastomer."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError, UnknownName
from tactsim.experiments.durometer.elastomer_report import RankingReport
from tactsim.validation.evaluator import Evaluator, Inputs


class ElastomerValue(Evaluator):
    """A value of the history of a ranking of elastomers."""

    kind: Literal["elastomer_value"] = "elastomer_value"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    shape: Annotated[int, Field(ge=1)]
    """Shape of energy, counted from 1 in the order of the case."""
    elastomer: Annotated[int, Field(ge=1)]
    """Elastomer, counted from 1 in the order of Table 3.3."""
    quantity: str = "predicted_reading"
    """Name in the history."""

    @property
    def found_unit(self) -> str:
        """Unit of the quantity."""
        return RankingReport.UNITS.get(self.quantity, "1")

    @classmethod
    def example(cls) -> Self:
        """The predicted reading of the hardest elastomer."""
        return cls(study="elastomers", run="default", shape=1, elastomer=1)

    def found(self, inputs: Inputs) -> float:
        """In SI."""
        outcome = inputs.run(self.study, self.run)
        if not outcome.converged:
            raise InputError(f"{self.study}, {self.run} did not converge: {outcome.reason}")
        if self.quantity not in outcome.history:
            raise UnknownName(f"history value of {self.study}, {self.run}", self.quantity, outcome.history)
        shape, elastomer = (np.array(outcome.history[name]) for name in ("shape", "elastomer"))
        here = np.flatnonzero((shape == self.shape) & (elastomer == self.elastomer))
        if len(here) != 1:
            raise InputError(f"{self.study}, {self.run} has no elastomer {self.elastomer} with a shape {self.shape}")
        return float(outcome.history[self.quantity][here[0]])
