"""Figure of the indentation displacement over time or force, as Fig. 4.13."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.units import Force, Length, Time
from tactsim.validation.evaluator import Drawing, Inputs

POINTS = 200


class AnnulusIndentations(Drawing):
    """Displacement of the annulus above, exact rise of the tissue in its hole below, for several ratios of the radii."""

    kind: Literal["annulus_indentations"] = "annulus_indentations"
    title: str
    """Title of the figure."""
    over: Literal["time", "force"]
    """What runs along the axis, up to its value below; the other is held."""
    ratios: Annotated[tuple[float, ...], Field(min_length=1)]
    """Inner over outer radius."""
    force: Annotated[Force, Field(gt=0)]
    """Force, or the largest force."""
    time: Annotated[Time, Field(gt=0)]
    """Time since the force began, or the longest one."""
    outer_radius: Annotated[Length, Field(gt=0)] = 3e-3
    """Radius of the face."""
    times: Literal["retardation_times", "viscosities"] = "viscosities"
    """Reading of the column of times of Table 4.1."""
    compliance: Literal["tensile", "half_shear"] = "half_shear"
    """Reading of its compliance."""

    @classmethod
    def example(cls) -> Self:
        """As in the thesis, for two ratios."""
        return cls(title="Fig. 4.13", over="time", ratios=(0.1, 0.5), force=1.0, time=2.0)

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: both in m."""
        tissue = atrial_shear_compliance(self.times, self.compliance)
        x = np.linspace(0, self.time if self.over == "time" else self.force, POINTS)
        force, time = (self.force, x) if self.over == "time" else (x, self.time)
        upper: list[dict[str, Any]] = []
        lower: list[dict[str, Any]] = []
        for ratio in self.ratios:
            annulus = ViscoelasticAnnulus(self.outer_radius, ratio, tissue)
            displacement = annulus.creep_displacement(force, time)
            for curves, y in ((upper, displacement), (lower, annulus.rise(displacement))):
                curves.append({"label": f"ri/ro = {ratio:g}", "x": x.tolist(), "y": y.tolist(), "style": "line"})
        panels = [
            {"y_axis": "displacement", "unit": "m", "curves": upper},
            {"y_axis": "rise in the hole", "unit": "m", "curves": lower},
        ]
        axis = {"x_axis": self.over, "x_unit": "s" if self.over == "time" else "N", "even_panels": True}
        return {"form": "curves", "title": self.title, **axis, "panels": panels}
