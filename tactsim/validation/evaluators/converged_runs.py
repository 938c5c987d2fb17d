"""How many simulations of a study reached the threshold."""

from __future__ import annotations

from typing import Literal, Self

from tactsim.validation.evaluator import Evaluator, Inputs


class ConvergedRuns(Evaluator):
    """Number of runs of a study that converged: a bracket must not become narrower unnoticed."""

    kind: Literal["converged_runs"] = "converged_runs"
    study: str
    """Study of the table."""

    @classmethod
    def example(cls) -> Self:
        """The soft elastomer."""
        return cls(study="icf")

    def found(self, inputs: Inputs) -> float:
        """A count."""
        return float(sum(outcome.converged for outcome in inputs.study(self.study)))
