"""Figure of the threshold force over A/L for tissues of several hardnesses (3.1.1)."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.units import Length
from tactsim.validation.evaluator import Drawing, Inputs


class RecessOverHardness(Drawing):
    """Threshold force over A/L: one run gives every smaller recess, and the force scales exactly with the modulus."""

    kind: Literal["recess_over_hardness"] = "recess_over_hardness"
    title: str
    """Title of the figure."""
    study: str
    """Study of the table."""
    run: str
    """Run of the study, up to the largest recess."""
    tissue: str
    """What the run simulates."""
    hole: Annotated[Length, Field(gt=0)]
    """Inner diameter A of the annulus."""
    shallowest: Annotated[Length, Field(gt=0)]
    """Smallest recess that is drawn."""
    hardness: Annotated[tuple[float, ...], Field(min_length=1)]
    """Moduli over that of the simulated tissue."""

    @classmethod
    def example(cls) -> Self:
        """From soft to hard."""
        return cls(title="A/L", study="icf", run="default", tissue="ICF", hole=3e-3, shallowest=0.3e-3, hardness=(1, 4))

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: force in N over A/L."""
        outcome = inputs.run(self.study, self.run)
        rise, force = (np.array(outcome.history.get(name, ())) for name in ("tissue_rise", "reaction_force"))
        shown = rise >= self.shallowest
        ratio = self.hole / rise[shown]
        curves = [
            {
                "label": f"{self.tissue}, modulus x {factor:g}",
                "x": ratio.tolist(),
                "y": (factor * force[shown]).tolist(),
                "style": "line",
            }
            for factor in self.hardness
        ]
        panel = {"y_axis": "threshold force", "unit": "N", "curves": curves, "logarithmic": True}
        return {"form": "curves", "title": self.title, "x_axis": "A/L", "x_unit": "", "panels": [panel]}
