"""Where the data of a dynamic mechanical analysis come from: the thesis's model, a file of moduli, or raw signals."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tactsim.analytic.atrial import table_4_1
from tactsim.analytic.generalized_kelvin import GeneralizedKelvin
from tactsim.identification.columns import of_file
from tactsim.identification.dma_data import FEWEST_FREQUENCIES, THESIS_FREQUENCIES, DmaData, read_dma, synthetic_dma
from tactsim.identification.dma_signals import (
    DmaSignals,
    ModulusEstimate,
    complex_modulus,
    dma_from_estimates,
    read_dma_signals,
    read_dma_tests,
)
from tactsim.identification.dma_synthetic_signals import DmaMachine, synthetic_signals
from tactsim.model import FrozenModel, check_increasing
from tactsim.outside.input_path import InputPath
from tactsim.units import Area, Force, Frequency, Length, NonNegative, Positive, Time, format_quantity


@dataclass(frozen=True, eq=False)
class SignalsAnalysis:
    """Signals of several tests and the modulus that each gives, in order of frequency."""

    signals: tuple[DmaSignals, ...]
    estimates: tuple[ModulusEstimate, ...]

    @classmethod
    def of(cls, signals: Sequence[DmaSignals], *, refine: bool = False) -> Self:
        """The moduli of the signals.

        Raises
        ------
        InvalidQuantity
            If a test gives no modulus.
        ConvergenceError
            If its frequency is refined and not found.
        """
        ordered = tuple(sorted(signals, key=lambda one: one.frequency))
        return cls(ordered, tuple(complex_modulus(one, refine=refine) for one in ordered))

    @property
    def data(self) -> DmaData:
        """Compliances with their noise.

        Raises
        ------
        InvalidQuantity
            If a frequency is repeated.
        """
        return dma_from_estimates(self.estimates)


class DmaSource(FrozenModel):
    """Where data come from."""

    @property
    def model(self) -> GeneralizedKelvin | None:
        """The true model; None if none is known."""
        return None

    def analysis(self) -> SignalsAnalysis | None:
        """The signals and what they give; None if there are none."""
        return None

    @abstractmethod
    def measured(self) -> DmaData:
        """The data."""


class ModelledDma(DmaSource):
    """Data of the model of Table 4.1."""

    kind: str
    times: Literal["retardation_times", "viscosities"] = "retardation_times"
    """The column of times of Table 4.1: in s, as eq. 4.3.8 uses it, or viscosities, as eq. 4.6.4 uses it."""
    frequencies: Annotated[tuple[Positive[Frequency], ...], Field(min_length=FEWEST_FREQUENCIES)] = THESIS_FREQUENCIES
    """Test frequencies, increasing; by default the eight of thesis section 4.4."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        check_increasing(frequencies=self.frequencies)
        return self

    @property
    def model(self) -> GeneralizedKelvin:
        """The true model."""
        return table_4_1(self.times)


