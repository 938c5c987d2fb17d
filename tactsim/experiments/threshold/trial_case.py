"""What a case of repeated indentations with a threshold sensor asks for."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from tactsim.experiments.threshold.sampling import FINER
from tactsim.experiments.threshold.source import AnySource
from tactsim.model import FrozenModel, check_increasing
from tactsim.sensors.electronics.low_pass import LowPass
from tactsim.sensors.electronics.noise import Noise
from tactsim.sensors.threshold.threshold_sensor import ThresholdSensor
from tactsim.units import Frequency, NonNegative, Positive, Speed, Time, Voltage


class TrialCase(FrozenModel):
    """Source of the forces, sensor, and the speeds, noises and cut-off frequencies that are combined."""

    source: AnySource
    """Where the forces come from."""
    sensor: ThresholdSensor = ThresholdSensor()
    """The sensor and its electronics; ``cutoffs`` and ``noises`` replace the cut-off and the white noise in it."""
    speeds: Annotated[tuple[Positive[Speed], ...], Field(min_length=1)]
    """Speeds of indentation, increasing."""
    noises: Annotated[tuple[NonNegative[Voltage], ...], Field(min_length=1)]
    """Root mean squares of the white noise of a sample, increasing; the line pick-up is that of the chain."""
    cutoffs: Annotated[tuple[Positive[Frequency], ...], Field(min_length=1)]
    """Cut-off frequencies of the low pass, increasing."""
    trials: Annotated[int, Field(ge=1, le=10_000)] = 50
    """Indentations of each combination."""
    lead: Positive[Time] = 0.5
    """Recording before the tissue is touched, in which a trigger is already false."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        check_increasing(speeds=self.speeds, noises=self.noises, cutoffs=self.cutoffs)
        if self.sensor.chain.low_pass is None:
            raise ValueError("the chain has no low pass whose cut-off could vary; set sensor.chain.low_pass")
        for low_pass in self.low_passes:
            low_pass.check(self.sensor.chain.sampling_rate)
            low_pass.check(FINER * self.sensor.chain.sampling_rate)  # of the ideal chain that the errors are compared with
        return self

    @property
    def low_passes(self) -> list[LowPass]:
        """The low pass at each cut-off."""
        order = self.sensor.chain.low_pass.order if self.sensor.chain.low_pass else 1
        return [LowPass(cutoff=cutoff, order=order) for cutoff in self.cutoffs]

    @property
    def noise_levels(self) -> list[Noise]:
        """The noise at each level."""
        return [self.sensor.chain.noise.model_copy(update={"white": white}) for white in self.noises]
