"""What a threshold sensor reports when its small sensor must first be pressed up to a level."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field
from scipy.optimize import brentq

from tactsim.errors import InputError
from tactsim.experiments.threshold.source import CurveSource
from tactsim.units import Force, Length, format_quantity
from tactsim.validation.evaluator import Evaluator, Inputs


class ThresholdAtLevel(Evaluator):
    """Force on the plate when the small sensor bears the level, over that at the touch; slowly, without noise and filter."""

    kind: Literal["threshold_at_level"] = "threshold_at_level"
    curve: str
    """Stored forces of both sensors, relative to the table."""
    level: Annotated[Force, Field(gt=0)]
    """Force on the small sensor at which it triggers."""
    inner_radius: Length
    """Radius of the hole."""
    outer_radius: Length
    """Radius of the face."""
    recess: Length
    """Depth of the small sensor."""

    @classmethod
    def example(cls) -> Self:
        """The sensor of chapter 3 on ICF at the resolution of 3.1.2."""
        curve = "../data/annulus_icf_signals.csv"
        return cls(curve=curve, level=0.1, inner_radius=1.5e-3, outer_radius=3e-3, recess=0.8e-3)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless, 1 for a sensor that triggers at the touch.

        Raises
        ------
        InputError
            If the curve ends below the level.
        """
        source = CurveSource(
            path=str(inputs.folder / self.curve),
            inner_radius=self.inner_radius,
            outer_radius=self.outer_radius,
            recess=self.recess,
        )
        approach = source.tissue().approach(1e-3)

        def beyond(time: float) -> float:
            return float(approach.at(np.array(time))[1]) - self.level

        if beyond(approach.duration) < 0:
            raise InputError(f"{self.curve}: the small sensor never bears {format_quantity(self.level, 'N')}")
        plate = approach.at(np.array(brentq(beyond, approach.touch, approach.duration)))[0]
        return float(plate) / approach.threshold_force
