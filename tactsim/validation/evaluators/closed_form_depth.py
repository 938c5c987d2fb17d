"""The displacement at which a simulation has left the closed form."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.materials.library import named_material
from tactsim.validation.closed_form_limits import ComparedRun
from tactsim.validation.evaluator import Evaluator, Inputs


class ClosedFormDepth(Evaluator):
    """Displacement over the outer radius from which on force and closed form differ by more than a part."""

    kind: Literal["closed_form_depth"] = "closed_form_depth"
    study: str
    """Study of the table."""
    compared: ComparedRun
    """The simulation."""
    form: Literal["half_space", "layer"] = "layer"
    """Closed form."""
    part: Annotated[float, Field(gt=0)] = 0.1
    """Relative difference of the force."""

    @classmethod
    def example(cls) -> Self:
        """ICF, 10 mm thick."""
        return cls(study="depth", compared=ComparedRun(run="icf", material=named_material("icf_stable").material, thickness=1e-2))

    def found(self, inputs: Inputs) -> float:
        """Dimensionless; zero if they differ from the beginning, the largest displacement if they never do."""
        outcome = inputs.run(self.study, self.compared.run)
        depth, difference = self.compared.depth(outcome), np.abs(self.compared.departure(outcome, self.form))
        beyond = np.flatnonzero(difference > self.part)
        if not beyond.size:
            return float(depth[-1])
        first = int(beyond[0])
        if first == 0:
            return 0.0
        return float(np.interp(self.part, difference[first - 1 : first + 1], depth[first - 1 : first + 1]))
