"""How alike the times of Table 4.1 are."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.validation.atrial_units import numbered_units
from tactsim.validation.evaluator import Evaluator, Inputs


class AtrialTimeGroup(Evaluator):
    """Smallest spread, largest over smallest - 1, of any so many of the eight printed times; or how many lie within a spread."""

    kind: Literal["atrial_time_group"] = "atrial_time_group"
    size: Annotated[int, Field(ge=2, le=8)] | None = None
    """Number of times whose spread is asked for."""
    spread: Annotated[float, Field(gt=0)] = 0.0261
    """Spread within which the largest group is counted, if no size is given."""

    @classmethod
    def example(cls) -> Self:
        """The six slow units."""
        return cls(size=6)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless, or a count."""
        times = np.sort(numbered_units("retardation_times")[1])
        if self.size is not None:
            return float((times[self.size - 1 :] / times[: times.size - self.size + 1]).min() - 1)
        return float((times[None, :] / times[:, None] - 1 <= self.spread).sum(axis=1, where=times >= times[:, None]).max())
