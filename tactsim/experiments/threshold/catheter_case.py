"""What a case of a catheter tip with threshold sensors asks for."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.experiments.threshold.sampling import check_length
from tactsim.experiments.threshold.tip_model import ClosedFormTip, TipModel
from tactsim.experiments.threshold.valve_tissue import ValveSurface
from tactsim.model import FrozenModel
from tactsim.sensors.threshold.sensor_ring import SensorRing
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.units import Angle, Length, NonNegative, Positive, Speed, Time, format_quantity

STEEPEST = np.pi / 6 * (1 + 1e-12)
"""Largest tilt in rad of the tip: 30 degrees, whatever the rounding."""


class CatheterCase(FrozenModel):
    """The tissues, the tip with its ring of sensors, and how it is pressed on the surface."""

    surface: ValveSurface
    """The tissues."""
    ring: SensorRing = SensorRing()
    """The sensors."""
    model: TipModel = ClosedFormTip()
    """How the forces of the tissue are computed."""
    place: tuple[Length, Length]
    """Where the middle of the tip stands, x and y from the middle of the valve."""
    tilt: Annotated[Angle, Field(ge=0, le=STEEPEST)] = 0.0
    """Angle between tip and surface."""
    tilt_direction: Angle = 0.0
    """Where the tilted tip is lowest, from the x axis."""
    press: Positive[Length] = 1e-3
    """Displacement of the tip after its first sensor has touched."""
    speed: Positive[Speed] = 1e-3
    """Speed of the tip."""
    sensor: ThresholdSensor = ThresholdSensor()
    """Electronics of each sensor."""
    trials: Annotated[int, Field(ge=1, le=100_000)] = 200
    """Repeated touches at the same place."""
    lead: Positive[Time] = 0.5
    """Recording before the first touch."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    def _scalable(self) -> bool:
        """Whether a given threshold can take the place of the computed one."""
        return self.model.kind == "closed_form" and all(one.relaxation is None for one in self.surface.tissues)

    @model_validator(mode="after")
    def _deep_enough(self) -> Self:
        for tissue in self.surface.tissues:
            most = format_quantity(tissue.thickness, "m")
            for name, given in (("press", self.press), ("ring.recess", self.ring.recess)):
                if given >= tissue.thickness:
                    length = format_quantity(given, "m")
                    raise ValueError(f"{name} {length} must be smaller than the thickness of the {tissue.name}, {most}")
            if tissue.threshold_pressure is not None and not self._scalable():
                raise ValueError(
                    f"the {tissue.name} has a threshold_pressure, which needs model: {{kind: closed_form}} and elastic tissues; "
                    "leave it out"
                )
        check_length("lead and press / speed take", self.lead + self.press / self.speed, self.sensor.chain.sampling_rate)
        return self
