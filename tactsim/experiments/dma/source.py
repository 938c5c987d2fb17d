"""Where the data of a dynamic mechanical analysis come from: the thesis's model, a file of moduli, or raw signals."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.identification.dma_data import FEWEST_FREQUENCIES, THESIS_FREQUENCIES, DmaData, read_dma, synthetic_dma
from tactsim.identification.dma_signals import dma_from_signals, read_dma_signals
from tactsim.model import FrozenModel
from tactsim.outside.input_path import InputPath
from tactsim.units import Area, Frequency, Length, check_increasing

Seed = Annotated[int, Field(ge=0)]


class SyntheticDma(FrozenModel):
    """Data made from the model of Table 4.1, as the data of Fig. 4.10 are not printed."""

    kind: Literal["synthetic"] = "synthetic"
    times: Literal["retardation_times", "viscosities"] = "retardation_times"
    """The column of times of Table 4.1: in s, as eq. 4.3.8 uses it, or viscosities, as eq. 4.6.4 uses it."""
    frequencies: Annotated[tuple[Annotated[Frequency, Field(gt=0)], ...], Field(min_length=FEWEST_FREQUENCIES)] = (
        THESIS_FREQUENCIES
    )
    """Test frequencies, increasing; by default the eight of thesis section 4.4."""
    noise: Annotated[float, Field(ge=0, le=0.2)] = 0.02
    """Relative standard deviation of the independent Gaussian noise of each elastic and viscous compliance."""
    seed: Seed = 1
    """Seed of the noise."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        check_increasing(frequencies=self.frequencies)
        return self

    @property
    def model(self) -> GeneralizedKelvin:
        """The true model."""
        return table_4_1(self.times)

    def measured(self) -> DmaData:
        """The data."""
        return synthetic_dma(self.model, self.frequencies, self.noise, self.seed)


class MeasuredDma(FrozenModel):
    """Data read from a file."""

    kind: Literal["file"] = "file"
    path: InputPath
    """CSV file, beside the case or in the working folder; header such as
    ``frequency [Hz], storage modulus [kPa], loss modulus [kPa]``."""
    noise: Annotated[float, Field(gt=0, le=0.2)] | None = None
    """Relative standard deviation of each number; null estimates it from the residuals of the fit."""

    @property
    def model(self) -> None:
        """No true model is known."""
        return None

    def measured(self) -> DmaData:
        """The data."""
        return read_dma(self.path, self.noise)


class SignalsTest(FrozenModel):
    """The signals of one test at one frequency."""

    path: InputPath
    """CSV file, beside the case or in the working folder; header such as ``time [s], load [N], displacement [mm]``."""
    frequency: Annotated[Frequency, Field(gt=0)]
    """Test frequency."""


class SignalsDma(FrozenModel):
    """Load and displacement signals; amplitude and phase by least squares, the noise from what the sines leave."""

    kind: Literal["signals"] = "signals"
    tests: Annotated[tuple[SignalsTest, ...], Field(min_length=FEWEST_FREQUENCIES)]
    """One file for each frequency."""
    area: Annotated[Area, Field(gt=0)]
    """Rest area of the specimen's cross-section."""
    height: Annotated[Length, Field(gt=0)]
    """Rest height of the specimen."""
    refine: bool = False
    """Whether each frequency is first made to fit its signals best."""

    @property
    def model(self) -> None:
        """No true model is known."""
        return None

    def measured(self) -> DmaData:
        """The data."""
        signals = (read_dma_signals(t.path, frequency=t.frequency, area=self.area, height=self.height) for t in self.tests)
        return dma_from_signals(list(signals), refine=self.refine)