class SyntheticDma(ModelledDma):
    """Data made from the model of Table 4.1, as the data of Fig. 4.10 are not printed."""

    kind: Literal["synthetic"] = "synthetic"
    noise: Annotated[float, Field(ge=0, le=0.2)] = 0.02
    """Relative standard deviation of the independent Gaussian noise of each elastic and viscous compliance."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    def measured(self) -> DmaData:
        """The data.

        Raises
        ------
        InvalidQuantity
            If the noise is so large that a compliance becomes negative.
        """
        return synthetic_dma(self.model, self.frequencies, self.noise, self.seed)


class MeasuredDma(DmaSource):
    """Data read from a file."""

    kind: Literal["file"] = "file"
    path: InputPath
    """CSV file, beside the case or in the working folder; header such as
    ``frequency [Hz], storage modulus [kPa], loss modulus [kPa]``."""
    noise: Annotated[float, Field(gt=0, le=0.2)] | None = None
    """Relative standard deviation of each number; null estimates it from the residuals of the fit."""

    def measured(self) -> DmaData:
        """The data.

        Raises
        ------
        StorageError
            If the file cannot be read.
        InvalidQuantity
            If a unit is missing or a number out of its range, with file and row.
        """
        return read_dma(self.path, self.noise)


class SyntheticSignals(ModelledDma):
    """Load and displacement signals of the model of Table 4.1 under an oscillating load, with noise of the recording.

    The compliances come from the signals, as those of a measurement do; the thesis prints neither specimen nor loads.
    """

    kind: Literal["synthetic_signals"] = "synthetic_signals"
    area: Positive[Area] = 100e-6
    """Rest area of the specimen's cross-section."""
    height: Positive[Length] = 5e-3
    """Rest height of the specimen."""
    mean_load: Positive[Force] = 5e-3
    """Mean of the load."""
    amplitude: Positive[Force] = 2.5e-3
    """Amplitude of the load."""
    cycles: Annotated[float, Field(ge=1, le=10_000)] = 20.0
    """Cycles that are recorded at each frequency, whole or not."""
    samples_per_cycle: Annotated[int, Field(ge=4, le=10_000)] = 50
    """Samples of a cycle."""
    hold: NonNegative[Time] | None = None
    """Time for which the mean load is held from rest before it oscillates; null records the steady state, free of transients."""
    precycles: Annotated[float, Field(ge=0, le=100_000)] = 10.0
    """Cycles before the record, in which the specimen settles; only with ``hold``."""
    noise: Annotated[float, Field(ge=0, le=0.5)] = 0.02
    """Standard deviation of the noise of each sample of load and of displacement over the amplitude of its oscillation."""
    seed: NonNegative[int] = 1
    """Seed of the noise."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.mean_load < self.amplitude:
            mean, swing = format_quantity(self.mean_load, "N"), format_quantity(self.amplitude, "N")
            raise ValueError(f"mean_load {mean} must be at least the amplitude {swing}, or the specimen is let go")
        return self

    def analysis(self) -> SignalsAnalysis:
        """The signals and what they give.

        Raises
        ------
        InvalidQuantity
            If the mean load is below the amplitude, or a test gives no modulus.
        """
        machine = DmaMachine(
            area=self.area,
            height=self.height,
            mean_load=self.mean_load,
            amplitude=self.amplitude,
            cycles=self.cycles,
            samples_per_cycle=self.samples_per_cycle,
            hold=self.hold,
            precycles=self.precycles,
            load_noise=self.noise,
            displacement_noise=self.noise,
        )
        return SignalsAnalysis.of(synthetic_signals(self.model, self.frequencies, machine, seed=self.seed))

    def measured(self) -> DmaData:
        """The data."""
        return self.analysis().data


class SignalsTest(FrozenModel):
    """The signals of one test at one frequency."""

    path: InputPath
    """CSV file, beside the case or in the working folder; header such as ``time [s], load [N], displacement [mm]``."""
    frequency: Positive[Frequency]
    """Test frequency."""


class SignalsDma(DmaSource):
    """Load and displacement signals; amplitude and phase by least squares, the noise from what the sines leave."""

    kind: Literal["signals"] = "signals"
    tests: Annotated[tuple[SignalsTest, ...], Field(min_length=FEWEST_FREQUENCIES)] | None = None
    """One file for each frequency; or give ``path``."""
    path: InputPath | None = None
    """One CSV file of all tests, beside the case or in the working folder; header such as
    ``frequency [Hz], time [s], load [N], displacement [mm]``."""
    area: Positive[Area]
    """Rest area of the specimen's cross-section."""
    height: Positive[Length]
    """Rest height of the specimen."""
    refine: bool = False
    """Whether each frequency is first made to fit its signals best."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        if (self.tests is None) == (self.path is None):
            raise ValueError("give either tests, one file for each frequency, or path, one file of all of them")
        return self

    def analysis(self) -> SignalsAnalysis:
        """The signals and what they give.

        Raises
        ------
        StorageError
            If a file cannot be read.
        InvalidQuantity
            If a unit or a column is missing or the signals of a test do not determine a modulus, with the file.
        ConvergenceError
            If the frequency of a test is refined and not found.
        """
        if self.path is not None:
            signals = read_dma_tests(self.path, area=self.area, height=self.height)
            with of_file(self.path):
                return SignalsAnalysis.of(signals, refine=self.refine)
        signals = [
            read_dma_signals(test.path, frequency=test.frequency, area=self.area, height=self.height) for test in self.tests or ()
        ]
        return SignalsAnalysis.of(signals, refine=self.refine)

    def measured(self) -> DmaData:
        """The data."""
        return self.analysis().data
