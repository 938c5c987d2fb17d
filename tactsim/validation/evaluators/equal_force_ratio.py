"""How the recess must change with the hardness of the tissue."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.errors import InputError
from tactsim.units import Length
from tactsim.validation.evaluator import Evaluator, Inputs


class EqualForceRatio(Evaluator):
    """A/L for a harder tissue over A/L for the simulated one, so that both have the same threshold force.

    All forces scale with the modulus, so the force of the history of one run, times the hardness, is that of the harder tissue
    at every smaller recess.
    """

    kind: Literal["equal_force_ratio"] = "equal_force_ratio"
    study: str
    """Study of the table."""
    run: str
    """Run of the study."""
    recess: Annotated[Length, Field(gt=0)]
    """Recess L for the simulated tissue."""
    hardness: Annotated[float, Field(gt=1)]
    """Modulus of the harder tissue over that of the simulated one."""

    @classmethod
    def example(cls) -> Self:
        """Twice as hard."""
        return cls(study="icf", run="default", recess=0.8e-3, hardness=2)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        history = inputs.run(self.study, self.run).history
        rise, force = (np.array(history.get(name, ())) for name in ("tissue_rise", "reaction_force"))
        if rise.size < 2 or rise.max() < self.recess * (1 - 1e-4):
            raise InputError(f"{self.study}, {self.run} does not reach a rise of {self.recess:g} m")
        rising = rise[: rise.argmax() + 1]
        threshold = np.interp(self.recess, rising, force[: rising.size])
        shallower = np.interp(threshold / self.hardness, force[: rising.size], rising)
        return float(self.recess / shallower)
