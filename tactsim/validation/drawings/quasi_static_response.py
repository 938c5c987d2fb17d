"""Figure of the response to a preload and a harmonic load, as Fig. 4.14."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field

from tactsim.analytic.atrial import atrial_shear_compliance
from tactsim.analytic.histories import harmonic
from tactsim.analytic.viscoelastic_annulus import ViscoelasticAnnulus
from tactsim.units import Force, Length, Time
from tactsim.validation.evaluator import Drawing, Inputs
from tactsim.validation.evaluators.load_transform import DELAY, FREQUENCY, STATIC

POINTS = 601


class QuasiStaticResponse(Drawing):
    """Displacement for several ratios of the radii, one panel per amplitude; negative into the tissue, as 4.7.1 has it."""

    kind: Literal["quasi_static_response"] = "quasi_static_response"
    title: str
    """Title of the figure."""
    ratios: Annotated[tuple[float, ...], Field(min_length=1)]
    """Inner over outer radius."""
    amplitudes: Annotated[tuple[Force, ...], Field(min_length=1, max_length=2)]
    """Amplitudes of the harmonic load."""
    end: Annotated[Time, Field(gt=0)]
    """Longest time."""
    outer_radius: Annotated[Length, Field(gt=0)] = 3e-3
    """Radius of the face."""

    @classmethod
    def example(cls) -> Self:
        """Both amplitudes of E9."""
        return cls(title="Fig. 4.14", ratios=(0.1, 0.5), amplitudes=(0.25, 0.2), end=6.0)

    def data(self, inputs: Inputs) -> dict[str, Any]:
        """Form ``curves``: displacement in m over time in s, with all eight units in the reading of 4.6.4."""
        tissue = atrial_shear_compliance("viscosities", "half_shear")
        times = np.linspace(0, self.end, POINTS)
        panels = []
        for amplitude in self.amplitudes:
            load = harmonic(amplitude, FREQUENCY, start=DELAY, mean=STATIC)
            curves = [
                {
                    "label": f"ri/ro = {ratio:g}",
                    "x": times.tolist(),
                    "y": ViscoelasticAnnulus(self.outer_radius, ratio, tissue).displacement(load, times).tolist(),
                    "style": "line",
                }
                for ratio in self.ratios
            ]
            panels.append({"y_axis": f"displacement at {amplitude:g} N", "unit": "m", "curves": curves})
        axis = {"x_axis": "time", "x_unit": "s", "even_panels": True}
        return {"form": "curves", "title": self.title, **axis, "panels": panels}
