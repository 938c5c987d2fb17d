"""How much of a frequency the low pass lets through."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tactsim.sensors.low_pass import LowPass
from tactsim.units import Frequency
from tactsim.validation.evaluator import Evaluator, Inputs


class FilterTransfer(Evaluator):
    """Amplitude out over in of a Butterworth low pass, dimensionless."""

    kind: Literal["filter_transfer"] = "filter_transfer"
    cutoff: Annotated[Frequency, Field(gt=0)]
    """Cut-off frequency."""
    order: Annotated[int, Field(ge=1, le=8)] = 1
    """Order."""
    frequency: Annotated[Frequency, Field(gt=0)] = 60.0
    """Frequency of the pick-up."""
    sampling_rate: Annotated[Frequency, Field(gt=0)] | None = None
    """Of the digital filter; null is the analog one."""

    @model_validator(mode="after")
    def _sampled(self) -> Self:
        if self.sampling_rate is not None:
            LowPass(cutoff=self.cutoff, order=self.order).check(self.sampling_rate)
        return self

    @classmethod
    def example(cls) -> Self:
        """The filter of 3.1.2."""
        return cls(cutoff=10.0)

    def found(self, inputs: Inputs) -> float:
        """Dimensionless."""
        return float(LowPass(cutoff=self.cutoff, order=self.order).gain(self.frequency, self.sampling_rate))
