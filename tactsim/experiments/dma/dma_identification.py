"""Constants of the generalized Kelvin model from dynamic mechanical analysis, with confidence bands of the curves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tactsim.deadline import timed
from tactsim.experiments.dma.report import HISTORY_UNITS, DmaFinding, DmaReport
from tactsim.experiments.dma.source import MeasuredDma, SignalsDma, SyntheticDma, SyntheticSignals
from tactsim.identification.dma_bands import genetic_band, least_squares_band
from tactsim.identification.dma_data import DmaData
from tactsim.identification.dma_determined import determination
from tactsim.identification.dma_genetic import GeneticSettings, fit_genetic
from tactsim.identification.dma_least_squares import fit_least_squares
from tactsim.interfaces import Experiment
from tactsim.interfaces.run import Course
from tactsim.results.result import StepRecord
from tactsim.units import NonNegative

CURVE_POINTS = 50
"""Frequencies of the curves, evenly spaced in the logarithm, beside those of the data."""

Method = Literal["least_squares", "genetic"]


class DmaIdentification(Experiment):
    r"""Generalized Kelvin model fitted to complex compliances at several frequencies.

    .. math:: f = \sum_k (D_e(\omega_k) - D_{e,k})^2 + (D_v(\omega_k) - D_{v,k})^2 \to \min

    by a genetic algorithm, as in thesis section 4.5, or with each error over its standard deviation by least squares.
    """

    kind: Literal["dma_identification"] = "dma_identification"
    data: Annotated[SyntheticDma | SyntheticSignals | MeasuredDma | SignalsDma, Field(discriminator="kind")] = SyntheticDma()
    """Where the compliances come from."""
    methods: Annotated[tuple[Method, ...], Field(min_length=1)] = ("least_squares", "genetic")
    """Fits to make; the constants that are reported without a prefix are those of the first."""
    units: Annotated[int, Field(ge=1, le=20)] = 8
    """Number n of Kelvin units: 2 n + 1 constants."""
    objective: Literal["squared", "as_printed"] = "squared"
    """What the genetic algorithm lowers: squared norms, as the text of 4.5 says, or the norms, as eq. 4.5.2 prints."""
    confidence: Annotated[float, Field(ge=0.5, le=0.999)] = 0.95
    """Of the bands."""
    band: Literal["simultaneous", "pointwise"] = "simultaneous"
    """Whether the confidence holds for both whole curves together, or at each frequency alone."""
    replicates: Annotated[int, Field(ge=50, le=100_000)] = 1000
    """Samples of the bootstrap."""
    population: Annotated[int, Field(ge=4, le=10_000)] = 100
    """Individuals of the genetic algorithm."""
    generations: Annotated[int, Field(ge=2, le=100_000)] = 1000
    """Generations of the genetic algorithm."""
    seed: NonNegative[int] = 1
    """Seed of the genetic algorithm and of the bootstrap."""

    history_units: ClassVar[dict[str, str]] = HISTORY_UNITS

    @model_validator(mode="after")
    def _methods_once(self) -> Self:
        if len(set(self.methods)) < len(self.methods):
            raise ValueError("methods must each stand once")
        return self

    @classmethod
    def example(cls) -> Self:
        """The eight frequencies of the thesis, least squares alone."""
        return cls(methods=("least_squares",), replicates=100)

    def begin(self) -> Course:
        """Fit by every method; one step per frequency of the curves, with data, fits and bands."""
        analysis = self.data.analysis()
        data = self.data.measured() if analysis is None else analysis.data
        spaced = np.geomspace(data.frequencies[0], data.frequencies[-1], CURVE_POINTS)
        report = DmaReport(data, np.union1d(spaced, data.frequencies), self.data.model, analysis)
        reason = f"fitted by {' and '.join(name.replace('_', ' ') for name in self.methods)}"
        kept = "the fits made before are kept, the run is incomplete"
        return Course(self._fitted(report), lambda: report.findings(reason, self._assumptions()), kept)

    def _fitted(self, report: DmaReport) -> Iterator[StepRecord]:
        for method in self.methods:
            with timed(report.timing, method):
                report.fits[method] = self._finding(method, report.data, report.frequencies)
        yield from report.steps()

    def _finding(self, method: Method, data: DmaData, frequencies: np.ndarray) -> DmaFinding:
        """A fit with its band and what the data determine of its constants."""
        if method == "least_squares":
            fit, banded = fit_least_squares(data, self.units), least_squares_band
        else:
            settings = GeneticSettings(self.population, self.generations, self.seed)
            fit, banded = fit_genetic(data, self.units, form=self.objective, settings=settings), genetic_band
        band = banded(
            fit,
            frequencies,
            confidence=self.confidence,
            simultaneous=self.band == "simultaneous",
            replicates=self.replicates,
            seed=self.seed,
        )
        return DmaFinding(fit, band, determination(fit))

    def _assumptions(self) -> list[str]:
        assumptions = []
        if isinstance(self.data, SyntheticDma):
            assumptions.append(
                f"synthetic data of Table 4.1 (times read as {self.data.times.replace('_', ' ')}) with {self.data.noise:.3g} "
                "relative noise: the data of Fig. 4.10 are not printed"
            )
        if isinstance(self.data, SyntheticSignals):
            settled = "in the steady state" if self.data.hold is None else "from rest, transients included"
            assumptions.append(
                f"synthetic signals of Table 4.1 (times read as {self.data.times.replace('_', ' ')}) {settled}, with "
                f"{self.data.noise:.3g} of the amplitude as noise of each sample: the thesis prints neither signals nor specimen"
            )
        assumptions.append(
            "noise independent and Gaussian, its standard deviation proportional to each elastic and viscous compliance"
        )
        if "genetic" in self.methods:
            assumptions.append(
                f"genetic algorithm of {self.population} individuals and {self.generations} generations, log-uniform between "
                "bounds (the thesis prints none of these)"
            )
        return assumptions
