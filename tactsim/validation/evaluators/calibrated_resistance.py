"""Resistance of the sensor of 3.1.2 by its calibration line."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field

from tactsim.sensors.calibration import THESIS_LINE
from tactsim.units import Force
from tactsim.validation.evaluator import Evaluator, Inputs


class CalibratedResistance(Evaluator):
    """1/C in ohm at a force, by F = 20.94 C - 0.132."""

    unit: ClassVar[str] = "ohm"
    kind: Literal["calibrated_resistance"] = "calibrated_resistance"
    force: Annotated[Force, Field(ge=0)]
    """Force on the sensor."""

    @classmethod
    def example(cls) -> Self:
        """The end of the range."""
        return cls(force=25.0)

    def found(self, inputs: Inputs) -> float:
        """In ohm."""
        return float(1 / THESIS_LINE.conductance(self.force))
