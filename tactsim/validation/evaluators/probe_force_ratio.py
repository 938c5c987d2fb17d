"""How hard a tissue feels to the switch probe, compared with another tissue or another rate."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.units import FrozenModel, Length, Speed, format_quantity
from tactsim.validation.evaluator import Evaluator, Inputs
from tactsim.validation.study import RunOutcome

SAME = 1e-9
"""Relative difference of two rates that is round-off."""


class Press(FrozenModel):
    """A tissue at a rate."""

    tissue: Annotated[int, Field(ge=1)]
    """Number of the tissue in the case, from 1."""
    rate: Annotated[Speed, Field(gt=0)]
    """Rate of indentation."""


class ProbeForceRatio(Evaluator):
    """Force on the probe over that of another tissue or rate, both at the same depth on the way in."""

    kind: Literal["probe_force_ratio"] = "probe_force_ratio"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    press: Press
    """Numerator."""
    over: Press
    """Denominator."""
    depth: Annotated[Length, Field(gt=0)] = 5e-3
    """Depth."""

    @classmethod
    def example(cls) -> Self:
        """Tissue 2 over tissue 1 at 1 mm/s."""
        return cls(study="tissues", run="default", press=Press(tissue=2, rate=1e-3), over=Press(tissue=1, rate=1e-3))

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        outcome = inputs.run(self.study, self.run)
        if not outcome.converged:
            raise InputError(f"{self.study}, {self.run} has no forces: {outcome.reason}")
        return self._force(outcome, self.press) / self._force(outcome, self.over)

    def _force(self, outcome: RunOutcome, press: Press) -> float:
        """In N, linear between the samples that the history keeps."""
        tissue, rate, depth, force = (np.array(outcome.history[name]) for name in ("tissue", "rate", "depth", "force"))
        mine = np.flatnonzero((tissue == press.tissue) & (np.abs(rate - press.rate) <= SAME * press.rate))
        if not mine.size or depth[mine].max() < self.depth * (1 - SAME):
            speed, deep = format_quantity(press.rate, "m/s"), format_quantity(self.depth, "m")
            raise InputError(f"{self.study}, {self.run} has no touch of tissue {press.tissue} at {speed} down to {deep}")
        way_in = mine[: int(depth[mine].argmax()) + 1]
        return float(np.interp(self.depth, depth[way_in], force[way_in]))
