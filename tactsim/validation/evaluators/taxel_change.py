"""How the force of a taxel changes from simulation to simulation."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.units import Length
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.taxel_readings import Side, taxel, taxels_at


class TaxelChange(Evaluator):
    """Least or greatest change of the force on one taxel.

    ``along`` compares each run with the one before it, the force of its base taken off; ``from base`` each with its base.
    A claim that the force rises holds if the least change is positive; that it falls, if the greatest is negative.
    """

    unit: ClassVar[str] = "N"
    kind: Literal["taxel_change"] = "taxel_change"
    study: str
    """Study of the table."""
    change: Literal["least along", "greatest along", "least from base", "greatest from base"]
    """Which of the changes."""
    runs: Annotated[tuple[str, ...], Field(min_length=1)]
    """Runs in the order of the change."""
    bases: tuple[str, ...] = ()
    """Runs without the inclusion: one for each run (on the same mesh, whose error is then taken off), or one for all."""
    side: Side | Literal["upper less lower"] = "upper"
    """Jaw, or the difference of both."""
    taxel: tuple[int, int] = (2, 2)
    """Row and column, counted from 1."""
    closing: Length | None = None
    """Closing of each jaw at an accepted step; by default the last."""

    @model_validator(mode="after")
    def _comparable(self) -> Self:
        if len(self.bases) not in (0, 1, len(self.runs)):
            raise ValueError(f"{len(self.bases)} bases for {len(self.runs)} runs; give none, one, or one for each")
        if "base" in self.change and not self.bases:
            raise ValueError(f"change {self.change}: there is no base")
        if "along" in self.change and len(self.runs) < 2:
            raise ValueError(f"change {self.change}: one run makes no change")
        return self

    @classmethod
    def example(cls) -> Self:
        """A lump that rises."""
        return cls(study="lumps", runs=("deep", "near"), change="least along")

    def found(self, inputs: Inputs) -> float:
        """In N."""
        forces = self._forces(inputs, self.runs)
        excess = forces - self._forces(inputs, self.bases) if self.bases else forces
        changes = excess if "base" in self.change else np.diff(excess)
        return float(changes.min() if "least" in self.change else changes.max())

    def _forces(self, inputs: Inputs, runs: tuple[str, ...]) -> np.ndarray:
        if self.side == "upper less lower":
            return self._of("upper", inputs, runs) - self._of("lower", inputs, runs)
        return self._of(self.side, inputs, runs)

    def _of(self, side: Side, inputs: Inputs, runs: tuple[str, ...]) -> np.ndarray:
        return np.array([taxel(taxels_at(inputs, (self.study, run), side, self.closing), self.taxel) for run in runs])
